!> Critical value of a parameter: a bracket of two decisions, one collapsed and one stable
!>
!> Each way of searching is a submodule: by any parameter, by a load coefficient, by runs in time.
module dda_critical
   use dda_scene, only : family_t
   use dda_search, only : critical_t, search_t
   implicit none
   private

   public :: find_critical, find_critical_in_time

   interface

      !> Search the critical value of a family of scenes
      pure module subroutine find_critical(family, search, critical)
         class(family_t), intent(in) :: family
         type(search_t), intent(in) :: search
         type(critical_t), intent(out) :: critical
      end subroutine find_critical

      !> Search a family whose parameter is a load coefficient
      pure module subroutine find_critical_load(family, search, critical, done)
         class(family_t), intent(in) :: family
         type(search_t), intent(in) :: search
         type(critical_t), intent(inout) :: critical
         !> Whether the search could be done so
         logical, intent(out) :: done
      end subroutine find_critical_load

      !> Search the critical value
      pure module subroutine find_critical_in_time(family, search, critical)
         class(family_t), intent(in) :: family
         type(search_t), intent(in) :: search
         type(critical_t), intent(out) :: critical
      end subroutine find_critical_in_time

   end interface

end module dda_critical
