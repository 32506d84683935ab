! What the law of hgo.F90 is made of. A module uses another that stands in the same file.
module hgo_precision
  implicit none
  integer, parameter :: dp = selected_real_kind(15, 307)
  integer, parameter :: row(6) = [1, 2, 3, 1, 1, 2], column(6) = [1, 2, 3, 2, 3, 3]
  real(dp), parameter :: one(3, 3) = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1]*1.0_dp, [3, 3])
end module hgo_precision

module hgo_tensors
  use hgo_precision
  implicit none
  interface operator(.dyad.)
    module procedure outer_product
  end interface
contains
  pure function outer_product(a, b) result(c)
    real(dp), intent(in) :: a(3), b(3)
    real(dp) :: c(3, 3)
    c = spread(a, 2, 3)*spread(b, 1, 3)
  end function outer_product

  pure real(dp) function trace(a)
    real(dp), intent(in) :: a(3, 3)
    trace = a(1, 1) + a(2, 2) + a(3, 3)
  end function trace

  pure real(dp) function determinant(a)
    real(dp), intent(in) :: a(3, 3)
    determinant = a(1, 1)*(a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2)) - a(1, 2)*(a(2, 1)*a(3, 3) - a(2, 3)*a(3, 1)) &
      + a(1, 3)*(a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1))
  end function determinant

  pure function deviator(a) result(d)
    real(dp), intent(in) :: a(3, 3)
    real(dp) :: d(3, 3)
    d = a - trace(a)/3.0_dp*one
  end function deviator
end module hgo_tensors
