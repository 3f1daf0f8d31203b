!> Collapse mechanism: hinges, sliding share and mode of the last step
module dda_mechanism
   use dda_contacts, only : contacts_t
   use dda_decision, only : run_under
   use dda_frames, only : album_t, blank_album
   use dda_friction_cone, only : joint_face_t
   use dda_kinds, only : wp
   use dda_scene, only : scene_t
   use dda_scene_graph, only : decides_as_graph
   use dda_search, only : decision_t
   use dda_settings, only : flow_rule, verdict
   use dda_sort, only : sorted_order
   implicit none
   private

   public :: mechanism_t, mechanism_of, follow_collapse
   public :: mechanism_role, mechanism_role_enum, role_of_joint
   public :: largest_of, slides

   !> Role of a joint in a mechanism
   type :: mechanism_role_enum
      integer :: locked = 0        !! Both corners closed and stuck
      integer :: open = 1          !! Both corners open
      integer :: sliding = 2       !! Slides, and does not open
      integer :: hinge_first = 3   !! Turns about its first corner: in an arch the intrados
      integer :: hinge_second = 4  !! Turns about its second corner: in an arch the extrados
   end type mechanism_role_enum

   !> Names of the roles
   type(mechanism_role_enum), parameter :: mechanism_role = mechanism_role_enum()

   !> A collapse mechanism
   type :: mechanism_t
      !> rotational, mixed or sliding; none if no joint turns or slides
      character(len=10) :: mode = "none"
      !> Slip of closed joints over this and the opening of hinges
      real(wp) :: sliding_share = 0.0_wp
      !> Hinges at the intrados, as angles from the crown, each once: (n) [deg]
      real(wp), allocatable :: intrados_deg(:)
      real(wp), allocatable :: extrados_deg(:)  !! Hinges at the extrados, likewise: (n) [deg]
      !> intrados, extrados or none: where the springings turn; blank where there is no arch
      character(len=8) :: springing = ""
   end type mechanism_t

   !> Opening below which it is elastic, over the largest opening or slip
   real(wp), parameter :: elastic_share = 1.0e-4_wp
   !> Slip below which it is round-off, over the largest displacement
   real(wp), parameter :: least_slip = 1.0e-6_wp
   !> Sliding share below which the mode is rotation; above its complement, sliding
   real(wp), parameter :: little = 1.0e-3_wp
   !> Maximum number of blocks whose collapse is followed by steps under Coulomb friction
   integer, parameter :: most_followed = 300

