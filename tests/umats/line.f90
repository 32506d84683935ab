! Laws of one or two stresses, as UMATs of trusses, wires and beams are: E, G, yield stress, hardening modulus. The shear of a
! beam is elastic. No other stress is set, whatever NTENS is.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
    dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
    noel, npt, layer, kspt, jstep, kinc)
  implicit none
  character(80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens,ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
    drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3), &
    drot(3,3), pnewdt, celent, dfgrd0(3,3), dfgrd1(3,3)
  double precision :: trial, beyond
  trial = stress(1) + props(1)*dstran(1)
  beyond = abs(trial) - props(3) - props(4)*statev(1)
  ddsdde = 0
  ddsdde(1,1) = props(1)
  if (beyond > 0) then
    statev(1) = statev(1) + beyond/(props(1) + props(4))
    trial = trial - sign(props(1)*beyond/(props(1) + props(4)), trial)
    ddsdde(1,1) = props(1)*props(4)/(props(1) + props(4))
  end if
  stress(1) = trial
  if (ndi == 1 .and. nshr == 1) then
    stress(2) = stress(2) + props(2)*dstran(2)
    ddsdde(2,2) = props(2)
  end if
end subroutine
