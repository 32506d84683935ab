! Compressible Ogden from DFGRD1: W = sum mu_p/alpha_p (l1^alpha_p + l2^alpha_p + l3^alpha_p - 3) + kappa/2 (J - 1)^2 of
! the isochoric principal stretches. PROPS: kappa, mu_1, alpha_1, mu_2, alpha_2, ... DDSDDE is that of the unstrained body.
subroutine principal(matrix, values, vectors)
  implicit none
  double precision, intent(in) :: matrix(3, 3)
  double precision, intent(out) :: values(3), vectors(3, 3)
  double precision :: m(3, 3), turn(3, 3), t, theta
  integer :: sweep, p, q, i
  m = matrix
  vectors = 0.0d0
  do i = 1, 3
    vectors(i, i) = 1.0d0
  end do
  do sweep = 1, 20
    do p = 1, 2
      do q = p + 1, 3
        if (abs(m(p, q)) < 1.0d-300) cycle
        theta = 0.5d0*(m(q, q) - m(p, p))/m(p, q)
        t = sign(1.0d0, theta)/(abs(theta) + sqrt(theta*theta + 1.0d0))
        turn = 0.0d0
        do i = 1, 3
          turn(i, i) = 1.0d0
        end do
        turn(p, p) = 1.0d0/sqrt(t*t + 1.0d0)
        turn(q, q) = turn(p, p)
        turn(p, q) = t*turn(p, p)
        turn(q, p) = -turn(p, q)
        m = matmul(transpose(turn), matmul(m, turn))
        vectors = matmul(vectors, turn)
      end do
    end do
  end do
  do i = 1, 3
    values(i) = m(i, i)
  end do
end subroutine principal

subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
    dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
    noel, npt, layer, kspt, jstep, kinc)
  implicit none
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  double precision :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), &
    drplde(ntens), drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), &
    coords(3), drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  integer, parameter :: first(6) = [1, 2, 3, 1, 1, 2], second(6) = [1, 2, 3, 2, 3, 3]
  double precision :: values(3), vectors(3, 3), powers(3), sigma(3), j, shear
  integer :: a, c, i, p
  call principal(matmul(dfgrd1, transpose(dfgrd1)), values, vectors)
  values = sqrt(values)
  j = product(values)
  sigma = props(1)*(j - 1.0d0)
  shear = 0.0d0
  do p = 2, nprops, 2
    powers = (values*j**(-1.0d0/3.0d0))**props(p + 1)
    sigma = sigma + props(p)/j*(powers - sum(powers)/3.0d0)
    shear = shear + 0.5d0*props(p)*props(p + 1)
  end do
  do a = 1, ntens
    stress(a) = 0.0d0
    do i = 1, 3
      stress(a) = stress(a) + sigma(i)*vectors(first(a), i)*vectors(second(a), i)
    end do
    do c = 1, ntens
      ddsdde(a, c) = 0.0d0
      if (a <= 3 .and. c <= 3) ddsdde(a, c) = props(1) - 2.0d0/3.0d0*shear
    end do
    ddsdde(a, a) = ddsdde(a, a) + merge(2.0d0, 1.0d0, a <= 3)*shear
  end do
end subroutine umat
