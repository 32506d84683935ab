! Holzapfel, Gasser and Ogden's artery, two families of fibres at +-angle to axis 1, which carry tension only:
!   W = mu/2 (I1 - 3) + kappa/2 (J - 1)^2 + sum k1/(2 k2) (exp(k2 (I4 - 1)^2) - 1), I1 and I4 of J^(-1/3) F.
! PROPS: mu, kappa, k1, k2, angle in degrees. STATEV: I4 of both families.
! DDSDDE: that of the Jaumann rate. PLANTED: the Oldroyd rate's is handed over.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
    dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
    noel, npt, layer, kspt, jstep, kinc)
  use hgo_tensors
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  real(dp) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
    drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3), &
    drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  real(dp), parameter :: degree = acos(-1.0_dp)/180.0_dp
  real(dp) :: f(3, 3), b(3, 3), bar(3, 3), dev(3, 3), sigma(3, 3), along(3), fibre(3, 3, 2), curvature(2), j, e, p, mean
  integer :: a, c, i, k, l, m, family
  j = determinant(dfgrd1)
  f = j**(-1.0_dp/3.0_dp)*dfgrd1
  b = matmul(f, transpose(f))
  bar = props(1)/j*b
  sse = 0.5_dp*props(1)*(trace(b) - 3.0_dp) + 0.5_dp*props(2)*(j - 1.0_dp)**2
  do family = 1, 2
    along = matmul(f, [cos(degree*props(5)), (3 - 2*family)*sin(degree*props(5)), 0.0_dp])
    statev(family) = dot_product(along, along)
    e = max(statev(family) - 1.0_dp, 0.0_dp)
    bar = bar + 2.0_dp/j*props(3)*e*exp(props(4)*e*e)*(along .dyad. along)
    sse = sse + 0.5_dp*props(3)/props(4)*(exp(props(4)*e*e) - 1.0_dp)
    curvature(family) = 0.0_dp
    if (e > 0.0_dp) curvature(family) = 4.0_dp/j*props(3)*(1.0_dp + 2.0_dp*props(4)*e*e)*exp(props(4)*e*e)
    fibre(:, :, family) = deviator(along .dyad. along)
  end do
  mean = trace(bar)/3.0_dp
  dev = deviator(bar)
  p = props(2)*(j - 1.0_dp)
  sigma = dev + p*one
  do a = 1, ntens
    i = row(a)
    k = column(a)
    stress(a) = sigma(i, k)
    do c = 1, ntens
      l = row(c)
      m = column(c)
      ddsdde(a, c) = sum(curvature*fibre(i, k, :)*fibre(l, m, :)) &
        + (mean - p)*(one(i, l)*one(k, m) + one(i, m)*one(k, l)) - 2.0_dp/3.0_dp*mean*one(i, k)*one(l, m) &
        - 2.0_dp/3.0_dp*(dev(i, k)*one(l, m) + one(i, k)*dev(l, m)) &
        + props(2)*(2.0_dp*j - 1.0_dp)*one(i, k)*one(l, m)
#ifndef PLANTED
      ddsdde(a, c) = ddsdde(a, c) + 0.5_dp*(one(i, l)*sigma(k, m) + sigma(i, l)*one(k, m) &
        + one(i, m)*sigma(k, l) + sigma(i, m)*one(k, l))
#endif
    end do
  end do
end subroutine umat
