! Orthotropic elasticity: STRESS + C : DSTRAN, the stiffness by inversion of the compliance.
! PROPS: E1, E2, E3, nu12, nu13, nu23, G12, G13, G23. STATEV(1): STRAN(1) + DSTRAN(1), the strain that the law is given.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
    dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
    noel, npt, layer, kspt, jstep, kinc)
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  real(dp) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
    drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3), &
    drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  real(dp) :: s(3, 3), inverse(3, 3), factor
  integer :: i, k
  s = 0.0_dp
  s(1, 1) = 1.0_dp/props(1)
  s(2, 2) = 1.0_dp/props(2)
  s(3, 3) = 1.0_dp/props(3)
  s(1, 2) = -props(4)/props(1)
  s(1, 3) = -props(5)/props(1)
  s(2, 3) = -props(6)/props(2)
  s(2, 1) = s(1, 2)
  s(3, 1) = s(1, 3)
  s(3, 2) = s(2, 3)
  inverse = 0.0_dp
  do i = 1, ndi
    inverse(i, i) = 1.0_dp
  end do
  do i = 1, ndi
    factor = 1.0_dp/s(i, i)
    s(i, 1:ndi) = s(i, 1:ndi)*factor
    inverse(i, 1:ndi) = inverse(i, 1:ndi)*factor
    do k = 1, ndi
      if (k == i) cycle
      factor = s(k, i)
      s(k, 1:ndi) = s(k, 1:ndi) - factor*s(i, 1:ndi)
      inverse(k, 1:ndi) = inverse(k, 1:ndi) - factor*inverse(i, 1:ndi)
    end do
  end do
  ddsdde = 0.0_dp
  ddsdde(1:ndi, 1:ndi) = inverse(1:ndi, 1:ndi)
  do i = 1, nshr
    ddsdde(ndi + i, ndi + i) = props(6 + i)
  end do
  sse = sse + dot_product(stress + 0.5_dp*matmul(ddsdde, dstran), dstran)
  stress = stress + matmul(ddsdde, dstran)
  statev(1) = stran(1) + dstran(1)
end subroutine umat
