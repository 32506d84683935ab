! Laws whose strains go on under a stress that is held, with NDI = 3. PROPS: kind, E, nu, then
!   1 Maxwell: relaxation time of the deviator, backward Euler;
!   2 Norton: A, n with the creep rate A q^n, backward Euler;
!   3 an elastic body that swells by a t^m + b T: a, m, b;
!   4 q + mu p = k + H lambda with p positive in tension and the plastic volume psi lambda: k, mu, psi, H. STATEV: lambda.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
    dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
    noel, npt, layer, kspt, jstep, kinc)
  implicit none
  character(80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens,ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
    drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3), &
    drot(3,3), pnewdt, celent, dfgrd0(3,3), dfgrd1(3,3)
  integer :: i, j
  double precision :: g, k, p, q, trial, s(ntens), n(ntens), unit(ntens), strain(ntens), share, slope, lambda, swelling
  g = props(2)/(2*(1 + props(3))); k = props(2)/(3*(1 - 2*props(3)))
  unit = 0; unit(1:3) = 1
  strain = dstran
  if (nint(props(1)) == 3) then
    swelling = props(6)*dtemp
    if (props(4) /= 0) swelling = swelling + props(4)*((time(2) + dtime)**props(5) - time(2)**props(5))
    strain(1:3) = strain(1:3) - swelling
  end if
  p = sum(stress(1:3))/3
  s = stress - p*unit + g*strain
  s(1:3) = s(1:3) + g*strain(1:3) - 2*g*sum(strain(1:3))/3
  p = p + k*sum(strain(1:3))
  trial = sqrt(1.5d0*(sum(s(1:3)**2) + 2*sum(s(4:)**2)))
  n = 0
  if (trial > 0) n = 1.5d0*s/trial
  ! s = share strial, slope = dq/dqtrial
  share = 1; slope = 1; lambda = 0
  select case (nint(props(1)))
  case (1)
    share = 1/(1 + dtime/props(4)); slope = share
  case (2)
    q = trial
    do i = 1, 200
      lambda = (q + 3*g*dtime*props(4)*q**props(5) - trial)/(1 + 3*g*dtime*props(4)*props(5)*q**(props(5) - 1))
      q = q - lambda
      if (abs(lambda) <= 1d-15*trial) exit
    end do
    if (trial > 0) share = q/trial
    slope = 1/(1 + 3*g*dtime*props(4)*props(5)*q**(props(5) - 1))
  case (4)
    lambda = (trial + props(5)*p - props(4) - props(7)*statev(1))/(3*g + k*props(5)*props(6) + props(7))
    if (lambda > 0) then
      p = p - k*props(6)*lambda
      share = 1 - 3*g*lambda/trial
      statev(1) = statev(1) + lambda
    end if
  end select
  stress = share*s + p*unit
  do j = 1, ntens
    do i = 1, ntens
      ddsdde(i,j) = (k - 2*g*share/3)*unit(i)*unit(j) + 4*g/3*(slope - share)*n(i)*n(j)
    end do
    ddsdde(j,j) = ddsdde(j,j) + g*share*(1 + unit(j))
  end do
  if (nint(props(1)) == 4 .and. lambda > 0) then
    ! the derivative of lambda: (2 g n + k mu 1)/(3 g + k mu psi + H)
    slope = 3*g + k*props(5)*props(6) + props(7)
    do j = 1, ntens
      do i = 1, ntens
        ddsdde(i,j) = ddsdde(i,j) - (2*g*n(i) + k*props(6)*unit(i))*(2*g*n(j) + k*props(5)*unit(j))/slope
      end do
    end do
  end if
end subroutine
