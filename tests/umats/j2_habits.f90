! Von Mises plasticity with linear isotropic hardening and the habits of UMATs that are handed around.
! PROPS: E, nu, initial yield stress, hardening modulus, then habits:
!   energies 0 right, 1 never set, 2 SSE = sigma:epsilon without the half
!   DDSDDE   0 consistent, 1 elastic, 2 never set
!   NTENS    0 obeyed (6 or 4), 1 taken for 6 whatever it is, 2 stops the job if it is not 6
! STATEV: equivalent plastic strain, then the elastic strain (6, engineering shear).
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, &
      temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, &
      dfgrd0, dfgrd1, noel, npt, layer, kspt, jstep, kinc)
   implicit none
   integer, parameter :: dp = kind(1.0d0)
   integer, intent(in) :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
   character(len=80), intent(in) :: cmname
   real(dp), intent(inout) :: stress(*), statev(nstatv), ddsdde(*), sse, spd, scd, rpl
   real(dp), intent(inout) :: ddsddt(*), drplde(*), drpldt, pnewdt
   real(dp), intent(in) :: stran(*), dstran(*), time(2), dtime, temp, dtemp, predef(*), dpred(*)
   real(dp), intent(in) :: props(nprops), coords(3), drot(3, 3), celent, dfgrd0(3, 3), dfgrd1(3, 3)
   real(dp) :: mu, bulk, hardening, yield_stress, mean_strain, mises, multiplier, ratio, factor
   real(dp) :: elastic(6), deviator(6), direction(6), entry
   integer :: i, j, n

   n = ntens
   if (nint(props(7)) == 1) n = 6
   if (nint(props(7)) == 2 .and. ntens /= 6) stop 'THIS UMAT NEEDS SOLID ELEMENTS'
   mu = props(1) / (2 * (1 + props(2)))
   bulk = props(1) / (3 * (1 - 2 * props(2)))
   hardening = props(4)
   yield_stress = props(3) + hardening * statev(1)

   elastic = statev(2:7)
   elastic(1:n) = elastic(1:n) + dstran(1:n)
   mean_strain = sum(elastic(1:3)) / 3
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
   stress(1:n) = ratio * deviator(1:n)
   stress(1:3) = stress(1:3) + 3 * bulk * mean_strain

   if (nint(props(6)) < 2) then
      if (nint(props(6)) == 1) then
         factor = 0
         do j = 1, n
            do i = 1, n
               entry = 0
               if (i <= 3 .and. j <= 3) entry = bulk - 2 * mu / 3
               if (i == j) entry = entry + merge(2, 1, j <= 3) * mu
               ddsdde((j - 1) * n + i) = entry
            end do
         end do
      else
         do j = 1, n
            do i = 1, n
               entry = factor * direction(i) * direction(j)
               if (i <= 3 .and. j <= 3) entry = entry + bulk - 2 * mu * ratio / 3
               if (i == j) entry = entry + merge(2, 1, j <= 3) * mu * ratio
               ddsdde((j - 1) * n + i) = entry
            end do
         end do
      end if
   end if
   statev(1) = statev(1) + multiplier
   statev(2:7) = elastic
   if (nint(props(5)) /= 1) then
      sse = (ratio * mises)**2 / (6 * mu) + 4.5_dp * bulk * mean_strain**2
      if (nint(props(5)) == 2) sse = 2 * sse
      spd = props(3) * statev(1) + 0.5_dp * hardening * statev(1)**2
      scd = 0
   end if
end subroutine umat
