!> The forces of a chain: those of all joints follow from three unknowns by equilibrium alone
!>
!> Sought are the forces in balance with the loads that lie nearest to the friction cones,
!>
!>    sum over the joints of (share |y|**2 + |z - y|**2)/(2p) = least,   y = Proj_C(z)
!>
!> by Newton's method: an open-close loop in three unknowns. Where forces inside the cones exist,
!> these are the springs' own; where none exist, z - y is a mechanism (the lemma of Farkas). The
!> last passes do without the share, and tell the one from the other to the last digits.
module dda_chain_thrust
   use dda_chain, only : chain_t
   use dda_chain_balance, only : add_reaction, cone_of, holds, influence, joint_force, &
      & sum_loads
   use dda_friction_cone, only : apply_face, cone_t, joint_face_t, project
   use dda_kinds, only : wp
   use dda_three_unknowns, only : chain_energy_t, hold_upright, is_better, solve_3, try_between
   implicit none
   private

   public :: thrust_t, find_thrust, approach_cones

   !> The forces, and what they show
   type :: thrust_t
      !> Force and moment about the origin that the left springing bears with, or the plane of
      !> symmetry of half a chain: (3) [N/m, N/m, N]
      real(wp) :: reaction(3) = 0.0_wp
      !> Mean motion along the loads if no joint could open: the scale of elastic motion [m]
      real(wp) :: elastic_motion = 0.0_wp
      !> Second derivatives of the springs' energy if no joint could open
      real(wp) :: curvature(3, 3) = 0.0_wp
      !> Passes of Newton's method
      integer :: passes = 0
   end type thrust_t

   !> Share of the forces inside the cones; the smaller, the sharper is the answer
   real(wp), parameter :: share = 1.0e-8_wp
   !> Most passes
   integer, parameter :: max_passes = 40
   !> Share of the function below which it does not fall noticeably
   real(wp), parameter :: little = 1.0e-9_wp
   !> The same where the last digit counts
   real(wp), parameter :: exactly = 1.0e-20_wp
   !> Share of the springs' stiffness that keeps what nothing resists from moving far
   real(wp), parameter :: weak = 1.0e-12_wp
   !> Chains of more joints are first looked at with about as many
   integer, parameter :: coarse = 60
   !> Most places tried along a direction
   integer, parameter :: max_tries = 20

