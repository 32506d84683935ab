! Compressible Mooney-Rivlin from DFGRD1: W = c10 (I1 - 3) + c01 (I2 - 3) + kappa/2 (J - 1)^2 of the isochoric invariants.
! PROPS: c10, c01, kappa. DDSDDE by forward differences of the Kirchhoff stress (Sun, Chaikof & Levenston 2008).
subroutine cauchy_stress(f, props, sigma, j)
  implicit none
  double precision, intent(in) :: f(3, 3), props(3)
  double precision, intent(out) :: sigma(3, 3), j
  double precision :: b(3, 3), s(3, 3), mean
  integer :: i
  j = f(1, 1)*(f(2, 2)*f(3, 3) - f(2, 3)*f(3, 2)) - f(1, 2)*(f(2, 1)*f(3, 3) - f(2, 3)*f(3, 1)) &
    + f(1, 3)*(f(2, 1)*f(3, 2) - f(2, 2)*f(3, 1))
  b = matmul(f, transpose(f))*j**(-2.0d0/3.0d0)
  s = (props(1) + (b(1, 1) + b(2, 2) + b(3, 3))*props(2))*b - props(2)*matmul(b, b)
  mean = (s(1, 1) + s(2, 2) + s(3, 3))/3.0d0
  sigma = 2.0d0/j*s
  do i = 1, 3
    sigma(i, i) = sigma(i, i) - 2.0d0/j*mean + props(3)*(j - 1.0d0)
  end do
end subroutine cauchy_stress

subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
    dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
    noel, npt, layer, kspt, jstep, kinc)
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), &
    drplde(ntens), drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), &
    coords(3), drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  integer, parameter :: first(6) = [1, 2, 3, 1, 1, 2], second(6) = [1, 2, 3, 2, 3, 3]
  double precision, parameter :: h = 1.0d-8
  double precision :: sigma(3, 3), shifted(3, 3), f(3, 3), j, j_shifted
  integer :: a, c
  call cauchy_stress(dfgrd1, props, sigma, j)
  do a = 1, ntens
    stress(a) = sigma(first(a), second(a))
  end do
  do c = 1, ntens
    f = dfgrd1
    f(first(c), :) = f(first(c), :) + 0.5d0*h*dfgrd1(second(c), :)
    f(second(c), :) = f(second(c), :) + 0.5d0*h*dfgrd1(first(c), :)
    call cauchy_stress(f, props, shifted, j_shifted)
    do a = 1, ntens
      ddsdde(a, c) = (j_shifted*shifted(first(a), second(a)) - j*sigma(first(a), second(a)))/(j*h)
    end do
  end do
end subroutine umat
