! Plasticity of von Mises with linear hardening that expands, softens with the temperature, and is heated by its plastic work:
!   yield stress  q = S0 (1 - B (T - T0)) + H p,   RPL = ETA q dp/dt,   T that of the end of the increment
! PROPS: E, nu, alpha, S0, B, H, ETA, T0, which error: 0 none, 1 DDSDDT of the wrong sign, 2 DDSDDT of expansion alone, 3 DDSDDT not set,
! 4 DRPLDE by tensor shears, 5 DRPLDE halved, 6 DRPLDT not set, 7 nothing of heat set, 8 RPL not a number.
! STATEV: plastic strains (engineering shear), p. Where nothing yields RPL and its derivatives are not set at all.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, &
    predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, &
    layer, kspt, jstep, kinc)
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
      drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(*), dpred(*), props(nprops), coords(3), &
      drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  double precision :: mu, bulk, heat, eta, hard, elastic(ntens), trial(ntens), flow(ntens), volume, q, yield, dp, share, one(ntens)
  integer :: i, j, error
  mu = props(1) / (2 * (1 + props(2)))
  bulk = props(1) / (3 * (1 - 2 * props(2)))
  hard = props(6)
  eta = props(7)
  error = nint(props(9))
  heat = temp + dtemp - props(8)
  one = 0
  one(1:ndi) = 1
  elastic = stran + dstran - statev(1:ntens) - props(3) * heat * one
  volume = sum(elastic(1:ndi))
  trial = 2 * mu * (elastic - one * volume / 3)
  trial(ndi + 1:) = mu * elastic(ndi + 1:)
  q = sqrt(1.5d0 * (sum(trial(1:ndi)**2) + 2 * sum(trial(ndi + 1:)**2)))
  yield = props(4) * (1 - props(5) * heat) + hard * statev(7)
  dp = max(q - yield, 0d0) / (3 * mu + hard)
  flow = 0
  share = 1
  if (dp > 0) then
    flow = 1.5d0 * trial / q
    share = 1 - 3 * mu * dp / q
  end if
  stress = share * trial + bulk * volume * one
  statev(1:ndi) = statev(1:ndi) + dp * flow(1:ndi)
  statev(ndi + 1:ntens) = statev(ndi + 1:ntens) + 2 * dp * flow(ndi + 1:)
  statev(7) = statev(7) + dp
  do j = 1, ntens
    do i = 1, ntens
      ddsdde(i, j) = (bulk - 2 * mu * share / 3) * one(i) * one(j)
      if (dp > 0) ddsdde(i, j) = ddsdde(i, j) - 4 * mu**2 * (1 / (3 * mu + hard) - dp / q) * flow(i) * flow(j)
    end do
    ddsdde(j, j) = ddsdde(j, j) + mu * share * (1 + one(j))
  end do
  elastic = elastic - dp * flow
  elastic(ndi + 1:) = elastic(ndi + 1:) - dp * flow(ndi + 1:)
  sse = 0.5d0 * sum(stress * elastic)
  q = q - 3 * mu * dp
  spd = spd + q * dp
  if (error == 7) return
  if (error /= 3) then
    ddsddt = -3 * bulk * props(3) * one
    if (error /= 2) ddsddt = ddsddt - 2 * mu * props(4) * props(5) / (3 * mu + hard) * flow
    if (error == 1) ddsddt = -ddsddt
  end if
  if (dp == 0) return
  rpl = eta * q * dp / dtime
  if (error == 8) rpl = sqrt(-rpl)
  drplde = eta / dtime * (hard * dp + q) / (3 * mu + hard) * 2 * mu * flow
  if (error == 4) drplde(ndi + 1:) = 2 * drplde(ndi + 1:)
  if (error == 5) drplde = drplde / 2
  if (error /= 6) drpldt = eta / dtime * props(4) * props(5) / (3 * mu + hard) * (q - 3 * mu * dp)
end subroutine
