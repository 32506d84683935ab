! Model I in three dimensions. PROPS: E, nu, A, B, Y_0. STATEV: eta, Y_max, strain 33, dissipated energy.
module twin
   implicit none
   integer, parameter :: dp = kind(1d0)
contains
   include 'damage_function.inc'
end module twin

subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
      dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, &
      dfgrd1, noel, npt, layer, kspt, jstep, kinc)
   use twin
   implicit none
   include 'arguments.inc'
   real(dp) :: strain(6), deviator(6), undamaged(6), difference(3), twice_mu, bulk, volume, y, eta, eta_before, integrity, rate
   integer :: i, j
   twice_mu = props(1) / (1 + props(2))
   bulk = props(1) / (3 * (1 - 2 * props(2)))
   strain = stran(1:6) + dstran(1:6)
   volume = strain(1) + strain(2) + strain(3)
   deviator = strain
   difference = [strain(1) - strain(2), strain(2) - strain(3), strain(3) - strain(1)]
   deviator(1) = (difference(1) - difference(3)) * (1._dp / 3)
   deviator(2) = (difference(2) - difference(1)) * (1._dp / 3)
   deviator(3) = (difference(3) - difference(2)) * (1._dp / 3)
   undamaged(1:3) = twice_mu * deviator(1:3) + bulk * volume
   undamaged(4:6) = 0.5_dp * twice_mu * deviator(4:6)
   y = 0.5_dp * (twice_mu * (sum(deviator(1:3)**2) + 0.5_dp * sum(deviator(4:6)**2)) + bulk * volume * volume)
   eta_before = statev(1)
   eta = max(eta_before, damage_of(y, props(3), props(4), props(5)))
   integrity = 1 / (1 + eta)
   ddsdde = 0
   ddsdde(1:3, 1:3) = integrity * (bulk - twice_mu / 3)
   do i = 1, 3
      ddsdde(i, i) = ddsdde(i, i) + integrity * twice_mu
      ddsdde(i + 3, i + 3) = 0.5_dp * integrity * twice_mu
   end do
   if (eta > eta_before) then
      rate = damage_rate(y, eta, props(4), props(5))
      do j = 1, 6
         do i = 1, 6
            ddsdde(i, j) = ddsdde(i, j) - rate * undamaged(i) * undamaged(j)
         end do
      end do
   end if
   stress(1:6) = integrity * undamaged
   statev(1) = eta
   statev(2) = max(statev(2), y)
   statev(3) = strain(3)
   if (eta > eta_before) statev(4) = max(statev(4), props(5) * eta / (1 + eta) &
      + excess_integral(eta, 1 / props(4), props(3) * (y - props(5))) / props(3))
   sse = integrity * y
   spd = statev(4)
   scd = 0
end subroutine umat
