!> Critical value of a parameter: a bracket of two decisions, one collapsed and one stable
!>
!> Each way of searching is a submodule: by any parameter, by a load coefficient, by runs in time.
module dda_critical
   use dda_contact_types, only : joint_t
   use dda_friction_cone, only : joint_face_t
   use dda_kinds, only : wp
   use dda_scene, only : family_t, scene_t
   use dda_search, only : critical_t, decision_t, search_t
   implicit none
   private

   public :: find_critical, find_critical_in_time, proposal_t, trace, frozen_mechanism_t
   public :: mechanism_power, foresee

   !> A collapse to be traced from one value of the parameter to another
   type :: frozen_mechanism_t
      type(joint_t), allocatable :: joint(:)      !! The joints: (n_joint)
      type(joint_face_t), allocatable :: face(:)  !! Faces of the joints in its last step: (n_joint)
      !> Motion of its last step without strains: (3, n_equation)
      real(wp), allocatable :: motion(:, :)
      !> Length of a step long enough that elastic motion hides nothing, and short enough that
      !> rounding leaves the power smooth [s]
      real(wp) :: dt = 0.0_wp
   end type frozen_mechanism_t

   !> Where a frozen collapse stops
   type :: proposal_t
      logical :: usable = .false.  !! Whether it stops anywhere
      real(wp) :: value = 0.0_wp   !! The value
      !> Half the width of the bracket to close around it: of the tolerance, or of what the rounded
      !> coordinates can tell apart
      real(wp) :: half = 0.0_wp
      !> How far beyond and before it to decide; more than half where the frozen joints, which know
      !> nothing of moving blocks, only come near
      real(wp) :: reach = 0.0_wp
   end type proposal_t

   interface

      !> Power of the loads on the mechanism. The structure with faces held moves under its loads;
      !> two more solutions with its own inertia as the load leave of that motion the mechanism
      !> alone, which is then measured by the mechanism's motion at the value where it was found
      pure module subroutine mechanism_power(mechanism, scene, power, noise, usable)
         type(frozen_mechanism_t), intent(in) :: mechanism
         type(scene_t), intent(in) :: scene  !! Scene of the value wanted
         real(wp), intent(out) :: power      !! Power: positive where the mechanism moves by itself
         !> What the rounding of the corners' coordinates alone makes of it
         real(wp), intent(out) :: noise
         logical, intent(out) :: usable  !! Whether the power could be found
      end subroutine mechanism_power

      !> Foresee where the collapse of a chain stops, by the secant method on what its forces lack
      pure module subroutine foresee(family, search, critical, proposal, face)
         class(family_t), intent(in) :: family
         type(search_t), intent(in) :: search
         type(critical_t), intent(inout) :: critical  !! New in; its chain and their forces out
         type(proposal_t), intent(out) :: proposal    !! Where it stops, usable if that is known
         !> Faces of the joints of that collapse, where it is known: (n + 1)
         type(joint_face_t), allocatable, intent(out) :: face(:)
      end subroutine foresee

      !> Trace the last collapse to where it stops, by the secant method on the power of the loads;
      !> from the third value on the parabola through three tells what the secant leaves
      pure module subroutine trace(family, search, limit, critical, proposal)
         class(family_t), intent(in) :: family
         type(search_t), intent(in) :: search
         real(wp), intent(in) :: limit  !! The end of the range on the side that stands
         !> What was found so far; the factorisations are counted
         type(critical_t), intent(inout) :: critical
         type(proposal_t), intent(out) :: proposal  !! Where the collapse stops
      end subroutine trace

      !> Give back what a search does not ask a kept decision for: its springs, and its blocks but
      !> for their bars, which the family makes anew at any value
      pure module subroutine shed(decision, keeps_joints)
         type(decision_t), intent(inout) :: decision
         !> Whether it keeps its joints: a load coefficient moves none
         logical, intent(in) :: keeps_joints
      end subroutine shed

      !> Search the critical value of a family of scenes
      pure module subroutine find_critical(family, search, critical)
         class(family_t), intent(in) :: family
         type(search_t), intent(in) :: search
         type(critical_t), intent(out) :: critical
      end subroutine find_critical

      !> Search a family whose parameter is a load coefficient
      pure module subroutine find_critical_load(family, search, critical, done)
         class(family_t), intent(in) :: family
         !> What is searched; where it is not done its low end may become a value that may stand
         !> between others that fall
         type(search_t), intent(inout) :: search
         type(critical_t), intent(inout) :: critical
         logical, intent(out) :: done  !! Whether the search could be done so
      end subroutine find_critical_load

      !> Search the critical value
      pure module subroutine find_critical_in_time(family, search, critical)
         class(family_t), intent(in) :: family
         type(search_t), intent(in) :: search
         type(critical_t), intent(out) :: critical
      end subroutine find_critical_in_time

   end interface

end module dda_critical
