! Von Mises plasticity with a hardening table, in three dimensions. PROPS: E, nu, then pairs of yield stress and equivalent
! plastic strain. STATEV: equivalent plastic strain, plastic strain (6), strain 33, dissipated energy.
module twin
   implicit none
   integer, parameter :: dp = kind(1d0)
contains
   ! The last point of the table at or below a plastic strain.
   pure integer function segment(table, n, peeq)
      integer, intent(in) :: n
      real(dp), intent(in) :: table(2, n), peeq
      segment = 1
      do while (segment < n)
         if (table(2, segment + 1) > peeq) exit
         segment = segment + 1
      end do
   end function segment

   pure real(dp) function slope(table, n, k)
      integer, intent(in) :: n, k
      real(dp), intent(in) :: table(2, n)
      slope = 0
      if (k < n) slope = (table(1, k + 1) - table(1, k)) / (table(2, k + 1) - table(2, k))
   end function slope

   pure real(dp) function yield_stress(table, n, peeq)
      integer, intent(in) :: n
      real(dp), intent(in) :: table(2, n), peeq
      integer :: k
      k = segment(table, n, peeq)
      yield_stress = table(1, k) + slope(table, n, k) * (peeq - table(2, k))
   end function yield_stress

   ! Integral of the yield stress.
   pure real(dp) function work(table, n, from, to)
      integer, intent(in) :: n
      real(dp), intent(in) :: table(2, n), from, to
      real(dp) :: start, finish
      integer :: k
      work = 0
      start = from
      k = segment(table, n, from)
      do while (start < to)
         finish = to
         if (k < n) finish = min(to, table(2, k + 1))
         work = work + (finish - start) * (table(1, k) + slope(table, n, k) * (0.5_dp * (start + finish) - table(2, k)))
         start = finish
         k = k + 1
      end do
   end function work
end module twin

subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
      dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, &
      dfgrd1, noel, npt, layer, kspt, jstep, kinc)
   use twin
   implicit none
   include 'arguments.inc'
   real(dp) :: strain(6), deviator(6), direction(6), mu, bulk, volume, mean, trial, peeq, increment, hardening, ratio
   real(dp) :: equivalent, factor, shear, difference(3), square, admissible
   integer :: n, k, i, j
   n = (nprops - 2) / 2
   mu = props(1) / (2 * (1 + props(2)))
   bulk = props(1) / (3 * (1 - 2 * props(2)))
   strain = stran(1:6) + dstran(1:6)
   volume = strain(1) + strain(2) + strain(3)
   mean = bulk * volume
   peeq = statev(1)
   deviator = strain - statev(2:7)
   difference = [deviator(1) - deviator(2), deviator(2) - deviator(3), deviator(3) - deviator(1)]
   deviator(1) = (difference(1) - difference(3)) * (1._dp / 3)
   deviator(2) = (difference(2) - difference(1)) * (1._dp / 3)
   deviator(3) = (difference(3) - difference(2)) * (1._dp / 3)
   square = sum(deviator(1:3)**2) + 0.5_dp * sum(deviator(4:6)**2)
   admissible = yield_stress(props(3:), n, peeq) * (1 + 8 * epsilon(1._dp))
   ratio = 1
   increment = 0
   hardening = 0
   if (6 * mu**2 * square <= admissible**2) then
      sse = mu * square + 0.5_dp * mean * volume
   else
      trial = mu * sqrt(6 * square)
      ! the last joint that the return passes
      k = 1
      do while (k < n)
         if (table(2, k + 1) > peeq .and. trial - 3 * mu * (table(2, k + 1) - peeq) <= table(1, k + 1)) exit
         k = k + 1
      end do
      hardening = slope(props(3:), n, k)
      if (table(2, k) <= peeq) then
         increment = (trial - (table(1, k) + hardening * (peeq - table(2, k)))) / (3 * mu + hardening)
      else
         increment = table(2, k) - peeq + (trial - 3 * mu * (table(2, k) - peeq) - table(1, k)) / (3 * mu + hardening)
      end if
      equivalent = yield_stress(props(3:), n, peeq + increment)
      ratio = equivalent / trial
      sse = equivalent**2 / (6 * mu) + mean**2 / (2 * bulk)
   end if
   shear = ratio * mu
   stress(1:3) = mean + 2 * shear * deviator(1:3)
   stress(4:6) = shear * deviator(4:6)
   ddsdde = 0
   ddsdde(1:3, 1:3) = bulk - 2 * shear / 3
   do i = 1, 3
      ddsdde(i, i) = ddsdde(i, i) + 2 * shear
      ddsdde(i + 3, i + 3) = shear
   end do
   if (increment > 0) then
      direction = deviator * (mu / trial)
      direction(1:3) = 2 * direction(1:3)
      factor = 3 * mu * (hardening / (3 * mu + hardening) - ratio)
      do j = 1, 6
         do i = 1, 6
            ddsdde(i, j) = ddsdde(i, j) + factor * direction(i) * direction(j)
         end do
      end do
      statev(2:7) = statev(2:7) + (3 * mu * increment / trial) * deviator
      statev(9) = statev(9) + work(props(3:), n, peeq, peeq + increment)
      statev(1) = peeq + increment
   end if
   statev(8) = strain(3)
   spd = statev(9)
   scd = 0
contains
   ! Entry of the table: 1 yield stress, 2 plastic strain.
   pure real(dp) function table(which, k)
      integer, intent(in) :: which, k
      table = props(2 + 2 * (k - 1) + which)
   end function table
end subroutine umat