contains

   !> Follow a collapse under Coulomb friction where joints slide in it, for its motion to be that
   !> of joints that do not open by sliding
   pure subroutine follow_collapse(scene, decision, album)
      type(scene_t), intent(in) :: scene
      !> Its decision; becomes that of the run under Coulomb friction if that one falls too
      type(decision_t), intent(inout) :: decision
      type(album_t), intent(inout) :: album  !! Its pictures; become those of the other run with it
      type(decision_t) :: other
      type(album_t) :: pictures

      if (decision%by_graph .or. decision%flow == flow_rule%coulomb) return
      if (scene%settings%verdict_flow == flow_rule%associated) return
      if (.not. any(decision%contacts%face%slip /= 0)) return
      if (maxval(scene%system%equation) > most_followed &
         & .and. decides_as_graph(scene%settings, scene%contacts)) return
      pictures = blank_album(album)
      call run_under(flow_rule%coulomb, scene%settings, scene%system, scene%contacts, other, &
         & pictures)
      if (other%outcome%verdict /= verdict%collapsed) return
      decision = other
      album = pictures
   end subroutine follow_collapse

   !> The mechanism of the last step of a collapse
   pure subroutine mechanism_of(contacts, joint_angle_deg, mechanism, motion)
      type(contacts_t), intent(in) :: contacts  !! Contacts at the end of the collapse
      !> Angle of each joint from the crown, or none where there is no arch: (n_joint) or (0) [deg]
      real(wp), intent(in) :: joint_angle_deg(:)
      type(mechanism_t), intent(out) :: mechanism
      !> Motion of the blocks in the step, where it is known: (n_dof, n_equation)
      real(wp), intent(in), optional :: motion(:, :)
      integer :: role(size(contacts%face)), n
      real(wp) :: largest, opening, slip

      largest = largest_of(contacts, motion)
      role = role_of_joint(contacts, largest)
      n = size(joint_angle_deg)
      associate (increment => contacts%increment)
         slip = sum(abs(increment(3, :)), mask=slides(contacts%face, increment(3, :), largest))
         opening = sum(increment(1, :), mask=role == mechanism_role%hinge_second) &
            & + sum(increment(2, :), mask=role == mechanism_role%hinge_first)
      end associate
      allocate (mechanism%intrados_deg(0), mechanism%extrados_deg(0))
      if (n > 0) then
         mechanism%springing = "none"
         mechanism%intrados_deg = &
            & each_once(abs(pack(joint_angle_deg, role == mechanism_role%hinge_first)))
         mechanism%extrados_deg = &
            & each_once(abs(pack(joint_angle_deg, role == mechanism_role%hinge_second)))
         if (any(role([1, n]) == mechanism_role%hinge_first)) mechanism%springing = "intrados"
         if (any(role([1, n]) == mechanism_role%hinge_second)) mechanism%springing = "extrados"
      end if
      if (.not. slip + opening > 0.0_wp) return
      mechanism%sliding_share = slip/(slip + opening)
      mechanism%mode = "mixed"
      if (mechanism%sliding_share < little) mechanism%mode = "rotational"
      if (mechanism%sliding_share > 1.0_wp - little) mechanism%mode = "sliding"
   end subroutine mechanism_of

   !> Role of every joint in the last step; openings small beside the largest motion are elastic. A
   !> joint turns about a corner that is closed, also if it slides there
   pure function role_of_joint(contacts, largest) result(role)
      type(contacts_t), intent(in) :: contacts  !! Contacts at the end of a step
      real(wp), intent(in) :: largest  !! Largest displacement in the step, of `largest_of` [m]
      integer :: role(size(contacts%face))  !! One of mechanism_role each: (n_joint)
      real(wp) :: least
      logical :: opens(2)
      integer :: j

      least = elastic_share*maxval(abs(contacts%increment))
      role = merge(mechanism_role%sliding, mechanism_role%locked, slides(contacts%face, &
         & contacts%increment(3, :), largest))
      do j = 1, size(role)
         opens = contacts%face(j)%open .and. contacts%increment(1:2, j) > least
         if (.not. any(opens)) cycle
         role(j) = merge(mechanism_role%hinge_second, mechanism_role%hinge_first, opens(1))
         if (all(contacts%face(j)%open)) role(j) = mechanism_role%open
      end do
   end function role_of_joint

   !> True if a joint slides: it is closed, at the Coulomb limit, and its slip is more than rounding
   elemental logical function slides(face, slip, largest)
      type(joint_face_t), intent(in) :: face  !! Face that its force lies on
      real(wp), intent(in) :: slip            !! Its slip [m]
      real(wp), intent(in) :: largest         !! Largest displacement in the same time [m]

      slides = face%slip /= 0 .and. .not. all(face%open) .and. abs(slip) > least_slip*largest
   end function slides

   !> Largest displacement in the last step: of a centre, or of the sides of a joint past another
   pure real(wp) function largest_of(contacts, motion)
      type(contacts_t), intent(in) :: contacts
      real(wp), intent(in), optional :: motion(:, :)

      largest_of = max(0.0_wp, maxval(abs(contacts%increment)))
      if (present(motion)) largest_of = max(largest_of, maxval(norm2(motion(1:2, :), dim=1)))
   end function largest_of

   !> Numbers in ascending order without repetition; equal up to rounding counts as equal
   pure function each_once(numbers) result(once)
      real(wp), intent(in) :: numbers(:)  !! Any numbers: (:)
      real(wp), allocatable :: once(:)    !! The numbers: (:)
      integer :: i

      once = numbers(sorted_order(spread(0, 1, size(numbers)), numbers))
      once = pack(once, [(i == 1 .or. once(i) > once(max(1, i - 1)) + 1.0e-9_wp, i=1, size(once))])
   end function each_once
end module dda_mechanism
