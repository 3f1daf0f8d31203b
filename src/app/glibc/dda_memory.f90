!> Reuse of memory between cases, for the C library glibc
module dda_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private

   public :: keep_memory

   !> Free memory at the end of the heap that is returned to the system [bytes]
   integer(c_int), parameter :: trim_threshold = -1
   !> Spare memory requested whenever the heap grows [bytes]
   integer(c_int), parameter :: top_pad = -2
   !> Size of arrays above which they get their own pages [bytes]
   integer(c_int), parameter :: mmap_threshold = -3

   interface
      !> C: set a parameter of the allocator
      function c_mallopt(parameter, value) bind(c, name="mallopt") result(done)
         import :: c_int
         integer(c_int), intent(in), value :: parameter  !! One of the above parameters
         integer(c_int), intent(in), value :: value      !! Value of the parameter
         integer(c_int) :: done                          !! 1 on success
      end function c_mallopt
   end interface

contains

   !> Keep freed memory instead of returning it to the system: a case needs as much as the previous
   !> one, and the system must clear new pages, which can take longer than the decision itself
   subroutine keep_memory()
      integer(c_int) :: done

      done = c_mallopt(trim_threshold, huge(done))
      done = c_mallopt(mmap_threshold, 32_c_int*1024_c_int**2)
      done = c_mallopt(top_pad, 1024_c_int**2)
   end subroutine keep_memory
end module dda_memory
