! Isotropic elasticity whose procedure stands in a submodule.
module elasticity
  implicit none
  interface
    module subroutine stiffness(c, modulus, nu, ndi)
      double precision, intent(out) :: c(:,:)
      double precision, intent(in) :: modulus, nu
      integer, intent(in) :: ndi
    end subroutine
  end interface
end module
submodule (elasticity) isotropic
contains
  module procedure stiffness
    integer :: i
    c = 0
    c(1:ndi,1:ndi) = modulus*nu/((1 + nu)*(1 - 2*nu))
    do i = 1, size(c, 1)
      c(i,i) = c(i,i) + merge(modulus/(1 + nu), modulus/(2*(1 + nu)), i <= ndi)
    end do
  end procedure
end submodule
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
    dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
    noel, npt, layer, kspt, jstep, kinc)
  use elasticity, only: stiffness
  implicit none
  character(80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens,ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), &
    drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3), &
    drot(3,3), pnewdt, celent, dfgrd0(3,3), dfgrd1(3,3)
  call stiffness(ddsdde, props(1), props(2), ndi)
  stress = stress + matmul(ddsdde, dstran)
  sse = 0.5d0*dot_product(stress, stran + dstran)
end subroutine
