! Implicit gradient damage (Peerlings et al. 1996): stress = (1 - D) C strain, D by the largest nonlocal strain T so far, T the temperature:
!   T - c div grad T = e,   e = sqrt(strain C strain/E),   D = 1 - K0/K (1 - A + A exp(-B (K - K0))),   K = max(K0, T)
! The flux -c grad T is that of UMATHT, the source e - T is RPL. All derivatives are exact.
! PROPS: E, nu, K0, A, B. STATEV: K, D.
! PROPS of UMATHT: c.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, &
    predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, &
    layer, kspt, jstep, kinc)
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
      drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(*), dpred(*), props(nprops), coords(3), &
      drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  double precision :: mu, lambda, nonlocal, local, before, largest, decay, strain(ntens), sound(ntens)
  integer :: i
  mu = props(1) / (2 * (1 + props(2)))
  lambda = 2 * mu * props(2) / (1 - 2 * props(2))
  ddsdde = 0
  ddsdde(1:ndi, 1:ndi) = lambda
  do i = 1, ntens
    ddsdde(i, i) = ddsdde(i, i) + merge(2, 1, i <= ndi) * mu
  end do
  strain = stran + dstran
  sound = matmul(ddsdde, strain)
  local = sqrt(sum(strain * sound) / props(1))
  nonlocal = temp + dtemp
  before = max(statev(1), props(3))
  largest = max(before, nonlocal)
  decay = exp(-props(5) * (largest - props(3)))
  statev(1) = largest
  statev(2) = 1 - props(3) / largest * (1 - props(4) + props(4) * decay)
  ddsddt = 0
  if (nonlocal >= before) then
    ddsddt = -(props(3) / largest**2 * (1 - props(4) + props(4) * decay) + props(3) / largest * props(4) * props(5) * decay) * sound
  end if
  stress = (1 - statev(2)) * sound
  ddsdde = (1 - statev(2)) * ddsdde
  sse = 0.5d0 * sum(stress * strain)
  rpl = local - nonlocal
  drpldt = -1
  drplde = 0
  if (local > 0) drplde = sound / (props(1) * local)
end subroutine

subroutine umatht(u, dudt, dudg, flux, dfdt, dfdg, statev, temp, dtemp, dtemdx, time, dtime, predef, dpred, cmname, ntgrd, &
    nstatv, props, nprops, coords, pnewdt, noel, npt, layer, kspt, kstep, kinc)
  implicit none
  character(len=80) :: cmname
  integer :: ntgrd, nstatv, nprops, noel, npt, layer, kspt, kstep, kinc, i
  double precision :: u, dudt, dudg(ntgrd), flux(ntgrd), dfdt(ntgrd), dfdg(ntgrd, ntgrd), statev(nstatv), temp, dtemp, &
      dtemdx(ntgrd), time(2), dtime, predef(*), dpred(*), props(nprops), coords(3), pnewdt
  flux = -props(1) * dtemdx
  dfdg = 0
  do i = 1, ntgrd
    dfdg(i, i) = -props(1)
  end do
end subroutine
