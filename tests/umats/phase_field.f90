! A brittle solid whose phase field d is the temperature, AT2: stress = ((1 - d)^2 + 1e-6) C strain, field equation
!   div grad d + RPL = 0,   RPL = 2 (1 - d) H/(Gc l) - d/l^2,   H the largest energy so far
! as public codes have it: DDSDDT and DRPLDE are left at 0. PROPS: E, nu, Gc, l. STATEV: H.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, &
    predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, &
    layer, kspt, jstep, kinc)
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
      drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(*), dpred(*), props(nprops), coords(3), &
      drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  double precision :: mu, lambda, d, energy, strain(ntens)
  integer :: i
  mu = props(1) / (2 * (1 + props(2)))
  lambda = 2 * mu * props(2) / (1 - 2 * props(2))
  d = temp + dtemp
  ddsdde = 0
  ddsdde(1:ndi, 1:ndi) = lambda
  do i = 1, ntens
    ddsdde(i, i) = ddsdde(i, i) + merge(2, 1, i <= ndi) * mu
  end do
  strain = stran + dstran
  energy = 0.5d0 * sum(strain * matmul(ddsdde, strain))
  statev(1) = max(statev(1), energy)
  ddsdde = ((1 - d)**2 + 1d-6) * ddsdde
  stress = matmul(ddsdde, strain)
  sse = 0.5d0 * sum(strain * stress)
  rpl = 2 * (1 - d) * statev(1) / (props(3) * props(4)) - d / props(4)**2
  drpldt = -2 * statev(1) / (props(3) * props(4)) - 1 / props(4)**2
end subroutine
