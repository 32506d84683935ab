! IV-H in three dimensions: no inelastic strain, no crack band, no delay by confinement. PROPS and STATEV as concrete_damage.
module twin
   implicit none
   integer, parameter :: dp = kind(1d0)

   type :: solid
      real(dp) :: e, nu, lambda, mu, bulk
   end type solid

   ! A branch in uniaxial stress: D(Y), and E_c/E = (1 - D)(1 - beta D)/(1 - rho D);
   ! closing_root is (1 - rho)**(1/B) where rho > beta, or 0.
   type :: branch
      real(dp) :: a, b, threshold, beta, rho, closing_root
   end type branch

   ! The no-tension split: region, compressive strain and its stress.
   type :: split
      integer :: region
      real(dp) :: minus(3), stress(3)
   end type split
contains
   include 'damage_function.inc'

   pure type(solid) function from_bulk_and_shear(bulk, mu) result(s)
      real(dp), intent(in) :: bulk, mu
      s%e = 9 * bulk * mu / (3 * bulk + mu)
      s%nu = (3 * bulk - 2 * mu) / (2 * (3 * bulk + mu))
      s%lambda = bulk - 2 * mu / 3
      s%mu = mu
      s%bulk = bulk
   end function from_bulk_and_shear

   pure function principal_stress(s, strain) result(stress)
      type(solid), intent(in) :: s
      real(dp), intent(in) :: strain(3)
      real(dp) :: stress(3)
      stress = s%lambda * (strain(1) + strain(2) + strain(3)) + 2 * s%mu * strain
   end function principal_stress

   ! Principal strains in descending order.
   pure type(split) function no_tension(s, e) result(r)
      type(solid), intent(in) :: s
      real(dp), intent(in) :: e(3)
      real(dp) :: volumetric, plane
      volumetric = s%lambda * (e(1) + e(2) + e(3))
      if (volumetric + 2 * s%mu * e(1) <= 0) then
         r%region = 1
         r%minus = e
         r%stress = volumetric + 2 * s%mu * e
      else if (e(2) + s%nu * e(3) <= 0) then
         plane = s%e / (1 - s%nu**2)
         r%region = 2
         r%minus = [-s%nu / (1 - s%nu) * (e(2) + e(3)), e(2), e(3)]
         r%stress = [0._dp, plane * (e(2) + s%nu * e(3)), plane * (e(3) + s%nu * e(2))]
      else if (e(3) < 0) then
         r%region = 3
         r%minus = [-s%nu * e(3), -s%nu * e(3), e(3)]
         r%stress = [0._dp, 0._dp, s%e * e(3)]
      else
         r%region = 4
         r%minus = 0
         r%stress = 0
      end if
   end function no_tension

   ! Derivative of the split's stress, principal part.
   pure function split_stiffness(s, region) result(h)
      type(solid), intent(in) :: s
      integer, intent(in) :: region
      real(dp) :: h(3, 3), plane
      h = 0
      select case (region)
      case (1)
         h = full_stiffness(s)
      case (2)
         plane = s%e / (1 - s%nu**2)
         h(2, 2) = plane
         h(3, 3) = plane
         h(2, 3) = s%nu * plane
         h(3, 2) = s%nu * plane
      case (3)
         h(3, 3) = s%e
      end select
   end function split_stiffness

   pure function full_stiffness(s) result(h)
      type(solid), intent(in) :: s
      real(dp) :: h(3, 3)
      integer :: i
      h = s%lambda
      do i = 1, 3
         h(i, i) = s%lambda + 2 * s%mu
      end do
   end function full_stiffness

   ! (s_i - s_j)/(e_i - e_j) of the split, for 12, 13, 23.
   pure function split_shear(s, r, e) result(d)
      type(solid), intent(in) :: s
      type(split), intent(in) :: r
      real(dp), intent(in) :: e(3)
      real(dp) :: d(3), two_mu
      two_mu = 2 * s%mu
      d = 0
      select case (r%region)
      case (1)
         d = two_mu
      case (2)
         d = [open_against(r, e, 1, 2, two_mu), open_against(r, e, 1, 3, two_mu), two_mu]
      case (3)
         d = [0._dp, open_against(r, e, 1, 3, two_mu), open_against(r, e, 2, 3, two_mu)]
      end select
   end function split_shear

   pure real(dp) function open_against(r, e, i, j, two_mu)
      type(split), intent(in) :: r
      real(dp), intent(in) :: e(3), two_mu
      integer, intent(in) :: i, j
      open_against = two_mu
      if (e(i) > e(j)) open_against = min(-r%stress(j) / (e(i) - e(j)), two_mu)
   end function open_against

   pure real(dp) function degradable_energy(s, beta, e)
      type(solid), intent(in) :: s
      real(dp), intent(in) :: beta, e(3)
      real(dp) :: volume
      volume = e(1) + e(2) + e(3)
      degradable_energy = s%mu * sum((e - volume / 3)**2) + 0.5_dp * beta * s%bulk * volume * volume
   end function degradable_energy

   pure type(solid) function degraded(virgin, beta, eta) result(s)
      type(solid), intent(in) :: virgin
      real(dp), intent(in) :: beta, eta
      s = virgin
      if (eta /= 0) s = from_bulk_and_shear((1 - beta + beta / (1 + eta)) * virgin%bulk, virgin%mu / (1 + eta))
   end function degraded

   ! -(f(D_1) - f(D_0))/(D_1 - D_0).
   pure real(dp) function stiffness_loss(c, eta_0, eta_1)
      type(branch), intent(in) :: c
      real(dp), intent(in) :: eta_0, eta_1
      stiffness_loss = 1
      if (c%rho /= c%beta) stiffness_loss = c%beta / c%rho + (1 - c%rho) * (c%rho - c%beta) &
         / (c%rho * (1 - c%rho + c%rho / (1 + eta_0)) * (1 - c%rho + c%rho / (1 + eta_1)))
   end function stiffness_loss

   ! Integral of Y (-f') from the virgin state to a point of the curve.
   pure real(dp) function curve_dissipation(c, eta, y) result(d)
      type(branch), intent(in) :: c
      real(dp), intent(in) :: eta, y
      real(dp) :: p, closing, excess, w, root
      d = 0
      if (eta <= 0) return
      p = 1 / c%b
      root = c%a * (y - c%threshold)
      closing = 1 - c%rho
      w = 1 / (1 + eta)
      excess = c%beta / c%rho * excess_integral(eta, p, root)
      if (c%closing_root > 0) excess = excess + (c%rho - c%beta) / (c%rho * c%closing_root) &
         * excess_integral(closing * eta, p, c%closing_root * root)
      d = c%threshold * (1 - w * (1 - c%beta + c%beta * w) / (1 - c%rho + c%rho * w)) + excess / c%a
   end function curve_dissipation

   ! The same between two points: a Hermite rule where they are close.
   pure real(dp) function branch_dissipation(c, eta_0, y_0, eta_1, y_1) result(d)
      type(branch), intent(in) :: c
      real(dp), intent(in) :: eta_0, y_0, eta_1, y_1
      real(dp) :: step, drop, first_0, second_0, first_1, second_1
      if (eta_0 > 0 .and. (y_1 - y_0) / (y_0 - c%threshold) <= 0.01_dp) then
         step = y_1 - y_0
         drop = (eta_1 - eta_0) / ((1 + eta_1) * (1 + eta_0)) * stiffness_loss(c, eta_0, eta_1)
         call slopes(c, eta_0, y_0, first_0, second_0)
         call slopes(c, eta_1, y_1, first_1, second_1)
         d = 0.5_dp * (y_0 + y_1) * drop + step * step * ((first_1 - first_0) / 10 - step * (second_0 + second_1) / 120)
      else
         d = curve_dissipation(c, eta_1, y_1) - curve_dissipation(c, eta_0, y_0)
      end if
   end function branch_dissipation

   pure subroutine slopes(c, eta, y, first, second)
      type(branch), intent(in) :: c
      real(dp), intent(in) :: eta, y
      real(dp), intent(out) :: first, second
      real(dp) :: w, d, per_excess, rate, change, loss, loss_rate, per_rest, numerator
      w = 1 / (1 + eta)
      d = eta * w
      per_excess = 1 / (y - c%threshold)
      rate = c%b * d * w * per_excess
      change = rate * (c%b - 1 - 2 * c%b * d) * per_excess
      loss = 1
      loss_rate = 0
      if (c%rho /= c%beta) then
         per_rest = 1 / (1 - c%rho + c%rho * w)
         numerator = (1 - c%rho) * (c%rho - c%beta) * per_rest * per_rest
         loss = (c%beta + numerator) / c%rho
         loss_rate = 2 * numerator * per_rest
      end if
      first = loss * rate
      second = loss_rate * rate * rate + loss * change
   end subroutine slopes

   ! Principal values, descending, and directions (columns) of a strain.
   pure subroutine principal(strain, values, v)
      real(dp), intent(in) :: strain(6)
      real(dp), intent(out) :: values(3), v(3, 3)
      real(dp) :: m(3, 3), negligible, swap(3), value
      integer :: sweep, i, j, k
      logical :: rotated
      m = reshape([strain(1), 0.5_dp * strain(4), 0.5_dp * strain(5), 0.5_dp * strain(4), strain(2), &
         0.5_dp * strain(6), 0.5_dp * strain(5), 0.5_dp * strain(6), strain(3)], [3, 3])
      v = 0
      v(1, 1) = 1
      v(2, 2) = 1
      v(3, 3) = 1
      if (m(1, 3) == 0 .and. m(2, 3) == 0) then
         if (m(1, 2) /= 0) call rotate(m, v, 1, 2)
      else
         negligible = 1e-18_dp * maxval(abs(m))
         do sweep = 1, 12
            rotated = .false.
            do i = 1, 2
               do j = i + 1, 3
                  if (abs(m(i, j)) > negligible) then
                     call rotate(m, v, i, j)
                     rotated = .true.
                  end if
               end do
            end do
            if (.not. rotated) exit
         end do
      end if
      values = [m(1, 1), m(2, 2), m(3, 3)]
      do k = 1, 3
         i = merge(2, 1, k == 2)
         if (values(i) < values(i + 1)) then
            value = values(i)
            values(i) = values(i + 1)
            values(i + 1) = value
            swap = v(:, i)
            v(:, i) = v(:, i + 1)
            v(:, i + 1) = swap
         end if
      end do
   end subroutine principal

   pure subroutine rotate(m, v, p, q)
      real(dp), intent(inout) :: m(3, 3), v(3, 3)
      integer, intent(in) :: p, q
      real(dp) :: theta, t, c, s, mp, mq, vp
      integer :: r, k
      theta = 0.5_dp * (m(q, q) - m(p, p)) / m(p, q)
      t = 0
      if (abs(theta) <= huge(theta)) t = sign(1 / (abs(theta) + sqrt(theta * theta + 1)), theta)
      c = 1 / sqrt(t * t + 1)
      s = t * c
      m(p, p) = m(p, p) - t * m(p, q)
      m(q, q) = m(q, q) + t * m(p, q)
      m(p, q) = 0
      m(q, p) = 0
      r = 6 - p - q
      mp = m(r, p)
      mq = m(r, q)
      m(r, p) = c * mp - s * mq
      m(r, q) = s * mp + c * mq
      m(p, r) = m(r, p)
      m(q, r) = m(r, q)
      do k = 1, 3
         vp = v(k, p)
         v(k, p) = c * vp - s * v(k, q)
         v(k, q) = s * vp + c * v(k, q)
      end do
   end subroutine rotate

   ! (n_i n_j + n_j n_i)/2 in components 11, 22, 33, 12, 13, 23.
   pure function dyad(a, b) result(n)
      real(dp), intent(in) :: a(3), b(3)
      real(dp) :: n(6)
      n = [a(1) * b(1), a(2) * b(2), a(3) * b(3), 0.5_dp * (a(1) * b(2) + a(2) * b(1)), &
         0.5_dp * (a(1) * b(3) + a(3) * b(1)), 0.5_dp * (a(2) * b(3) + a(3) * b(2))]
   end function dyad

   pure subroutine elastic(s, strain, stress, stiffness)
      type(solid), intent(in) :: s
      real(dp), intent(in) :: strain(6)
      real(dp), intent(out) :: stress(6), stiffness(6, 6)
      integer :: i
      stress(1:3) = s%lambda * (strain(1) + strain(2) + strain(3)) + 2 * s%mu * strain(1:3)
      stress(4:6) = s%mu * strain(4:6)
      stiffness = 0
      stiffness(1:3, 1:3) = s%lambda
      do i = 1, 3
         stiffness(i, i) = s%lambda + 2 * s%mu
         stiffness(i + 3, i + 3) = s%mu
      end do
   end subroutine elastic
end module twin

subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
      dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, &
      dfgrd1, noel, npt, layer, kspt, jstep, kinc)
   use twin
   implicit none
   include 'arguments.inc'
   type(solid) :: virgin, s, old
   type(branch) :: tension, compression
   type(split) :: r0, r, r_old
   real(dp) :: strain(6), e(3), v(3, 3), e_old(3), v_old(3, 3), undamaged(3), full(3), principal_sigma(3)
   real(dp) :: y_t, y_c, eta_t, eta_c, old_t, old_c, max_t, max_c, w, d, rate_t, rate_c, beta, gain, ratio, first
   real(dp) :: h(3, 3), shear(3), gradient(3), softening(3), dual(3), mean, volume, hydrostatic, n(6, 3), t(6, 3), row(6)
   real(dp) :: y_old_t, y_old_c, full_old(3)
   integer :: i, j, k, first_of(3), second_of(3)
   logical :: grows_t, grows_c
   parameter(first_of = [1, 1, 2], second_of = [2, 3, 3])
   if (props(10) /= 0 .or. any(props(11:14) /= 0)) then
      pnewdt = 0.5_dp
      return
   end if
   beta = props(9)
   virgin%e = props(1)
   virgin%nu = props(2)
   virgin%lambda = props(1) * props(2) / ((1 + props(2)) * (1 - 2 * props(2)))
   virgin%mu = props(1) / (2 * (1 + props(2)))
   virgin%bulk = props(1) / (3 * (1 - 2 * props(2)))
   strain = stran(1:6) + dstran(1:6)
   old_t = statev(1)
   old_c = statev(2)
   scd = 0
   statev(5) = 0
   ! 1: elastic, if a bound without principal values says so
   if (old_t == 0 .and. old_c == 0) then
      block
         real(dp) :: sigma(6), stiffness(6, 6), energy
         call elastic(virgin, strain, sigma, stiffness)
         energy = 0.5_dp * virgin%lambda * (strain(1) + strain(2) + strain(3))**2 &
            + virgin%mu * (sum(strain(1:3)**2) + 0.5_dp * sum(strain(4:6)**2))
         if (sum(sigma(1:3)**2) + 2 * sum(sigma(4:6)**2) <= 2 * props(1) * props(5) .and. energy <= props(8)) then
            stress(1:6) = sigma
            ddsdde(1:6, 1:6) = stiffness
            sse = energy
            spd = statev(13)
            statev(12) = strain(3)
            return
         end if
      end block
   end if
   tension = branch(props(3), props(4), props(5), 1._dp, 1._dp, 0._dp)
   compression = branch(props(6), props(7), props(8), beta, 1 - 2 * (1 + props(2)) / 3 * (1 - beta), 0._dp)
   if (compression%rho > beta .and. compression%rho < 1) compression%closing_root = (1 - compression%rho)**(1 / props(7))
   ! 2: energy release rates
   call principal(strain, e, v)
   undamaged = principal_stress(virgin, e)
   r0 = no_tension(virgin, e)
   y_t = max(undamaged(1), 0._dp)**2 / (2 * props(1))
   y_c = degradable_energy(virgin, beta, r0%minus)
   ! 3: damage
   eta_t = old_t
   eta_c = old_c
   max_t = statev(3)
   max_c = statev(4)
   rate_t = 0
   rate_c = 0
   grows_t = .false.
   grows_c = .false.
   if (y_t > max(max_t, tension%threshold)) then
      max_t = y_t
      eta_t = damage_of(y_t, tension%a, tension%b, tension%threshold)
      grows_t = eta_t > old_t
      if (grows_t) rate_t = damage_rate(y_t, eta_t, tension%b, tension%threshold)
      eta_t = max(eta_t, old_t)
   end if
   if (y_c > max(max_c, compression%threshold)) then
      max_c = y_c
      eta_c = damage_of(y_c, compression%a, compression%b, compression%threshold)
      grows_c = eta_c > old_c
      if (grows_c) rate_c = damage_rate(y_c, eta_c, compression%b, compression%threshold)
      eta_c = max(eta_c, old_c)
   end if
   ! 4: stress
   s = degraded(virgin, beta, eta_c)
   full = principal_stress(s, e)
   r = no_tension(s, e)
   w = 1 / (1 + eta_t)
   d = eta_t / (1 + eta_t)
   principal_sigma = w * full + d * r%stress
   do k = 1, 3
      n(:, k) = dyad(v(:, k), v(:, k))
   end do
   sse = 0.5_dp * dot_product(principal_sigma, e)
   ! 5: dissipation, with the ratios of true forces at both ends
   gain = 0
   if (grows_t .or. grows_c) then
      call principal(stran(1:6), e_old, v_old)
      r_old = no_tension(virgin, e_old)
      y_old_t = max(maxval(principal_stress(virgin, e_old)), 0._dp)**2 / (2 * props(1))
      y_old_c = degradable_energy(virgin, beta, r_old%minus)
      old = degraded(virgin, beta, old_c)
      full_old = principal_stress(old, e_old)
      r_old = no_tension(old, e_old)
      if (grows_t) then
         ratio = max(0.5_dp * dot_product(full - r%stress, e), 0._dp) / max_t
         first = ratio
         if (y_old_t > 0) first = max(0.5_dp * dot_product(full_old - r_old%stress, e_old), 0._dp) / y_old_t
         gain = gain + 0.5_dp * (first + ratio) * branch_dissipation(tension, old_t, statev(3), eta_t, max_t)
      end if
      if (grows_c) then
         ratio = (w * degradable_energy(virgin, beta, e) + d * degradable_energy(virgin, beta, r%minus)) &
            / (max_c * stiffness_loss(compression, eta_c, eta_c))
         first = ratio
         if (y_old_c > 0) first = (degradable_energy(virgin, beta, e_old) / (1 + old_t) &
            + old_t / (1 + old_t) * degradable_energy(virgin, beta, r_old%minus)) &
            / (y_old_c * stiffness_loss(compression, old_c, old_c))
         gain = gain + 0.5_dp * (first + ratio) * branch_dissipation(compression, old_c, statev(4), eta_c, max_c)
      end if
   end if
   ! 6: tangent
   h = w * full_stiffness(s) + d * split_stiffness(s, r%region)
   shear = 2 * w * s%mu + d * split_shear(s, r, e)
   if (grows_t) then
      gradient = max(undamaged(1), 0._dp) / props(1) * virgin%lambda
      gradient(1) = gradient(1) + max(undamaged(1), 0._dp) / props(1) * 2 * virgin%mu
      do j = 1, 3
         h(:, j) = h(:, j) + rate_t * (r%stress - full) * gradient(j)
      end do
   end if
   if (grows_c) then
      mean = (r0%minus(1) + r0%minus(2) + r0%minus(3)) / 3
      gradient = matmul(split_stiffness(virgin, r0%region), r0%minus - mean + beta * mean)
      volume = e(1) + e(2) + e(3)
      mean = (r%minus(1) + r%minus(2) + r%minus(3)) / 3
      hydrostatic = beta / (1 - beta + beta / (1 + eta_c))
      dual = (r%minus - mean) * (1 + eta_c) + hydrostatic * mean
      softening = -(w * (2 * virgin%mu * (e - volume / 3) + beta * virgin%bulk * volume) &
         + d * matmul(split_stiffness(s, r%region), dual))
      do j = 1, 3
         h(:, j) = h(:, j) + rate_c * softening * gradient(j)
      end do
   end if
   if (eta_t == 0 .and. eta_c == 0) then
      call elastic(virgin, strain, stress, ddsdde)
   else
      stress(1:6) = principal_sigma(1) * n(:, 1) + principal_sigma(2) * n(:, 2) + principal_sigma(3) * n(:, 3)
      do k = 1, 3
         t(:, k) = dyad(v(:, first_of(k)), v(:, second_of(k)))
      end do
      ddsdde = 0
      do i = 1, 3
         row = h(i, 1) * n(:, 1) + h(i, 2) * n(:, 2) + h(i, 3) * n(:, 3)
         do k = 1, 6
            do j = 1, 6
               ddsdde(j, k) = ddsdde(j, k) + n(j, i) * row(k) + 2 * shear(i) * t(j, i) * t(k, i)
            end do
         end do
      end do
   end if
   statev(1) = eta_t
   statev(2) = eta_c
   statev(3) = max_t
   statev(4) = max_c
   statev(12) = strain(3)
   statev(13) = statev(13) + gain
   spd = statev(13)
end subroutine umat
