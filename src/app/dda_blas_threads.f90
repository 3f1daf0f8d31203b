!> Number of BLAS threads: one, so that the digits do not depend on concurrent cases
module dda_blas_threads
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private

   public :: set_one_blas_thread, blas_has_locks

   interface
      !> C: restrict BLAS to one thread
      subroutine set_one_blas_thread() bind(c, name="voussoir_set_one_blas_thread")
      end subroutine set_one_blas_thread

      !> C: 1 if threads may call BLAS at the same time, otherwise 0
      function c_blas_has_locks() bind(c, name="voussoir_blas_has_locks") result(has)
         import :: c_int
         integer(c_int) :: has
      end function c_blas_has_locks
   end interface

contains

   !> True if threads may call BLAS at the same time
   logical function blas_has_locks()

      blas_has_locks = c_blas_has_locks() /= 0
   end function blas_has_locks
end module dda_blas_threads
