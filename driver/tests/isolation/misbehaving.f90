! Linear elasticity that misbehaves in step PROPS(3), increment PROPS(4), in the way that PROPS(2) selects.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
    dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, &
    dfgrd1, noel, npt, layer, kspt, jstep, kinc)
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc, i, fault
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), &
    drplde(ntens), drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(*), dpred(*), &
    props(nprops), coords(3), drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  ddsdde = 0d0
  do i = 1, ntens
    ddsdde(i, i) = merge(1d0, 0.5d0, i <= ndi) * props(1)
  end do
  stress = stress + matmul(ddsdde, dstran)
  fault = 0
  if (jstep(1) == nint(props(3)) .and. kinc == nint(props(4))) fault = nint(props(2))
  select case (fault)
  case (1)
    stop
  case (2)
    stop 'no law for this'
  case (3)
    error stop 3
  case (4)
    ! as ABAQUS's XIT
    call exit(1)
  case (5)
    ! beyond the bounds, which the compiler checks
    i = nstatv + 1
    statev(i) = 1d0
  case (6)
    ! beyond any stack
    stress(1) = stress(1) + total(40000000)
  case (7)
    ! 40 MB, within the stack of a thread that calls plugins
    stress(1) = stress(1) + total(5000000)
  case (8)
    write (*, '(a)') 'a line on the standard output'
    flush (6)
  end select
contains
  double precision function total(n)
    integer, intent(in) :: n
    double precision :: automatic(n)
    automatic = 0d0
    automatic(n) = stran(1)
    total = sum(automatic) - stran(1)
  end function
end subroutine
