! Elasticity that stiffens, from its potential: psi = E (q/2 + b q^2/4), q = strain.strain, stress = E (1 + b q) strain. PROPS: E, b,
! part of the energy that is reported.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, &
    predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, &
    layer, kspt, jstep, kinc)
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
      drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(*), dpred(*), props(nprops), coords(3), &
      drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  double precision :: q, strain(ntens)
  integer :: i, j
  strain = stran + dstran
  q = sum(strain**2)
  stress = props(1) * (1 + props(2) * q) * strain
  do j = 1, ntens
    do i = 1, ntens
      ddsdde(i, j) = 2 * props(1) * props(2) * strain(i) * strain(j)
    end do
    ddsdde(j, j) = ddsdde(j, j) + props(1) * (1 + props(2) * q)
  end do
  sse = props(3) * props(1) * (q / 2 + props(2) * q**2 / 4)
end subroutine
