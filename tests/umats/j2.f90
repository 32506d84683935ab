! Von Mises plasticity with linear isotropic hardening as a UMAT in free form.
! PROPS: E, nu, initial yield stress, hardening modulus. NTENS 6 or 4.
! STATEV: equivalent plastic strain, then the elastic strain (6, engineering shear).
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, &
      temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, &
      dfgrd0, dfgrd1, noel, npt, layer, kspt, jstep, kinc)
   implicit none
   integer, parameter :: dp = kind(1.0d0)
   integer, intent(in) :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
   character(len=80), intent(in) :: cmname
   real(dp), intent(inout) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl
   real(dp), intent(inout) :: ddsddt(ntens), drplde(ntens), drpldt, pnewdt
   real(dp), intent(in) :: stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(*), dpred(*)
   real(dp), intent(in) :: props(nprops), coords(3), drot(3, 3), celent, dfgrd0(3, 3), dfgrd1(3, 3)
   real(dp) :: mu, bulk, hardening, yield_stress, mean_strain, mises, multiplier, ratio, factor
   real(dp) :: elastic(6), deviator(6), direction(6)
   integer :: i, j

   mu = props(1) / (2 * (1 + props(2)))
   bulk = props(1) / (3 * (1 - 2 * props(2)))
   hardening = props(4)
   yield_stress = props(3) + hardening * statev(1)

   elastic = statev(2:7)
   elastic(1:ntens) = elastic(1:ntens) + dstran
   mean_strain = sum(elastic(1:3)) / 3
   ! s = 2 mu dev(e), with tensor components in place of engineering shears
   deviator(1:3) = 2 * mu * (elastic(1:3) - mean_strain)
   deviator(4:6) = mu * elastic(4:6)
   mises = sqrt(1.5_dp * (sum(deviator(1:3)**2) + 2 * sum(deviator(4:6)**2)))

   multiplier = 0
   ratio = 1
   factor = 0
   direction = 0
   if (mises > yield_stress) then
      multiplier = (mises - yield_stress) / (3 * mu + hardening)
      ratio = 1 - 3 * mu * multiplier / mises
      direction = deviator / mises
      factor = 9 * mu**2 * (multiplier / mises - 1 / (3 * mu + hardening))
      elastic(1:3) = elastic(1:3) - 1.5_dp * multiplier * direction(1:3)
      elastic(4:6) = elastic(4:6) - 3 * multiplier * direction(4:6)
   end if
   stress = ratio * deviator(1:ntens)
   stress(1:3) = stress(1:3) + 3 * bulk * mean_strain

   do j = 1, ntens
      do i = 1, ntens
         ddsdde(i, j) = factor * direction(i) * direction(j)
         if (i <= ndi .and. j <= ndi) ddsdde(i, j) = ddsdde(i, j) + bulk - 2 * mu * ratio / 3
      end do
      ddsdde(j, j) = ddsdde(j, j) + merge(2, 1, j <= ndi) * mu * ratio
   end do
   statev(1) = statev(1) + multiplier
   statev(2:7) = elastic
   sse = (ratio * mises)**2 / (6 * mu) + 4.5_dp * bulk * mean_strain**2
   spd = props(3) * statev(1) + 0.5_dp * hardening * statev(1)**2
   scd = 0
end subroutine umat
