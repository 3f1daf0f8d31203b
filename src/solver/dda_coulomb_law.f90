!> Coulomb's law at the joints of an assembly, with the history of slip
!>
!> A corner is closed and pushes, or is open; a joint sticks with the shear force that it has, or
!> slides at +-friction*(N1 + N2). Between two states the blocks move and
!>
!>    N = max(0, t),  gap = max(0, -compliance*t),  t = N_before - (opening + gap_before)/compliance
!>    T = t_T within +-friction*(N1 + N2),          t_T = T_before - slip/compliance_T
!>
!> Where both corners are open the joint carries no shear force, and later starts without one. A
!> whole joint carries more: N >= -pull, |T| <= cohesion + friction*(N1 + N2). A corner that opens
!> loses that for good, and so do both where the joint slides.
!>
!> Equation (M4) of docs/method.md
module dda_coulomb_law
   use dda_coulomb_joints, only : coulomb_joints_t, end_role, shear_role
   use dda_crushed_joint, only : can_crush, is_crushed, weight_of
   use dda_joint_graph, only : add_joint_forces, breaks, push_blocks
   use dda_kinds, only : small, wp
   implicit none
   private

   public :: coulomb_state_t, face, face_enum, break_joint, strength
   public :: unloaded_state, add_springs, apply_law, force_faces, imbalance, joint_stiffness
   public :: crush_joint, normal_forces, shear_face, shear_limit, spring_forces, yield_joint

   !> State of a corner or a joint: a corner is open or closed, a joint sticks, slides or is free
   type :: face_enum
      integer(small) :: open = 0_small          !! The corner is open: no force
      integer(small) :: closed = 1_small        !! The corner is closed
      integer(small) :: slides_back = -1_small  !! The joint slides against a negative shear force
      integer(small) :: stuck = 0_small         !! The joint sticks
      integer(small) :: slides = 1_small        !! The joint slides against a positive shear force
      integer(small) :: free = 2_small          !! The joint carries no shear force
   end type face_enum

   !> Names of what corners and joints do
   type(face_enum), parameter :: face = face_enum()

   !> State of an assembly under a load
   type :: coulomb_state_t
      !> Motion of the blocks since nothing was loaded: (3, n_block)
      real(wp), allocatable :: motion(:, :)
      !> N1, N2, T of each joint: (3, n_joint)
      real(wp), allocatable :: force(:, :)
      !> Opening of each corner beyond the point where it would push: (2, n_joint)
      real(wp), allocatable :: gap(:, :)
      !> Slip of each joint that its spring does not give back: (n_joint)
      real(wp), allocatable :: slip(:)
      !> States of corner 1, corner 2 and the joint along itself: (3, n_joint)
      integer(small), allocatable :: face(:, :)
      !> Corners that have kept their strength; unallocated where none has any: (2, n_joint)
      logical, allocatable :: whole(:, :)
      !> Load that it carries: (3, n_block)
      real(wp), allocatable :: load(:, :)
   end type coulomb_state_t

   interface

      !> Normal forces, gaps and corners of a joint that crushes after an increment of openings
      pure module subroutine crush_joint(joints, j, opening, state)
         type(coulomb_joints_t), intent(in) :: joints
         integer, intent(in) :: j            !! Number of the joint
         real(wp), intent(in) :: opening(2)  !! Increments of opening 1 and opening 2
         type(coulomb_state_t), intent(inout) :: state
      end subroutine crush_joint

      !> Normal forces and gaps of a joint that crushes after increments, while its corners stay
      !> open and closed: a strip follows the increment of its force, and an opening is left
      pure module subroutine yield_joint(joints, j, ends, opening, change, state, lag)
         type(coulomb_joints_t), intent(in) :: joints
         integer, intent(in) :: j               !! Number of the joint
         integer(small), intent(in) :: ends(2)  !! States of its corners
         real(wp), intent(in) :: opening(2), change  !! Increments of openings 1 and 2, of N1 + N2
         type(coulomb_state_t), intent(inout) :: state
         real(wp), intent(out) :: lag           !! Opening of both corners that is left
      end subroutine yield_joint

   end interface

