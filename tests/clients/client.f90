! A program that links one plugin by its unique name, -DLAW_UMAT=<law>_umat, and drives a material point along the
! strain path on stdin: NTENS NDI NSHR NSTATV NPROPS, PROPS, the number of increments, NTENS numbers for each.
! Prints the stresses of each increment with 17 digits.
program client
   use, intrinsic :: iso_c_binding, only: c_double, c_int32_t
   use pullout_umat, only: umat_interface
   implicit none
   procedure(umat_interface) :: LAW_UMAT
   integer(c_int32_t) :: ntens, ndi, nshr, nstatv, nprops, kinc, jstep(4)
   integer(c_int32_t), parameter :: one = 1
   integer :: increments
   real(c_double), allocatable :: stress(:), statev(:), ddsdde(:, :), props(:), stran(:), dstran(:), thermal(:, :)
   real(c_double) :: sse, spd, scd, rpl, drpldt, time(2), coords(3), identity(3, 3), pnewdt
   real(c_double), parameter :: zero = 0, unity = 1, none(1) = 0
   character(len=80) :: cmname

   read (*, *) ntens, ndi, nshr, nstatv, nprops
   allocate (stress(ntens), statev(nstatv), ddsdde(ntens, ntens), props(nprops), stran(ntens), dstran(ntens))
   allocate (thermal(ntens, 2))
   read (*, *) props
   read (*, *) increments
   stress = 0
   statev = 0
   stran = 0
   time = 0
   coords = 0
   jstep = [1, 1, 0, 0]
   identity = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
   cmname = 'MATERIAL'
   do kinc = 1, increments
      read (*, *) dstran
      pnewdt = 1e36_c_double
      ! a short line: the law's name takes the place of LAW_UMAT
      call LAW_UMAT(stress, statev, ddsdde, sse, spd, scd, rpl, thermal(:, 1), thermal(:, 2), drpldt, &
         stran, dstran, time, unity, zero, zero, none, none, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, identity, &
         pnewdt, unity, identity, identity, one, one, one, one, jstep, kinc)
      if (pnewdt < 1) error stop 4
      stran = stran + dstran
      write (*, '(6es25.16e3)') stress
   end do
end program client
