! Isotropic elasticity whose stiffness is the inverse of its compliance, by LAPACK.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
    dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
    noel, npt, layer, kspt, jstep, kinc)
  implicit none
  character(80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens,ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
    drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3), &
    drot(3,3), pnewdt, celent, dfgrd0(3,3), dfgrd1(3,3)
  double precision :: compliance(ntens,ntens)
  integer :: i, info, pivots(ntens)
  compliance = 0
  compliance(1:ndi,1:ndi) = -props(2)/props(1)
  ddsdde = 0
  do i = 1, ntens
    compliance(i,i) = merge(1/props(1), 2*(1 + props(2))/props(1), i <= ndi)
    ddsdde(i,i) = 1
  end do
  call dgesv(ntens, ntens, compliance, ntens, pivots, ddsdde, ntens, info)
  call dgemv('n', ntens, ntens, 1d0, ddsdde, ntens, dstran, 1, 1d0, stress, 1)
  sse = 0.5d0*dot_product(stress, stran + dstran)
end subroutine
