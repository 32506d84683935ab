! tau = mu (b - 1) + lambda ln J 1 from DFGRD1, in space and in plane stress. PROPS: mu, lambda, and 1 for an error: plane stress
! takes lambda of plane stress and J = det F of the plane, as if F33 were 1; at small strains that is the same.
! DDSDDE: that of the Jaumann rate of J sigma over J; in plane stress J is that of the plane.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
    dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
    noel, npt, layer, kspt, jstep, kinc)
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  real(dp) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
    drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3), &
    drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  integer :: first(6), second(6)
  real(dp) :: f(3, 3), b(3, 3), one(3, 3), mu, lambda, slope, j, c, change, volume
  integer :: a, d, i, k, l, m
  first = [1, 2, 3, 1, 1, 2]
  second = [1, 2, 3, 2, 3, 3]
  mu = props(1)
  lambda = props(2)
  f = dfgrd1
  volume = 0.0_dp
  one = 0.0_dp
  do a = 1, 3
    one(a, a) = 1.0_dp
  end do
  if (ntens == 3) then
    first(3) = 1
    second(3) = 2
    f(3, 3) = 1.0_dp
    if (props(3) == 1.0_dp) then
      lambda = 2.0_dp*lambda*mu/(lambda + 2.0_dp*mu)
      slope = lambda
    else
      ! c = F33**2 with mu (c - 1) + lambda (ln J + ln(c)/2) = 0, J of the plane
      j = f(1, 1)*f(2, 2) - f(1, 2)*f(2, 1)
      c = 1.0_dp
      do a = 1, 100
        change = (mu*(c - 1.0_dp) + lambda*(log(j) + 0.5_dp*log(c)))/(mu*c + 0.5_dp*lambda)
        c = c*exp(-change)
        if (abs(change) < 1.0e-15_dp) exit
      end do
      f(3, 3) = sqrt(c)
      volume = lambda/(2.0_dp*mu*c + lambda)
      slope = lambda*(1.0_dp - volume)
    end if
  else
    slope = lambda
  end if
  j = f(1, 1)*(f(2, 2)*f(3, 3) - f(2, 3)*f(3, 2)) - f(1, 2)*(f(2, 1)*f(3, 3) - f(2, 3)*f(3, 1)) &
    + f(1, 3)*(f(2, 1)*f(3, 2) - f(2, 2)*f(3, 1))
  b = matmul(f, transpose(f))
  do a = 1, ntens
    i = first(a)
    k = second(a)
    stress(a) = (mu*(b(i, k) - one(i, k)) + lambda*log(j)*one(i, k))/j
    do d = 1, ntens
      l = first(d)
      m = second(d)
      ddsdde(a, d) = (0.5_dp*mu*(one(i, l)*b(k, m) + b(i, l)*one(k, m) + one(i, m)*b(k, l) + b(i, m)*one(k, l)) &
        + slope*one(i, k)*one(l, m))/j + volume*stress(a)*one(l, m)
    end do
  end do
  sse = 0.5_dp*mu*(b(1, 1) + b(2, 2) + b(3, 3) - 3.0_dp) - mu*log(j) + 0.5_dp*props(2)*log(j)**2
end subroutine umat
