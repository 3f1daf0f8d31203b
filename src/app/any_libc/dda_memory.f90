!> Reuse of memory between cases: no settings for this C library
module dda_memory
   implicit none
   private

   public :: keep_memory

contains

   !> Do nothing: this C library has no settings
   subroutine keep_memory()
   end subroutine keep_memory
end module dda_memory
