! Mises plasticity with linear hardening that is written for six components and says NTENS only where arrays are the host's: in a
! plane its own arrays of NTENS values are left, which here lie in one piece of memory. PROPS: E, nu, yield stress, hardening
! modulus, 1 if it then ends the process. STATEV: plastic strain.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
    dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
    noel, npt, layer, kspt, jstep, kinc)
  implicit none
  character(80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc, i
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens,ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
    drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3), &
    drot(3,3), pnewdt, celent, dfgrd0(3,3), dfgrd1(3,3)
  ! the deviator of NTENS values, and behind it the stresses
  double precision :: work(24), g, k, p, q, by
  g = props(1)/(2*(1 + props(2))); k = props(1)/(3*(1 - 2*props(2)))
  work = 0
  ddsdde = 0
  ddsdde(1:3,1:3) = k - 2*g/3
  do i = 1, ntens
    ddsdde(i,i) = ddsdde(i,i) + merge(2*g, g, i <= 3)
  end do
  stress = stress + matmul(ddsdde, dstran)
  p = sum(stress(1:3))/3
  work(1:ntens) = stress
  work(ntens+1:2*ntens) = stress
  work(1:3) = work(1:3) - p
  ! six terms, whatever NTENS is
  q = sqrt(1.5d0*sum(work(1:3)**2) + 3*sum(work(4:6)**2))
  by = (q - props(3) - props(4)*statev(1))/(3*g + props(4))
  if (by > 0) then
    if (props(5) > 0 .and. ntens == 4) call abort
    statev(1) = statev(1) + by
    stress(1:3) = stress(1:3) - 3*g*by/q*work(1:3)
    stress(4:) = stress(4:) - 3*g*by/q*work(4:ntens)
  end if
end subroutine