contains

   !> Find the forces
   pure subroutine find_thrust(chain, thrust, load)
      type(chain_t), intent(in) :: chain
      !> New but for the reaction: that of a chain much like this one, or 0
      type(thrust_t), intent(inout) :: thrust
      real(wp), intent(out) :: load(:, :)  !! Sums of the loads, force and moment: (3, n + 1)
      type(chain_energy_t) :: glued
      integer, allocatable :: watched(:)
      real(wp) :: stuck(3)
      integer :: j, m, stride

      m = size(chain%joint)
      stride = 1 + m/coarse
      allocate (watched, source=[(j, j=1, m - 1, stride), m])
      call sum_loads(chain, load)
      glued = glued_energy(chain, load, watched)
      thrust%curvature = glued%curvature
      call solve_3(glued%curvature, -glued%slope, stuck)
      do j = 1, size(watched)
         thrust%elastic_motion = thrust%elastic_motion + sum(joint_force(chain, load, stuck, &
            & watched(j))**2)/chain%joint(watched(j))%stiffness
      end do
      if (chain%whole_load > 0.0_wp) thrust%elastic_motion = thrust%elastic_motion &
         & *real(m, wp)/real(size(watched), wp)/chain%whole_load
      glued = chain_energy_t(share*glued%value, share*glued%slope, share*glued%curvature)
      if (.not. any(abs(thrust%reaction) > 0.0_wp)) thrust%reaction = stuck
      call descend(chain, load, glued, watched, thrust)
      if (stride == 1) return
      watched = around_weak(chain, load, thrust%reaction, stride, watched)
      call descend(chain, load, glued, watched, thrust)
   end subroutine find_thrust

   !> Joints around those that fail, or are nearer to it than their neighbours
   pure function around_weak(chain, load, reaction, stride, coarse) result(around)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: load(:, :)
      real(wp), intent(in) :: reaction(3)  !! The place
      integer, intent(in) :: stride        !! How far around
      integer, intent(in) :: coarse(:)     !! Joints that are looked at, rising
      integer, allocatable :: around(:)    !! The joints, rising
      logical :: is_near(size(chain%joint))
      real(wp) :: force(3), safety(0:size(coarse) + 1)
      integer :: i, j

      safety = huge(1.0_wp)
      do i = 1, size(coarse)
         force = joint_force(chain, load, reaction, coarse(i))
         safety(i) = min(force(1), force(2))
         associate (joint => chain%joint(coarse(i)))
            if (.not. joint%no_slip) safety(i) = min(safety(i), &
               & joint%friction*(force(1) + force(2)) - abs(force(3)))
         end associate
      end do
      is_near = .false.
      do i = 1, size(coarse)
         if (safety(i) > max(0.0_wp, min(safety(i - 1), safety(i + 1)))) cycle
         is_near(max(1, coarse(i) - stride):min(size(is_near), coarse(i) + stride)) = .true.
      end do
      around = pack([(j, j=1, size(is_near))], is_near)
   end function around_weak

   !> Newton's method on the energy of some joints
   pure subroutine descend(chain, load, glued, watched, thrust)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: load(:, :)
      type(chain_energy_t), intent(in) :: glued  !! Energy if no joint could fail, at zero
      integer, intent(in) :: watched(:)          !! The joints that count
      type(thrust_t), intent(inout) :: thrust
      type(chain_energy_t) :: here, there
      real(wp) :: bracket(2), direction(3), fall, steepness(2), way
      integer :: pass, try

      call find_energy(chain, load, glued, watched, thrust%reaction, here)
      do pass = 1, max_passes
         thrust%passes = thrust%passes + 1
         call solve_3(here%curvature, -here%slope, direction)
         fall = -dot_product(here%slope, direction)
         if (.not. fall > little*here%value) exit
         way = 1.0_wp
         bracket = [0.0_wp, 1.0_wp]
         steepness = [-fall, huge(fall)]
         do try = 1, max_tries
            call find_energy(chain, load, glued, watched, thrust%reaction + way*direction, there)
            if (is_better(here, there, direction, fall, way)) exit
            call try_between(there, direction, bracket, steepness, try, way)
         end do
         thrust%reaction = thrust%reaction + way*direction
         here = there
      end do
   end subroutine descend

   !> The function that is made least, at one place
   pure subroutine find_energy(chain, load, glued, watched, reaction, energy)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: load(:, :)
      type(chain_energy_t), intent(in) :: glued  !! Its part if no joint could fail, at zero
      integer, intent(in) :: watched(:)
      real(wp), intent(in) :: reaction(3)
      type(chain_energy_t), intent(out) :: energy
      real(wp) :: along, beyond(3), moment, normal, s(3), slope(3)
      integer :: i, j

      do i = 1, size(watched)
         j = watched(i)
         ! as in `joint_force` and `holds`, whose calls would take most of the time
         s = reaction + load(:, j)
         associate (joint => chain%joint(j))
            normal = joint%tangent(2)*s(1) - joint%tangent(1)*s(2)
            along = joint%tangent(1)*s(1) + joint%tangent(2)*s(2)
            moment = (s(3) - joint%middle(1)*s(2) + joint%middle(2)*s(1))/joint%half
            if (normal >= abs(moment) .and. (abs(along) <= joint%friction*normal &
               & .or. joint%no_slip)) cycle
         end associate
         call add_failing(chain, [(normal + moment)/2.0_wp, (normal - moment)/2.0_wp, along], j, &
            & energy, beyond)
      end do
      slope = matmul(glued%curvature, reaction)
      energy%value = energy%value + glued%value + dot_product(reaction, glued%slope + slope/2.0_wp)
      energy%slope = energy%slope + glued%slope + slope
      energy%curvature = energy%curvature + glued%curvature
      if (chain%halved) call hold_upright(energy%slope, energy%curvature)
   end subroutine find_energy

   !> Energy of the springs if no joint could fail, at zero
   pure type(chain_energy_t) function glued_energy(chain, load, watched) result(energy)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: load(:, :)
      integer, intent(in) :: watched(:)
      real(wp) :: n(3), t(3), m(3), force(3), give
      integer :: c, i, j

      n = 0.0_wp
      t = 0.0_wp
      do i = 1, size(watched)
         j = watched(i)
         give = 1.0_wp/chain%joint(j)%stiffness
         t(1:2) = chain%joint(j)%tangent
         n(1) = t(2)
         n(2) = -t(1)
         m(3) = 1.0_wp/chain%joint(j)%half
         m(1) = chain%joint(j)%middle(2)*m(3)
         m(2) = -chain%joint(j)%middle(1)*m(3)
         ! N1**2 + N2**2 = (N**2 + (M/half)**2)/2
         force(1) = (n(1)*load(1, j) + n(2)*load(2, j))*(give/2.0_wp)
         force(2) = (m(1)*load(1, j) + m(2)*load(2, j) + m(3)*load(3, j))*(give/2.0_wp)
         force(3) = (t(1)*load(1, j) + t(2)*load(2, j))*give
         energy%value = energy%value + (force(1)**2 + force(2)**2 + force(3)**2/2.0_wp)/give
         energy%slope = energy%slope + n*force(1) + m*force(2) + t*force(3)
         do c = 1, 3
            energy%curvature(:, c) = energy%curvature(:, c) &
               & + n*(n(c)*(give/2.0_wp)) + m*(m(c)*(give/2.0_wp)) + t*(t(c)*give)
         end do
      end do
      if (chain%halved) call hold_upright(energy%slope, energy%curvature)
   end function glued_energy

   !> Half the squared distance of a force from its cone, over the stiffness
   pure subroutine add_failing(chain, force, j, energy, beyond)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: force(3)  !! N1, N2, T [N/m]
      integer, intent(in) :: j          !! Number of the joint
      type(chain_energy_t), intent(inout) :: energy
      !> The part of the force that the cone does not let pass [N/m]
      real(wp), intent(out) :: beyond(3)
      type(cone_t) :: cone
      type(joint_face_t) :: face
      real(wp) :: admissible(3), constant(3), free(3, 3), g(3, 3), give, tangent(3, 3)
      integer :: c, i

      cone = cone_of(chain, j)
      call project(cone, force, admissible, face)
      g = influence(chain, j)
      give = 1.0_wp/chain%joint(j)%stiffness
      beyond = force - admissible
      energy%value = energy%value + dot_product(beyond, beyond)*(give/2.0_wp)
      energy%slope = energy%slope + matmul(beyond, g)*give
      if (face%slip == 0) then
         do i = 1, 2
            if (.not. face%open(i)) cycle
            do c = 1, 3
               energy%curvature(:, c) = energy%curvature(:, c) + g(i, :)*(g(i, c)*give)
            end do
         end do
      else
         call apply_face(cone, face, tangent, constant)
         free = g - matmul(tangent, g)
         energy%curvature = energy%curvature + matmul(transpose(g), free)*give
      end if
   end subroutine add_failing

   !> Bring forces in balance as near to the cones as they go. What then lies beyond these is
   !> rounding where admissible forces exist, and else a mechanism: openings that close the row
   pure subroutine approach_cones(chain, thrust, noise, force, beyond, passes)
      type(chain_t), intent(in) :: chain
      type(thrust_t), intent(in) :: thrust    !! Where the forces come from
      real(wp), intent(in) :: noise           !! What counts as rounding [N/m]
      real(wp), intent(inout) :: force(:, :)  !! N1, N2, T of each joint: (3, n + 1) [N/m]
      !> The part of each that its cone does not let pass: (3, n + 1) [N/m]
      real(wp), intent(out) :: beyond(:, :)
      integer, intent(out) :: passes  !! Passes of Newton's method
      type(chain_energy_t) :: here, there
      real(wp) :: bracket(2), direction(3), fall, steepness(2), way
      real(wp) :: rest(3, size(force, 2)), tried(3, size(force, 2))
      integer :: try
      logical :: is_last

      call find_beyond(chain, force, beyond, here)
      do passes = 0, max_passes
         if (.not. maxval(abs(beyond)) > noise) exit
         call solve_3(here%curvature + weak*thrust%curvature, -here%slope, direction)
         fall = -dot_product(here%slope, direction)
         if (.not. fall > exactly*here%value) exit
         way = 1.0_wp
         bracket = [0.0_wp, 1.0_wp]
         steepness = [-fall, huge(fall)]
         do try = 1, max_tries
            call add_reaction(chain, way*direction, force, tried)
            call find_beyond(chain, tried, rest, there)
            if (is_better(here, there, direction, fall, way)) exit
            call try_between(there, direction, bracket, steepness, try, way)
         end do
         is_last = .not. there%value < here%value
         force = tried
         beyond = rest
         here = there
         ! a step whose fall rounding hides is still nearer
         if (is_last) exit
      end do
   end subroutine approach_cones

   !> What of the forces lies beyond the cones, and half its square over the stiffness
   pure subroutine find_beyond(chain, force, beyond, energy)
      type(chain_t), intent(in) :: chain
      real(wp), intent(in) :: force(:, :)  !! Forces: (3, n + 1) [N/m]
      !> The part that the cones do not let pass: (3, n + 1) [N/m]
      real(wp), intent(out) :: beyond(:, :)
      type(chain_energy_t), intent(out) :: energy
      integer :: j

      beyond = 0.0_wp
      do j = 1, size(force, 2)
         if (.not. holds(chain, force(:, j), j)) &
            & call add_failing(chain, force(:, j), j, energy, beyond(:, j))
      end do
      if (chain%halved) call hold_upright(energy%slope, energy%curvature)
   end subroutine find_beyond
end module dda_chain_thrust
