! Heat of a reaction by HETVAL, after Frank-Kamenetskii: FLUX(1) = rate exp(T). To be built with a UMAT, whose parameters it cannot
! see: the rate is one of the states, STATEV(1), that the case gives. STATEV(2) counts what has been generated.
subroutine hetval(cmname, temp, time, dtime, statev, flux, predef, dpred)
  implicit none
  character(len=80) :: cmname
  double precision :: temp(2), time(2), dtime, statev(*), flux(2), predef(*), dpred(*)
  flux(1) = statev(1) * exp(temp(1))
  flux(2) = flux(1)
  statev(2) = statev(2) + flux(1) * dtime
end subroutine
