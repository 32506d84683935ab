! Compressible neo-Hooke from DFGRD1: sigma = mu/J^(5/3) dev b + kappa (J - 1) 1. PROPS: mu, kappa.
! DDSDDE: that of the Jaumann rate of the Kirchhoff stress over J.
module kinematics_of_neo_hooke
  implicit none
  integer, parameter :: dp = kind(1.0d0)
contains
  pure function determinant(f) result(j)
    real(dp), intent(in) :: f(3, 3)
    real(dp) :: j
    j = f(1, 1)*(f(2, 2)*f(3, 3) - f(2, 3)*f(3, 2)) - f(1, 2)*(f(2, 1)*f(3, 3) - f(2, 3)*f(3, 1)) &
      + f(1, 3)*(f(2, 1)*f(3, 2) - f(2, 2)*f(3, 1))
  end function determinant
end module kinematics_of_neo_hooke

subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
    dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
    noel, npt, layer, kspt, jstep, kinc)
  use kinematics_of_neo_hooke
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  real(dp) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
    drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3), &
    drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  integer, parameter :: first(6) = [1, 2, 3, 1, 1, 2], second(6) = [1, 2, 3, 2, 3, 3]
  real(dp) :: b(3, 3), j, g, mean, one(3, 3)
  integer :: a, c, i, k, l, m
  one = 0.0_dp
  do a = 1, 3
    one(a, a) = 1.0_dp
  end do
  j = determinant(dfgrd1)
  b = matmul(dfgrd1, transpose(dfgrd1))*j**(-2.0_dp/3.0_dp)
  mean = (b(1, 1) + b(2, 2) + b(3, 3))/3.0_dp
  g = props(1)/j
  do a = 1, ntens
    i = first(a)
    k = second(a)
    stress(a) = g*(b(i, k) - mean*one(i, k)) + props(2)*(j - 1.0_dp)*one(i, k)
    do c = 1, ntens
      l = first(c)
      m = second(c)
      ddsdde(a, c) = g*(0.5_dp*(one(i, l)*b(k, m) + b(i, l)*one(k, m) + one(i, m)*b(k, l) + b(i, m)*one(k, l)) &
        - 2.0_dp/3.0_dp*(b(i, k)*one(l, m) + one(i, k)*b(l, m)) + 2.0_dp/3.0_dp*mean*one(i, k)*one(l, m)) &
        + props(2)*(2.0_dp*j - 1.0_dp)*one(i, k)*one(l, m)
    end do
  end do
  sse = 0.5_dp*props(1)*(3.0_dp*mean - 3.0_dp) + 0.5_dp*props(2)*(j - 1.0_dp)**2
end subroutine umat
