! The plugin contract of Pullout: UMAT, FRIC and UINTER as Fortran sees them.
!
!    use pullout_umat, only: umat_interface
!    procedure(umat_interface) :: linear_elastic_umat   ! in liblinear_elastic.so and libpullout_laws.so
!
!    use pullout_umat, only: umat_batch_interface
!    procedure(umat_batch_interface), bind(c, name='linear_elastic_umat_batch_v1') :: linear_elastic_batch
!
! Generated from umat-abi/src by the test `contract`; do not edit.
module pullout_umat
   use, intrinsic :: iso_c_binding, only: c_double, c_int32_t, c_ptr, c_size_t
   implicit none
   private
   public :: umat_interface, fric_interface, uinter_interface, umat_batch_interface

   abstract interface
      ! `umat_` as gfortran compiles it on Linux.
      ! The arguments of UMAT in order. Arrays are Fortran arrays: DDSDDE(NTENS,NTENS) column-major.
      subroutine umat_interface( &
            stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, &
            time, dtime, temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, &
            nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, jstep, &
            kinc)
         import :: c_double, c_int32_t
         integer(c_int32_t), intent(in) :: ntens  ! number of components: 11, 22, 33, 12, 13, 23.
         integer(c_int32_t), intent(in) :: nstatv  ! number of state variables.
         integer(c_int32_t), intent(in) :: nprops  ! number of parameters.
         real(c_double), intent(inout) :: stress(ntens)  ! in: stress at the start, rotated by the host; out: at the end.
         real(c_double), intent(inout) :: statev(nstatv)  ! state variables, all 0 in the virgin state.
         real(c_double), intent(inout) :: ddsdde(ntens, ntens)  ! out: consistent tangent, engineering shear; NULL: not requested.
         real(c_double), intent(inout) :: sse  ! out: stored energy per volume.
         real(c_double), intent(inout) :: spd  ! out: dissipated energy per volume.
         real(c_double), intent(inout) :: scd  ! out: energy dissipated by creep per volume; our laws return 0.
         real(c_double), intent(inout) :: rpl  ! out: heat generation per volume and time; 0 on entry, written by coupled laws only.
         real(c_double), intent(inout) :: ddsddt(ntens)  ! out: d stress / d temperature; 0 on entry, written by coupled laws only.
         real(c_double), intent(inout) :: drplde(ntens)  ! out: d RPL / d strain, engineering shear; 0 on entry, written by coupled laws only.
         real(c_double), intent(inout) :: drpldt  ! out: d RPL / d temperature; 0 on entry, written by coupled laws only.
         real(c_double), intent(in) :: stran(ntens)  ! total strain at the start, engineering shear.
         real(c_double), intent(in) :: dstran(ntens)  ! strain increment.
         real(c_double), intent(in) :: time(2)  ! step time and total time at the start.
         real(c_double), intent(in) :: dtime  ! time increment.
         real(c_double), intent(in) :: temp  ! temperature at the start.
         real(c_double), intent(in) :: dtemp  ! temperature increment.
         real(c_double), intent(in) :: predef(*)  ! field variables at the start.
         real(c_double), intent(in) :: dpred(*)  ! increments of the field variables.
         character(len=80), intent(in) :: cmname  ! material name, blank-padded.
         integer(c_int32_t), intent(in) :: ndi  ! number of direct components.
         integer(c_int32_t), intent(in) :: nshr  ! number of shear components.
         real(c_double), intent(in) :: props(nprops)  ! parameters.
         real(c_double), intent(in) :: coords(3)  ! coordinates of the point.
         real(c_double), intent(in) :: drot(3, 3)  ! incremental rotation.
         real(c_double), intent(inout) :: pnewdt  ! out on failure: requested fraction of the increment, in (0,1).
         real(c_double), intent(in) :: celent  ! characteristic element length.
         real(c_double), intent(in) :: dfgrd0(3, 3)  ! deformation gradient at the start.
         real(c_double), intent(in) :: dfgrd1(3, 3)  ! deformation gradient at the end.
         integer(c_int32_t), intent(in) :: noel  ! element number.
         integer(c_int32_t), intent(in) :: npt  ! integration point.
         integer(c_int32_t), intent(in) :: layer  ! layer.
         integer(c_int32_t), intent(in) :: kspt  ! section point.
         integer(c_int32_t), intent(in) :: jstep(4)  ! step number, procedure, NLGEOM, linear perturbation.
         integer(c_int32_t), intent(in) :: kinc  ! increment number.
      end subroutine umat_interface

      ! `fric_` as gfortran compiles it on Linux.
      ! The arguments of FRIC in order.
      subroutine fric_interface( &
            lm, tau, ddtddg, ddtddp, dslip, sed, sfd, ddtddt, pnewdt, statev, dgam, taulm, press, &
            dpress, ddpddh, slip, kstep, kinc, time, dtime, noel, ciname, slname, msname, npt, &
            node, npatch, coords, rcoord, drot, temp, predef, nfdir, mcrd, npred, nstatv, chrlngth, &
            props, nprops)
         import :: c_double, c_int32_t
         integer(c_int32_t), intent(in) :: nfdir  ! number of tangential directions.
         integer(c_int32_t), intent(in) :: mcrd  ! number of coordinates.
         integer(c_int32_t), intent(in) :: nstatv  ! number of state variables.
         integer(c_int32_t), intent(in) :: nprops  ! number of parameters.
         integer(c_int32_t), intent(inout) :: lm  ! LM: on entry 0 slipping, 1 sticking, 2 open; on return 0: TAU, DDTDDG, DDTDDP, DSLIP are given.
         real(c_double), intent(inout) :: tau(nfdir)  ! shear traction.
         real(c_double), intent(inout) :: ddtddg(nfdir, nfdir)  ! out: d tau / d slip.
         real(c_double), intent(inout) :: ddtddp(nfdir)  ! out: d tau / d pressure.
         real(c_double), intent(inout) :: dslip(nfdir)  ! out: inelastic slip increment.
         real(c_double), intent(inout) :: sed  ! out: stored energy per area.
         real(c_double), intent(inout) :: sfd  ! out: dissipated energy per area.
         real(c_double), intent(inout) :: ddtddt(nfdir, 2)  ! d tau / d temperature of the two surfaces; our laws do not write it.
         real(c_double), intent(inout) :: pnewdt  ! out on failure: requested fraction of the increment, in (0,1).
         real(c_double), intent(inout) :: statev(nstatv)  ! state variables, all 0 in the virgin state.
         real(c_double), intent(in) :: dgam(nfdir)  ! slip increment.
         real(c_double), intent(in) :: taulm(nfdir)  ! constraint traction of the sticking point.
         real(c_double), intent(in) :: press  ! pressure at the end, positive in compression.
         real(c_double), intent(in) :: dpress  ! pressure increment.
         real(c_double), intent(in) :: ddpddh  ! d pressure / d overclosure.
         real(c_double), intent(in) :: slip(nfdir)  ! inelastic slip at the start.
         integer(c_int32_t), intent(in) :: kstep  ! step number.
         integer(c_int32_t), intent(in) :: kinc  ! increment number.
         real(c_double), intent(in) :: time(2)  ! step time and total time at the end.
         real(c_double), intent(in) :: dtime  ! time increment.
         integer(c_int32_t), intent(in) :: noel  ! element number.
         character(len=80), intent(in) :: ciname  ! name of the interaction property, blank-padded.
         character(len=80), intent(in) :: slname  ! slave surface.
         character(len=80), intent(in) :: msname  ! master surface.
         integer(c_int32_t), intent(in) :: npt  ! contact point.
         integer(c_int32_t), intent(in) :: node  ! slave node.
         integer(c_int32_t), intent(in) :: npatch  ! master patch.
         real(c_double), intent(in) :: coords(mcrd)  ! coordinates of the point.
         real(c_double), intent(in) :: rcoord(mcrd)  ! projection of the point on the master surface.
         real(c_double), intent(in) :: drot(2, 2)  ! incremental rotation of the tangential directions.
         real(c_double), intent(in) :: temp(2)  ! temperatures of the two surfaces.
         real(c_double), intent(in) :: predef(2, *)  ! field variables of the two surfaces.
         integer(c_int32_t), intent(in) :: npred  ! number of field variables.
         real(c_double), intent(in) :: chrlngth  ! characteristic element length.
         real(c_double), intent(in) :: props(nprops)  ! parameters.
      end subroutine fric_interface

      ! `uinter_` as gfortran compiles it on Linux.
      ! The arguments of UINTER in order.
      subroutine uinter_interface( &
            stress, ddsddr, dviscous, dstructural, flux, ddfddt, ddsddt, ddfddr, statev, sed, sfd, &
            spd, svd, scd, pnewdt, rdisp, drdisp, temp, dtemp, predef, dpred, time, dtime, freqr, &
            ciname, slname, msname, props, coords, alocaldir, drot, area, chrlngth, node, ndir, &
            nstatv, npred, nprops, mcrd, kstep, kinc, kit, linper, lopenclose, lstate, lsdi, lprint)
         import :: c_double, c_int32_t
         integer(c_int32_t), intent(in) :: ndir  ! number of directions, normal included.
         integer(c_int32_t), intent(in) :: nstatv  ! number of state variables.
         integer(c_int32_t), intent(in) :: npred  ! number of field variables.
         integer(c_int32_t), intent(in) :: nprops  ! number of parameters.
         integer(c_int32_t), intent(in) :: mcrd  ! number of coordinates.
         real(c_double), intent(inout) :: stress(ndir)  ! traction; (1) is normal, positive in compression.
         real(c_double), intent(inout) :: ddsddr(ndir, ndir)  ! out: d traction / d relative displacement.
         real(c_double), intent(inout) :: dviscous(ndir, ndir)  ! viscous damping; our laws do not write it.
         real(c_double), intent(inout) :: dstructural(ndir, ndir)  ! structural damping; our laws do not write it.
         real(c_double), intent(inout) :: flux(2)  ! heat fluxes; our laws do not write them.
         real(c_double), intent(inout) :: ddfddt(2, 2)  ! d flux / d temperature; our laws do not write it.
         real(c_double), intent(inout) :: ddsddt(ndir, 2)  ! d traction / d temperature; our laws do not write it.
         real(c_double), intent(inout) :: ddfddr(2, ndir)  ! d flux / d relative displacement; our laws do not write it.
         real(c_double), intent(inout) :: statev(nstatv)  ! state variables, all 0 in the virgin state.
         real(c_double), intent(inout) :: sed  ! out: stored energy per area.
         real(c_double), intent(inout) :: sfd  ! out: dissipated energy per area.
         real(c_double), intent(inout) :: spd  ! out: energy dissipated by plasticity per area; our laws return 0.
         real(c_double), intent(inout) :: svd  ! out: energy dissipated by viscosity per area; our laws return 0.
         real(c_double), intent(inout) :: scd  ! out: energy dissipated by creep per area; our laws return 0.
         real(c_double), intent(inout) :: pnewdt  ! out on failure: requested fraction of the increment, in (0,1).
         real(c_double), intent(in) :: rdisp(ndir)  ! relative displacement at the end; (1) positive is penetration.
         real(c_double), intent(in) :: drdisp(ndir)  ! increment of the relative displacement.
         real(c_double), intent(in) :: temp(2)  ! temperatures of the two surfaces at the end.
         real(c_double), intent(in) :: dtemp(2)  ! temperature increments of the two surfaces.
         real(c_double), intent(in) :: predef(2, npred)  ! field variables at the end.
         real(c_double), intent(in) :: dpred(2, npred)  ! increments of the field variables.
         real(c_double), intent(in) :: time(2)  ! step time and total time at the end.
         real(c_double), intent(in) :: dtime  ! time increment.
         real(c_double), intent(in) :: freqr  ! frequency.
         character(len=80), intent(in) :: ciname  ! name of the interaction property, blank-padded.
         character(len=80), intent(in) :: slname  ! slave surface.
         character(len=80), intent(in) :: msname  ! master surface.
         real(c_double), intent(in) :: props(nprops)  ! parameters.
         real(c_double), intent(in) :: coords(mcrd)  ! coordinates of the point.
         real(c_double), intent(in) :: alocaldir(mcrd, mcrd)  ! local directions; the first is the normal.
         real(c_double), intent(in) :: drot(2, 2)  ! incremental rotation of the tangential directions.
         real(c_double), intent(in) :: area  ! area of the point.
         real(c_double), intent(in) :: chrlngth  ! characteristic element length.
         integer(c_int32_t), intent(in) :: node  ! slave node.
         integer(c_int32_t), intent(in) :: kstep  ! step number.
         integer(c_int32_t), intent(in) :: kinc  ! increment number.
         integer(c_int32_t), intent(in) :: kit  ! iteration number.
         integer(c_int32_t), intent(in) :: linper  ! 1 in a linear perturbation step.
         integer(c_int32_t), intent(inout) :: lopenclose  ! contact state of the point; -1 at the start.
         integer(c_int32_t), intent(inout) :: lstate  ! the law's own flag; -1 at the start.
         integer(c_int32_t), intent(inout) :: lsdi  ! set to 1 to ask for a severe discontinuity iteration.
         integer(c_int32_t), intent(in) :: lprint  ! 1: messages are requested.
      end subroutine uinter_interface

      ! `<law>_umat_batch_v1`: UMAT for n points with the same parameters, to the same bits as n calls.
      subroutine umat_batch_interface( &
            n, ntens, ndi, props, nprops, strain, dstrain, stress, statev, nstatv, ddsdde, celent, &
            status) bind(c)
         import :: c_double, c_int32_t, c_ptr, c_size_t
         integer(c_size_t), value :: n  ! number of points.
         integer(c_int32_t), value :: ntens  ! number of components.
         integer(c_int32_t), value :: ndi  ! number of direct components.
         integer(c_int32_t), value :: nprops  ! number of parameters.
         integer(c_int32_t), value :: nstatv  ! number of state variables.
         real(c_double), intent(in) :: props(nprops)  ! parameters.
         real(c_double), intent(in) :: strain(n, ntens)  ! total strain at the start.
         real(c_double), intent(in) :: dstrain(n, ntens)  ! strain increment.
         real(c_double), intent(inout) :: stress(n, ntens)  ! stress at the start, and at the end.
         real(c_double), intent(inout) :: statev(n, nstatv)  ! state variables.
         type(c_ptr), value :: ddsdde  ! (n, ntens, ntens): out: tangent, column by column; or NULL.
         type(c_ptr), value :: celent  ! (n): characteristic length; or NULL.
         integer(c_int32_t), intent(inout) :: status(n)  ! out: 0 done, 1 a smaller increment is wanted, 2 refused.
      end subroutine umat_batch_interface
   end interface
end module pullout_umat
