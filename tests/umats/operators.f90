! Isotropic elasticity with operators of its own, their dots close to names: sigma = kappa tr(eps) 1 + 2 mu dev(eps).
module tensor_algebra
  implicit none
  interface operator(.ddot.)
    module procedure contracted, double_contracted
  end interface
  interface operator(.dya.)
    module procedure dyadic
  end interface
contains
  pure function double_contracted(a, b) result(c)
    double precision, intent(in) :: a(:), b(:)
    double precision :: c
    c = dot_product(a, b)
  end function
  pure function contracted(a, b) result(c)
    double precision, intent(in) :: a(:,:), b(:)
    double precision :: c(size(a, 1))
    c = matmul(a, b)
  end function
  pure function dyadic(a, b) result(c)
    double precision, intent(in) :: a(:), b(:)
    double precision :: c(size(a), size(b))
    c = spread(a, 2, size(b))*spread(b, 1, size(a))
  end function
end module
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
    dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
    noel, npt, layer, kspt, jstep, kinc)
  use tensor_algebra
  implicit none
  character(80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens,ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
    drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3), &
    drot(3,3), pnewdt, celent, dfgrd0(3,3), dfgrd1(3,3)
  double precision :: unit(ntens), kappa, mu, strain(ntens)
  integer :: i
  kappa = props(1)/(3*(1 - 2*props(2))); mu = props(1)/(2*(1 + props(2)))
  unit = 0
  unit(1:ndi) = 1
  strain = stran + dstran
  ddsdde = (kappa - 2*mu/3)*(unit.dya.unit)
  do i = 1, ntens
    ddsdde(i,i) = ddsdde(i,i) + merge(2*mu, mu, i <= ndi)
  end do
  stress = ddsdde.ddot.strain
  sse = 0.5d0*(stress.ddot.strain)
end subroutine