contains

   !> The state of joints that carry nothing: no force, no motion; corners are open where they have
   !> gaps
   pure type(coulomb_state_t) function unloaded_state(joints) result(state)
      type(coulomb_joints_t), intent(in) :: joints
      integer :: i, j, n_block, n_joint

      n_block = joints%graph%n_block
      n_joint = size(joints%shear_role)
      allocate (state%motion(3, n_block), state%load(3, n_block))
      allocate (state%force(3, n_joint), state%gap(2, n_joint), state%slip(n_joint))
      allocate (state%face(3, n_joint))
      state%motion = 0.0_wp
      state%load = 0.0_wp
      state%force = 0.0_wp
      state%slip = 0.0_wp
      state%gap = 0.0_wp
      if (allocated(joints%graph%gap)) state%gap = joints%graph%gap
      if (breaks(joints%graph)) state%whole = joints%graph%cohesion > 0.0_wp &
         & .or. joints%graph%pull > 0.0_wp
      do j = 1, n_joint
         do i = 1, 2
            if (joints%end_role(i, j) == end_role%absent) state%gap(i, j) = 0.0_wp
            state%face(i, j) = merge(face%closed, face%open, &
               & joints%end_role(i, j) == end_role%tied .or. &
               & (joints%end_role(i, j) == end_role%contact .and. .not. state%gap(i, j) > 0.0_wp))
         end do
         state%face(3, j) = shear_face(joints, j, state%face(:2, j), face%stuck)
      end do
      if (allocated(state%whole)) state%whole = state%whole .and. state%face(:2, :) == face%closed
   end function unloaded_state

   !> Strength of a joint beside friction: how far its corners can be pulled, at most as far as the
   !> apex of its law, and the shear force that it carries without a normal force
   pure function strength(joints, state, j)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: state
      integer, intent(in) :: j  !! Number of the joint
      real(wp) :: strength(3)   !! Pull of corner 1, of corner 2, cohesion

      strength = 0.0_wp
      if (.not. allocated(state%whole)) return
      associate (graph => joints%graph, whole => state%whole(:, j))
         strength(:2) = merge(graph%pull(:, j), 0.0_wp, whole)
         strength(3) = sum(graph%cohesion(:, j), whole)
         if (joints%shear_role(j) == shear_role%frictional .and. &
            & graph%friction(j)*sum(strength(:2)) > strength(3)) strength(:2) = &
            & strength(:2)*(strength(3)/(graph%friction(j)*sum(strength(:2))))
      end associate
   end function strength

   !> Largest shear force that a joint bears: without end where it cannot slide
   pure real(wp) function shear_limit(joints, j, normal, cohesion) result(limit)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j                    !! Number of the joint
      real(wp), intent(in) :: normal(2)           !! N1, N2
      real(wp), intent(in), optional :: cohesion  !! Shear force without them; 0 if absent

      limit = huge(limit)
      if (joints%shear_role(j) /= shear_role%frictional) return
      limit = joints%graph%friction(j)*(normal(1) + normal(2))
      if (present(cohesion)) limit = limit + cohesion
   end function shear_limit

   !> State of a joint along itself, where only one is possible
   pure integer(small) function shear_face(joints, j, ends, otherwise)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j          !! Number of the joint
      integer(small), intent(in) :: ends(2)    !! States of its corners: (2)
      integer(small), intent(in) :: otherwise  !! Its state where several are possible

      shear_face = otherwise
      if (joints%shear_role(j) == shear_role%absent) then
         shear_face = face%free
      else if (joints%shear_role(j) == shear_role%tied) then
         shear_face = face%stuck
      else if (all(ends == face%open) .and. .not. is_crushed(joints, j)) then
         shear_face = face%free
      end if
   end function shear_face

   !> Forces, gaps and faces after an increment of openings
   pure subroutine apply_law(joints, before, opening, after)
      type(coulomb_joints_t), intent(in) :: joints
      !> State before
      type(coulomb_state_t), intent(in) :: before
      !> Increments of opening 1, opening 2 and slip: (3, n_joint)
      real(wp), intent(in), contiguous :: opening(:, :)
      !> State after; its motion and load are left alone
      type(coulomb_state_t), intent(inout) :: after
      real(wp) :: bond(3), trial
      integer :: i, j

      do j = 1, size(opening, 2)
         bond = strength(joints, before, j)
         do i = 1, 2
            associate (c => joints%graph%compliance(j), f => after%force(i, j))
               after%gap(i, j) = 0.0_wp
               select case (joints%end_role(i, j))
               case (end_role%contact)
                  trial = before%force(i, j) - (opening(i, j) + before%gap(i, j))/c
                  after%face(i, j) = merge(face%open, face%closed, trial < -bond(i))
                  f = merge(0.0_wp, trial, after%face(i, j) == face%open)
                  if (after%face(i, j) == face%open) after%gap(i, j) = -trial*c
               case (end_role%tied)
                  f = before%force(i, j) - (opening(i, j) + before%gap(i, j))/c
                  after%face(i, j) = face%closed
               case default
                  f = 0.0_wp
                  after%face(i, j) = face%open
               end select
            end associate
         end do
         if (can_crush(joints, j)) then
            after%force(:2, j) = before%force(:2, j)
            after%gap(:, j) = before%gap(:, j)
            after%face(:2, j) = before%face(:2, j)
            call crush_joint(joints, j, opening(:2, j), after)
         end if
         trial = before%force(3, j) - opening(3, j)/joints%graph%compliance(j)
         after%face(3, j) = face%stuck
         after%force(3, j) = trial
         if (abs(trial) > shear_limit(joints, j, after%force(:2, j), bond(3))) then
            after%face(3, j) = merge(face%slides, face%slides_back, trial > 0.0_wp)
            after%force(3, j) = sign(max(0.0_wp, shear_limit(joints, j, after%force(:2, j))), trial)
         end if
         after%face(3, j) = shear_face(joints, j, after%face(:2, j), after%face(3, j))
         if (after%face(3, j) == face%free) after%force(3, j) = 0.0_wp
         after%slip(j) = before%slip(j) + joints%graph%compliance(j)*(after%force(3, j) - trial)
      end do
      if (.not. allocated(before%whole)) return
      after%whole = before%whole
      do j = 1, size(opening, 2)
         call break_joint(joints, j, after)
      end do
   end subroutine apply_law

   !> Take from a joint the strength of what has opened or slides, and from its forces what the rest
   !> does not carry
   pure subroutine break_joint(joints, j, state)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j  !! Number of the joint
      type(coulomb_state_t), intent(inout) :: state
      real(wp) :: bond(3), bound, shear
      logical :: broken, was_whole(2)
      integer :: i

      shear = state%force(3, j)
      do
         was_whole = state%whole(:, j)
         state%whole(:, j) = was_whole .and. state%face(:2, j) == face%closed &
            & .and. abs(state%face(3, j)) /= face%slides
         broken = any(was_whole .neqv. state%whole(:, j))
         bond = strength(joints, state, j)
         do i = 1, 2
            if (joints%end_role(i, j) /= end_role%contact) cycle
            if (.not. state%force(i, j) < -bond(i)) cycle
            state%gap(i, j) = -state%force(i, j)*joints%graph%compliance(j)
            state%force(i, j) = 0.0_wp
            state%face(i, j) = face%open
            broken = .true.
         end do
         state%face(3, j) = shear_face(joints, j, state%face(:2, j), state%face(3, j))
         bound = shear_limit(joints, j, state%force(:2, j), bond(3))
         if (abs(state%force(3, j)) > bound .and. state%face(3, j) == face%stuck) then
            state%face(3, j) = merge(face%slides, face%slides_back, state%force(3, j) > 0.0_wp)
            broken = .true.
         end if
         if (state%face(3, j) == face%free) then
            state%force(3, j) = 0.0_wp
         else if (state%face(3, j) /= face%stuck) then
            state%force(3, j) = real(state%face(3, j), wp)*bound
         end if
         if (.not. broken) exit
      end do
      state%slip(j) = state%slip(j) + joints%graph%compliance(j)*(state%force(3, j) - shear)
   end subroutine break_joint

   !> Stiffness of a joint: rate of force = -stiffness*rate of opening
   pure function joint_stiffness(joints, j, faces) result(stiffness)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j
      integer(small), intent(in) :: faces(3)  !! Its states: (3)
      real(wp) :: stiffness(3, 3)      !! Rows N1, N2, T; columns opening 1, opening 2, slip
      real(wp) :: unit(2)
      integer :: i

      stiffness = 0.0_wp
      do i = 1, 2
         unit = 0.0_wp
         unit(i) = -1.0_wp
         stiffness(:2, i) = normal_forces(joints, j, faces(:2), unit)
      end do
      select case (faces(3))
      case (face%slides, face%slides_back)
         do i = 1, 2
            stiffness(3, i) = real(faces(3), wp)*joints%graph%friction(j)*sum(stiffness(:2, i))
         end do
      case (face%stuck)
         stiffness(3, 3) = 1.0_wp/joints%graph%compliance(j)
      end select
   end function joint_stiffness

   !> Normal forces by which the springs of a joint answer openings while its corners stay: where
   !> one of a joint that crushes is open, at the edge of its strip
   pure function normal_forces(joints, j, ends, opening) result(force)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j               !! Number of the joint
      integer(small), intent(in) :: ends(2)  !! States of its corners
      real(wp), intent(in) :: opening(2)     !! Opening 1, opening 2
      real(wp) :: force(2)                   !! N1, N2
      real(wp) :: weight(2)

      force = 0.0_wp
      if (ends(1) == face%closed) force(1) = -opening(1)/joints%graph%compliance(j)
      if (ends(2) == face%closed) force(2) = -opening(2)/joints%graph%compliance(j)
      if (.not. allocated(joints%share) .or. ends(1) == ends(2)) return
      if (.not. can_crush(joints, j)) return
      weight = weight_of(joints, j, merge(1, 2, ends(1) == face%closed))
      force = -weight*sum(weight*opening)/(joints%graph%compliance(j)*sum(weight**2) &
         & + joints%slack(j)/joints%graph%crush(j))
   end function normal_forces

   !> Forces by which the springs of a joint answer its openings while the faces stay
   pure function spring_force(joints, j, faces, opening) result(force)
      type(coulomb_joints_t), intent(in) :: joints
      integer, intent(in) :: j
      integer(small), intent(in) :: faces(3)
      real(wp), intent(in) :: opening(3)  !! Opening 1, opening 2, slip
      real(wp) :: force(3)                !! N1, N2, T

      force(:2) = merge(-opening(:2)/joints%graph%compliance(j), 0.0_wp, faces(:2) == face%closed)
      if (allocated(joints%share)) force(:2) = normal_forces(joints, j, faces(:2), opening(:2))
      select case (faces(3))
      case (face%stuck)
         force(3) = -opening(3)/joints%graph%compliance(j)
      case (face%free)
         force(3) = 0.0_wp
      case default
         force(3) = real(faces(3), wp)*joints%graph%friction(j)*(force(1) + force(2))
      end select
   end function spring_force

   !> The same of all joints
   pure subroutine spring_forces(joints, faces, opening, force)
      type(coulomb_joints_t), intent(in) :: joints
      !> States of corners and joints: (3, n_joint)
      integer(small), intent(in), contiguous :: faces(:, :)
      real(wp), intent(in), contiguous :: opening(:, :)
      !> N1, N2, T: (3, n_joint)
      real(wp), intent(out), contiguous :: force(:, :)
      integer :: j

      do j = 1, size(faces, 2)
         force(:, j) = spring_force(joints, j, faces(:, j), opening(:, j))
      end do
   end subroutine spring_forces

   !> Add to a load what the springs of all joints make of openings while the faces stay, and how
   !> viscous joints damp them
   pure subroutine add_springs(joints, faces, opening, viscosity, load)
      type(coulomb_joints_t), intent(in) :: joints
      integer(small), intent(in), contiguous :: faces(:, :)
      real(wp), intent(in), contiguous :: opening(:, :)  !! Openings and slips: (3, n_joint)
      real(wp), intent(in) :: viscosity                  !! Multiple of their stiffness
      real(wp), intent(inout), contiguous :: load(:, :)  !! The load: (3, n_block)
      integer :: j

      do j = 1, size(opening, 2)
         call push_blocks(1, joints%graph%block(:, j), joints%graph%row(:, :, :, j), &
            & spring_force(joints, j, faces(:, j), opening(:, j)) &
            & - viscosity*opening(:, j)/joints%graph%compliance(j), load)
      end do
   end subroutine add_springs

   !> Unbalanced part of a load
   pure subroutine imbalance(joints, load, force, rest)
      type(coulomb_joints_t), intent(in) :: joints
      real(wp), intent(in), contiguous :: load(:, :)   !! The load: (3, n_block)
      real(wp), intent(in), contiguous :: force(:, :)  !! Joint forces: (3, n_joint)
      real(wp), intent(out), contiguous :: rest(:, :)  !! Load and joint forces: (3, n_block)

      rest = load
      call add_joint_forces(joints%graph, force, rest)
   end subroutine imbalance

   !> Forces of a state whose joints take other faces, before anything has moved
   pure subroutine force_faces(joints, state, faces, change)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_state_t), intent(in) :: state
      integer(small), intent(in), contiguous :: faces(:, :)
      real(wp), intent(out), contiguous :: change(:, :)  !! Change of N1, N2 and T: (3, n_joint)
      integer :: i, j

      do j = 1, size(faces, 2)
         do i = 1, 2
            change(i, j) = -state%force(i, j)
            if (faces(i, j) == face%closed) then
               change(i, j) = -state%gap(i, j)/joints%graph%compliance(j)
            end if
         end do
         select case (faces(3, j))
         case (face%stuck)
            change(3, j) = 0.0_wp
         case (face%free)
            change(3, j) = -state%force(3, j)
         case default
            change(3, j) = real(faces(3, j), wp)*joints%graph%friction(j) &
               & *sum(state%force(:2, j) + change(:2, j)) - state%force(3, j)
         end select
      end do
   end subroutine force_faces
end module dda_coulomb_law
