! STATEV(1) is a stretch that must start at 1 (SDVINI, or the case); the law works with it. Where e11 reaches PROPS(3), and in every
! call if that is 0, it writes one state too many.
subroutine sdvini(statev, coords, nstatv, ncrds, noel, npt, layer, kspt)
  integer :: nstatv, ncrds, noel, npt, layer, kspt
  double precision :: statev(nstatv), coords(ncrds)
  statev = 1
end subroutine
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
    dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
    noel, npt, layer, kspt, jstep, kinc)
  implicit none
  character(80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(*), ddsdde(ntens,ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
    drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3), &
    drot(3,3), pnewdt, celent, dfgrd0(3,3), dfgrd1(3,3)
  double precision :: lambda, mu
  integer :: i
  mu = props(1)/(2*(1 + props(2))); lambda = 2*mu*props(2)/(1 - 2*props(2))
  ddsdde = 0
  ddsdde(1:ndi,1:ndi) = lambda
  do i = 1, ntens
    ddsdde(i,i) = ddsdde(i,i) + merge(2*mu, mu, i <= ndi)
  end do
  ddsdde = ddsdde/statev(1)
  stress = matmul(ddsdde, stran + dstran)
  if (props(3) == 0 .or. stran(1) + dstran(1) > props(3)) statev(nstatv + 1) = 7
end subroutine
