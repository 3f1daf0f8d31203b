!> Check that BLAS and LAPACK may be called by two threads at the same time
!>
!> Exit status 1: a concurrent result differs from the serial one, or the library is an OpenBLAS
!> that was built without threads and so without locks
program blas_threads
   use, intrinsic :: iso_c_binding, only : c_associated, c_char, c_f_procpointer, c_funptr, c_int, &
      & c_null_char, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only : real64
   implicit none

   interface
      !> C: address of a procedure of the libraries that are loaded
      function c_dlsym(handle, name) bind(c, name="dlsym") result(address)
         import :: c_char, c_funptr, c_ptr
         type(c_ptr), intent(in), value :: handle
         character(kind=c_char), intent(in) :: name(*)
         type(c_funptr) :: address
      end function c_dlsym
   end interface

   abstract interface
      !> OpenBLAS: 0 without threads, 1 with threads of the system, 2 with OpenMP
      function threads_of_openblas() bind(c) result(kind)
         import :: c_int
         integer(c_int) :: kind
      end function threads_of_openblas
   end interface

   !> Orders of the matrices
   integer, parameter :: order(4) = [9, 30, 60, 144]
   !> Factorisations of each order and thread: 100000 together, in about a second
   integer, parameter :: times(4) = [40000, 8000, 2000, 200]
   procedure(threads_of_openblas), pointer :: kind_of_threads
   type(c_funptr) :: address
   integer :: k, n_wrong

   address = c_dlsym(c_null_ptr, "openblas_get_parallel"//c_null_char)
   if (c_associated(address)) then
      call c_f_procpointer(address, kind_of_threads)
      if (kind_of_threads() == 0) stop 1
   end if
   n_wrong = 0
   !$omp parallel num_threads(2) default(shared) private(k) reduction(+:n_wrong)
   do k = 1, size(order)
      call compare(order(k), times(k), n_wrong)
   end do
   !$omp end parallel
   if (n_wrong > 0) stop 1

contains

   !> Count factorisations that differ from one that no other thread disturbs
   subroutine compare(n, times, n_wrong)
      integer, intent(in) :: n           !! Order of the matrix
      integer, intent(in) :: times       !! Number of factorisations
      integer, intent(inout) :: n_wrong  !! Number of results that differ
      real(real64) :: factor(n, n), x(n, n), factor_alone(n, n), x_alone(n, n)
      integer :: i

      !$omp critical
      call factorise(n, factor_alone, x_alone)
      !$omp end critical
      !$omp barrier
      do i = 1, times
         call factorise(n, factor, x)
         if (any(abs(factor - factor_alone) > 0.0_real64) .or. &
            & any(abs(x - x_alone) > 0.0_real64)) n_wrong = n_wrong + 1
      end do
      !$omp barrier
   end subroutine compare

   !> Factor of a positive definite matrix, and a right-hand side divided by it
   subroutine factorise(n, factor, x)
      integer, intent(in) :: n                     !! Order of the matrix
      real(real64), intent(out) :: factor(n, n)    !! Lower triangle
      real(real64), intent(out) :: x(n, n)         !! Quotient
      real(real64) :: a(n, n)
      integer :: i, info, j

      do j = 1, n
         do i = 1, n
            a(i, j) = sin(real(i + 31*j, real64))
         end do
      end do
      factor = 0.0_real64
      do j = 1, n
         factor(j, j) = 1.0_real64
      end do
      call dgemm("N", "T", n, n, n, 1.0_real64, a, n, a, n, 1.0_real64, factor, n)
      call dpotrf("L", n, factor, n, info)
      x = a
      call dtrsm("R", "L", "T", "N", n, n, 1.0_real64, factor, n, x, n)
   end subroutine factorise
end program blas_threads
