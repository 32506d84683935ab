! A program that links two laws and strains two points along x by the batch of each; prints the stresses of the second point.
program client
   use, intrinsic :: iso_c_binding, only: c_double, c_int32_t, c_loc, c_null_ptr, c_size_t
   use pullout_umat, only: umat_batch_interface
   implicit none
   procedure(umat_batch_interface), bind(c, name='linear_elastic_umat_batch_v1') :: elastic
   procedure(umat_batch_interface), bind(c, name='j2_plasticity_umat_batch_v1') :: plastic
   integer(c_size_t), parameter :: n = 2
   integer(c_int32_t), parameter :: ntens = 6, ndi = 3
   real(c_double), parameter :: dstrain(6) = [4e-3_c_double, -1e-3_c_double, -5e-4_c_double, 1e-3_c_double, 2e-3_c_double, &
      3e-3_c_double]
   real(c_double), target :: ddsdde(n, ntens, ntens), celent(n)
   real(c_double) :: strain(n, ntens), stress(n, ntens), statev(n, 9)
   integer(c_int32_t) :: status(n)

   strain = 0
   celent = 1
   stress = 0
   statev = 0
   call elastic(n, ntens, ndi, [210e3_c_double, 0.3_c_double], 2, strain, spread(dstrain, 1, int(n)), stress, statev, 2, &
      c_loc(ddsdde), c_loc(celent), status)
   write (*, '(6es25.16e3, 2i3)') stress(2, :), status
   ! the tangent is Hooke's
   if (abs(dot_product(ddsdde(2, 1, :), dstrain) - stress(2, 1)) > 1e-9_c_double*abs(stress(2, 1))) error stop 3
   stress = 0
   statev = 0
   call plastic(n, ntens, ndi, [210e3_c_double, 0.3_c_double, 347.0_c_double, 0.0_c_double, 400.0_c_double, 0.1_c_double], 6, &
      strain, spread(dstrain, 1, int(n)), stress, statev, 9, c_null_ptr, c_null_ptr, status)
   write (*, '(6es25.16e3, 2i3)') stress(2, :), status
end program client
