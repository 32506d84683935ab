! A solid with a cohesive crack as a phase field d, which is the temperature (PF-CZM, Wu 2017), without a split of tension and
! compression: stress = omega(d) C strain, field equation div grad d + RPL = 0,
!   RPL = -pi/(2 l Gf) omega'(d) H - (1 - d)/l^2,   H = max(largest energy so far, ft^2/(2 (lambda + 2 mu)))
! DDSDDT and DRPLDE are left at 0, as in public codes. PROPS: E, nu, ft, Gf, l, p, a2, a3. STATEV: H.
module degradation
  implicit none
  double precision, parameter :: pi = 3.14159265358979323846d0, residual = 1d-9
contains
  ! omega and its first two derivatives; below 0 a parabola
  subroutine omega_of(d, a1, p, a2, a3, omega, slope, curvature)
    double precision, intent(in) :: d, a1, p, a2, a3
    double precision, intent(out) :: omega, slope, curvature
    double precision :: g, g1, g2, q, q1, q2
    if (d <= 0) then
      omega = 1
      curvature = 2 * a1 * (a1 - p - a2)
      slope = -a1 + curvature * d
      return
    end if
    g = (1 - d)**p
    g1 = -p * (1 - d)**(p - 1)
    g2 = p * (p - 1) * (1 - d)**(p - 2)
    q = a1 * (d + a2 * d**2 + a3 * d**3)
    q1 = a1 * (1 + 2 * a2 * d + 3 * a3 * d**2)
    q2 = a1 * (2 * a2 + 6 * a3 * d)
    omega = residual + (1 - residual) * g / (g + q)
    slope = (1 - residual) * (g1 * q - g * q1) / (g + q)**2
    curvature = (1 - residual) * ((g2 * q - g * q2) / (g + q)**2 - 2 * (g1 * q - g * q1) * (g1 + q1) / (g + q)**3)
  end subroutine
end module

subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, &
    predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, &
    layer, kspt, jstep, kinc)
  use degradation
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
      drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(*), dpred(*), props(nprops), coords(3), &
      drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  double precision :: mu, lambda, d, drive, threshold, a1, omega, slope, curvature, strain(ntens)
  integer :: i
  mu = props(1) / (2 * (1 + props(2)))
  lambda = 2 * mu * props(2) / (1 - 2 * props(2))
  d = temp + dtemp
  ddsdde = 0
  ddsdde(1:ndi, 1:ndi) = lambda
  do i = 1, ntens
    ddsdde(i, i) = ddsdde(i, i) + merge(2, 1, i <= ndi) * mu
  end do
  strain = stran + dstran
  statev(1) = max(statev(1), 0.5d0 * sum(strain * matmul(ddsdde, strain)))
  threshold = props(3)**2 / (2 * (lambda + 2 * mu))
  drive = max(statev(1), threshold)
  a1 = 2 * props(4) / (pi * props(5) * threshold)
  call omega_of(d, a1, props(6), props(7), props(8), omega, slope, curvature)
  ddsdde = omega * ddsdde
  stress = matmul(ddsdde, strain)
  sse = 0.5d0 * sum(strain * stress)
  rpl = -pi / (2 * props(5) * props(4)) * slope * drive - (1 - d) / props(5)**2
  drpldt = -pi / (2 * props(5) * props(4)) * curvature * drive + 1 / props(5)**2
end subroutine
