! Conduction that grows with the temperature, by UMATHT: f = -k (1 + b T) grad T, U = c T. To be built with a UMAT.
! PROPS: k, b, c, way of U (0: adds to it, 1: sets it), which error: 0 none, 1 DFDT not set, 2 DFDG 1.25 times too large, 3 FLUX not a number,
! 4 a cut-back, 5 FLUX(3) written, 6 DUDT half of what it should be, 7 DUDG not 0, 8 DFDT with the other sign, 9 DFDG not set, 10 U not a number.
subroutine umatht(u, dudt, dudg, flux, dfdt, dfdg, statev, temp, dtemp, dtemdx, time, dtime, predef, dpred, cmname, ntgrd, &
    nstatv, props, nprops, coords, pnewdt, noel, npt, layer, kspt, kstep, kinc)
  implicit none
  character(len=80) :: cmname
  integer :: ntgrd, nstatv, nprops, noel, npt, layer, kspt, kstep, kinc, i, error
  double precision :: u, dudt, dudg(ntgrd), flux(ntgrd), dfdt(ntgrd), dfdg(ntgrd, ntgrd), statev(nstatv), temp, dtemp, &
      dtemdx(ntgrd), time(2), dtime, predef(*), dpred(*), props(nprops), coords(3), pnewdt
  double precision :: k
  error = nint(props(5))
  ! inputs as working space
  temp = temp + dtemp
  k = props(1) * (1 + props(2) * temp)
  dudt = props(3)
  u = u + dudt * dtemp
  if (nint(props(4)) == 1) u = dudt * temp
  do i = 1, ntgrd
    flux(i) = -k * dtemdx(i)
    if (error /= 1) dfdt(i) = -props(1) * props(2) * dtemdx(i)
    dfdg(i, i) = -k
  end do
  if (error == 2) dfdg = 1.25d0 * dfdg
  if (error == 6) dudt = 0.5d0 * dudt
  if (error == 7) dudg(1) = dudt
  if (error == 8) dfdt = -dfdt
  if (error == 9) dfdg = 0
  if (error == 10) u = sqrt(-1 - abs(temp))
  if (error == 3) flux(1) = sqrt(-1 - abs(temp))
  if (error == 4 .and. dtime > 0.3d0) pnewdt = 0.25d0
  if (error == 5) flux(error - 2) = 1
end subroutine
