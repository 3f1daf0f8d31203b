!> Motion of corners in a step, and the reach of the contact search
module dda_step_reach
   use dda_block_system, only : block_system_t
   use dda_contact_types, only : joint_t
   use dda_contacts, only : contacts_t
   use dda_deformation, only : displacement_matrix
   use dda_kinds, only : wp
   use dda_settings, only : load_direction, settings_t
   use dda_step_context, only : march_t, run_t, step_context_t, step_outcome_t
   use dda_step_interval, only : aim, cut, longest_motion
   implicit none
   private

   public :: check_margins, first_reach, next_reach, reach_like_neighbours, travel_by, travel_of
   public :: widen_margins

   !> Least reach over the block size
   real(wp), parameter :: least_reach = 1.0e-3_wp
   !> Reach over the expected motion
   real(wp), parameter :: margin = 1.5_wp

contains

   !> Reach of the blocks before anything has moved: what speed and free fall make of a first step
   pure function first_reach(system, settings, march) result(reach)
      type(block_system_t), intent(in) :: system
      type(settings_t), intent(in) :: settings
      type(march_t), intent(in) :: march  !! The march, with the length of the step
      !> Most that the corners of each block are expected to move: (n_block) [m]
      real(wp) :: reach(size(system%area))
      real(wp) :: radius
      integer :: b, v

      reach = least_reach*sqrt(system%area)
      if (.not. settings%dynamic) return
      do b = 1, size(reach)
         radius = 0.0_wp
         do v = system%first_vertex(b), system%first_vertex(b + 1) - 1
            radius = max(radius, norm2(system%vertex(:, v) - system%centroid(:, b)))
         end do
         reach(b) = max(reach(b), margin*march%dt*(norm2(system%velocity(1:2, b)) &
            & + radius*abs(system%velocity(3, b)) + march%free_acceleration*march%dt/2.0_wp))
      end do
      where (system%equation == 0) reach = 0.0_wp
   end function first_reach

   !> Let blocks reach as far as those that may strike them
   pure subroutine reach_like_neighbours(joint, equation, reach)
      type(joint_t), intent(in) :: joint(:)  !! The joints of the last step: (n_joint)
      integer, intent(in) :: equation(:)     !! Equation of each block, 0 for a fixed one: (n_block)
      real(wp), intent(inout) :: reach(:)    !! The reach: (n_block) [m]
      real(wp) :: own(size(reach))
      integer :: j

      own = reach
      do j = 1, size(joint)
         associate (pair => joint(j)%block)
            where (equation(pair) > 0) reach(pair) = max(reach(pair), maxval(own(pair)))
         end associate
      end do
   end subroutine reach_like_neighbours

   !> Reach in the step that follows an accepted one
   pure subroutine next_reach(system, step, march)
      type(block_system_t), intent(in) :: system
      type(step_context_t), intent(in) :: step
      type(march_t), intent(inout) :: march

      march%reach = max(least_reach*sqrt(system%area), &
         & margin*corner_motion(system, step%state%motion))
      where (system%equation == 0) march%reach = 0.0_wp
   end subroutine next_reach

   !> Check that no corner moves beyond the reach of its block, or so far that a block may pass by
   !> what it meets
   pure type(step_outcome_t) function check_margins(run) result(outcome)
      type(run_t), intent(in) :: run
      real(wp) :: way(size(run%system%area)), farthest
      logical :: may_meet(size(run%system%area))
      integer :: j

      outcome%dt = run%step%dt
      way = corner_motion(run%system, run%step%state%motion)
      may_meet = .false.
      do j = 1, size(run%contacts%joint)
         may_meet(run%contacts%joint(j)%block) = .true.
      end do
      farthest = maxval(way, mask=may_meet .and. run%system%equation > 0)
      associate (far => longest_motion(run%march))
         outcome%accepted = .not. farthest > 2.0_wp*far
         if (.not. outcome%accepted) then
            outcome%dt = run%step%dt*max(cut, aim*far/farthest)
            return
         end if
      end associate
      outcome%beyond_margin = any(way > run%march%reach)
      outcome%accepted = .not. outcome%beyond_margin
   end function check_margins

   !> Let blocks reach as far as a motion takes them
   pure subroutine widen_margins(system, motion, reach)
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: motion(:, :)  !! The motion: (n_dof, n_equation)
      real(wp), intent(inout) :: reach(:)   !! The reach: (n_block) [m]
      real(wp) :: way(size(reach))

      way = corner_motion(system, motion)
      where (way > reach) reach = margin*way
   end subroutine widen_margins

   !> Most that a corner of each block moves
   pure function corner_motion(system, motion) result(way)
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: motion(:, :)  !! Motion of the blocks: (n_dof, n_equation)
      !> The way of the corner that moves farthest: (n_block) [m]
      real(wp) :: way(size(system%area))
      real(wp) :: travel(2, size(system%vertex, 2))
      integer :: b

      travel = travel_by(system, motion)
      do b = 1, size(way)
         way(b) = maxval(norm2(travel(:, system%first_vertex(b):system%first_vertex(b + 1) - 1), &
            & dim=1))
      end do
   end function corner_motion

   !> Expected motion of the corners: by their speed and the loads, or as in the
   !> last step. A block that lies on others does not fall
   pure function travel_of(system, settings, march, contacts) result(travel)
      type(block_system_t), intent(in) :: system
      type(settings_t), intent(in) :: settings
      type(march_t), intent(in) :: march
      type(contacts_t), intent(in), optional :: contacts  !! The contacts of the last step
      real(wp) :: travel(2, size(system%vertex, 2))       !! The motion: (2, n_vertex) [m]
      real(wp) :: motion(6, maxval(system%equation))
      logical :: lies(size(system%area))
      integer :: b, e

      lies = .false.
      if (present(contacts)) lies = in_touch(contacts, size(lies))
      motion = 0.0_wp
      do b = 1, size(system%area)
         e = system%equation(b)
         if (e == 0) cycle
         if (settings%dynamic) then
            motion(:, e) = march%dt*system%velocity(:, b)
            if (lies(b)) cycle
            motion(1:2, e) = motion(1:2, e) + load_direction(settings)*system%unit_weight(b) &
               & *march%dt**2/(2.0_wp*system%density(b))
         else if (allocated(march%last_motion)) then
            motion(:size(march%last_motion, 1), e) = march%last_motion(:, e)
         end if
      end do
      travel = travel_by(system, motion)
   end function travel_of

   !> Blocks with a closed contact
   pure function in_touch(contacts, n_block) result(touch)
      type(contacts_t), intent(in) :: contacts
      integer, intent(in) :: n_block  !! Number of blocks
      logical :: touch(n_block)       !! True if each has one: (n_block)
      integer :: j

      touch = .false.
      if (.not. allocated(contacts%face)) return
      do j = 1, size(contacts%joint)
         associate (joint => contacts%joint(j))
            if (.not. all(contacts%face(j)%open(:joint%n_contact))) touch(joint%block) = .true.
         end associate
      end do
   end function in_touch

   !> Motion of corners by that of the blocks
   pure function travel_by(system, motion) result(travel)
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: motion(:, :)
      real(wp) :: travel(2, size(system%vertex, 2))  !! The motion of the corners: (2, n_vertex) [m]
      real(wp) :: t(2, 6), centroid(2)
      integer :: b, e, v

      travel = 0.0_wp
      do b = 1, size(system%area)
         e = system%equation(b)
         if (e == 0) cycle
         centroid = system%centroid(:, b) + system%motion(1:2, b)
         do v = system%first_vertex(b), system%first_vertex(b + 1) - 1
            t = displacement_matrix(system%moved(:, v), centroid)
            travel(:, v) = matmul(t(:, :size(motion, 1)), motion(:, e))
         end do
      end do
   end function travel_by
end module dda_step_reach
