!> Memory that is used again from case to case: left to the C library
module dda_memory
   implicit none
   private

   public :: keep_memory

contains

   !> Nothing to be told to this C library
   subroutine keep_memory()
   end subroutine keep_memory
end module dda_memory
