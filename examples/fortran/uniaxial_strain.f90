! Concrete in uniaxial strain, 20 increments to 4e-4 and 40 to -3e-3: prints e11, s11, s22 and s33 of each.
!
!    gfortran $(pkg-config --variable=fortran_module pullout) uniaxial_strain.f90 $(pkg-config --libs pullout)
program uniaxial_strain
   use, intrinsic :: iso_c_binding, only: c_double, c_int32_t
   use pullout_umat, only: umat_interface
   implicit none
   ! gfortran's name of umat_
   procedure(umat_interface) :: umat
   integer(c_int32_t), parameter :: ntens = 6, ndi = 3, nshr = 3, nstatv = 13, nprops = 14, one = 1
   integer(c_int32_t), parameter :: jstep(4) = [1, 1, 0, 0]
   real(c_double), parameter :: zero = 0, unity = 1, field(1) = 0, origin(3) = 0
   real(c_double), parameter :: identity(3, 3) = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
   ! `pullout plugin info concrete_damage`: E nu, A_t B_t Y_t0, A_c B_c Y_c0, beta zeta_c, b_t b_c, G_f G_c
   real(c_double), parameter :: props(nprops) = [31800d0, 0.18d0, 5000d0, 1.3d0, 0.0001905077d0, 31.47479d0, 1.05d0, &
      3d-4, 0.17227d0, 0d0, 0d0, 0d0, 0d0, 0d0]
   integer, parameter :: increments(2) = [20, 40]
   real(c_double), parameter :: targets(2) = [4d-4, -3d-3]
   ! the material's name tells the laws of libpullout_laws.so apart
   character(len=80), parameter :: cmname = 'CONCRETE_DAMAGE'
   real(c_double) :: stress(ntens), statev(nstatv), stran(ntens), dstran(ntens), ddsdde(ntens, ntens)
   real(c_double) :: ddsddt(ntens), drplde(ntens), sse, spd, scd, rpl, drpldt, pnewdt, time(2)
   integer(c_int32_t) :: kinc
   integer :: step

   ! all zero: the virgin state
   stress = 0
   statev = 0
   stran = 0
   dstran = 0
   time = 0
   do step = 1, 2
      dstran(1) = (targets(step) - stran(1))/increments(step)
      do kinc = 1, increments(step)
         pnewdt = 1d36
         call umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, unity, &
            zero, zero, field, field, cmname, ndi, nshr, ntens, nstatv, props, nprops, origin, identity, pnewdt, &
            unity, identity, identity, one, one, one, one, jstep, kinc)
         if (pnewdt < 1) error stop 'the law asks for a smaller increment'
         stran = stran + dstran
         write (*, '(4es25.16e3)') stran(1), stress(1:3)
      end do
   end do
end program uniaxial_strain
