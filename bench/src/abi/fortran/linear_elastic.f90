! Isotropic elasticity in three dimensions. PROPS: E, nu. STATEV: strain 33, dissipated energy.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
      dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, &
      dfgrd1, noel, npt, layer, kspt, jstep, kinc)
   implicit none
   integer, parameter :: dp = kind(1d0)
   include 'arguments.inc'
   real(dp) :: strain(6), lambda, mu, volume, volumetric
   integer :: i
   lambda = props(1) * props(2) / ((1 + props(2)) * (1 - 2 * props(2)))
   mu = props(1) / (2 * (1 + props(2)))
   strain = stran(1:6) + dstran(1:6)
   volume = strain(1) + strain(2) + strain(3)
   volumetric = lambda * volume
   stress(1:3) = volumetric + 2 * mu * strain(1:3)
   stress(4:6) = mu * strain(4:6)
   ddsdde = 0
   ddsdde(1:3, 1:3) = lambda
   do i = 1, 3
      ddsdde(i, i) = lambda + 2 * mu
      ddsdde(i + 3, i + 3) = mu
   end do
   statev(1) = strain(3)
   statev(2) = 0
   sse = 0.5_dp * lambda * volume**2 + mu * (sum(strain(1:3)**2) + 0.5_dp * sum(strain(4:6)**2))
   spd = 0
   scd = 0
end subroutine umat
