!> Where to begin with the forces and faces of a chain: the forces of all joints follow from three
!> unknowns by equilibrium alone
!>
!> Sought are the forces in balance with the loads that lie nearest to the friction cones,
!>
!>    sum over the joints of (share |y|**2 + |z - y|**2)/(2p) = least,   y = Proj_C(z)
!>
!> by Newton's method. Where forces inside the cones exist, these are nearly the springs' own, and
!> z - y is what opens; where none exist, z - y is a mechanism (Farkas). Only joints that fail more
!> than their neighbours open in the end: a structure opens joint by joint. Newton's method decides
!> nothing: it says where the steps begin.
module dda_chain_thrust
   use dda_chain, only : chain_t
   use dda_chain_balance, only : carry_forces, hold_upright, holds, influence, joint_force, &
      & solve_3, sum_loads
   use dda_chain_stiffness, only : cone_of
   use dda_friction_cone, only : apply_face, cone_t, joint_face_t, project
   use dda_kinds, only : wp
   implicit none
   private

   public :: thrust_t, find_thrust, thrust_faces

   !> The forces, and what they show
   type :: thrust_t
      !> Force and moment about the origin that the left springing bears with, or the plane of
      !> symmetry of half a chain: (3) [N/m, N/m, N]
      real(wp) :: reaction(3) = 0.0_wp
      !> Mean motion along the loads if no joint could open: the scale of elastic motion [m]
      real(wp) :: elastic_motion = 0.0_wp
      !> Passes of Newton's method
      integer :: passes = 0
   end type thrust_t

   !> A function of the three unknowns: its value with its first and second derivatives
   type :: energy_t
      !> Value
      real(wp) :: value = 0.0_wp
      !> First derivatives
      real(wp) :: slope(3) = 0.0_wp
      !> Second derivatives
      real(wp) :: curvature(3, 3) = 0.0_wp
   end type energy_t

   !> Share of the forces inside the cones; the smaller, the sharper is the answer
   real(wp), parameter :: share = 1.0e-8_wp
   !> Most passes
   integer, parameter :: max_passes = 40
   !> Share of the function below which it does not fall noticeably
   real(wp), parameter :: little = 1.0e-9_wp
   !> Share of the fall that a straight line promises which counts as a fall
   real(wp), parameter :: barely = 1.0e-4_wp
   !> Relative error that rounding makes of the function
   real(wp), parameter :: rounding = 1.0e-11_wp
   !> Chains of more joints are first looked at with about as many
   integer, parameter :: coarse = 60
   !> Most places tried along a direction
   integer, parameter :: max_tries = 10

contains

   !> Find the forces
   pure subroutine find_thrust(chain, thrust, load)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The forces
      type(thrust_t), intent(out) :: thrust
      !> Sums of the loads, force and moment: (3, n + 1)
      real(wp), intent(out) :: load(:, :)
      type(energy_t) :: glued
      integer, allocatable :: watched(:)
      integer :: j, m, stride

      m = size(chain%half)
      stride = 1 + m/coarse
      allocate (watched, source=[(j, j=1, m - 1, stride), m])
      call sum_loads(chain, load)
      glued = glued_energy(chain, load, watched)
      call solve_3(glued%curvature, -glued%slope, thrust%reaction)
      do j = 1, size(watched)
         thrust%elastic_motion = thrust%elastic_motion + sum(joint_force(chain, load, &
            & thrust%reaction, watched(j))**2)/chain%stiffness(watched(j))
      end do
      thrust%elastic_motion = thrust%elastic_motion*real(m, wp)/real(size(watched), wp) &
         & /chain%whole_load
      glued = energy_t(share*glued%value, share*glued%slope, share*glued%curvature)
      call descend(chain, load, glued, watched, thrust)
      if (stride == 1) return
      watched = around_weak(chain, load, thrust%reaction, stride, watched)
      call descend(chain, load, glued, watched, thrust)
   end subroutine find_thrust

   !> Joints around those that fail, or are nearer to it than their neighbours
   pure function around_weak(chain, load, reaction, stride, coarse) result(around)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Sums of the loads: (3, n + 1)
      real(wp), intent(in) :: load(:, :)
      !> The place
      real(wp), intent(in) :: reaction(3)
      !> How far around
      integer, intent(in) :: stride
      !> Joints that are looked at, rising
      integer, intent(in) :: coarse(:)
      !> The joints, rising
      integer, allocatable :: around(:)
      logical :: is_near(size(chain%half))
      real(wp) :: force(3), safety(0:size(coarse) + 1)
      integer :: i, j

      safety = huge(1.0_wp)
      do i = 1, size(coarse)
         force = joint_force(chain, load, reaction, coarse(i))
         safety(i) = min(force(1), force(2), chain%limit(coarse(i)) - abs(force(3)) &
            & + chain%friction(coarse(i))*(force(1) + force(2)))
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
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Sums of the loads: (3, n + 1)
      real(wp), intent(in) :: load(:, :)
      !> Energy if no joint could fail, at zero
      type(energy_t), intent(in) :: glued
      !> The joints that count
      integer, intent(in) :: watched(:)
      !> The forces
      type(thrust_t), intent(inout) :: thrust
      type(energy_t) :: here, there
      real(wp) :: direction(3), way, fall
      integer :: pass, try

      call find_energy(chain, load, glued, watched, thrust%reaction, here)
      do pass = 1, max_passes
         thrust%passes = thrust%passes + 1
         call solve_3(here%curvature, -here%slope, direction)
         fall = -dot_product(here%slope, direction)
         if (.not. fall > little*here%value) exit
         way = 1.0_wp
         do try = 1, max_tries
            call find_energy(chain, load, glued, watched, thrust%reaction + way*direction, there)
            if (there%value <= here%value*(1.0_wp + rounding) - barely*way*fall) exit
            way = shorter(way, dot_product(there%slope, direction), &
               & dot_product(direction, matmul(there%curvature, direction)))
         end do
         thrust%reaction = thrust%reaction + way*direction
         here = there
      end do
   end subroutine descend

   !> Where along a direction to try next: Newton's method on the slope, which rises
   pure real(wp) function shorter(way, slope, curvature)
      !> How far was too far
      real(wp), intent(in) :: way
      !> Slope there
      real(wp), intent(in) :: slope
      !> Its change
      real(wp), intent(in) :: curvature

      shorter = way/2.0_wp
      if (slope > 0.0_wp .and. slope < way*curvature) shorter = way - slope/curvature
   end function shorter

   !> The function that is made least, at one place
   pure subroutine find_energy(chain, load, glued, watched, reaction, energy)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Sums of the loads: (3, n + 1)
      real(wp), intent(in) :: load(:, :)
      !> Its part if no joint could fail, at zero
      type(energy_t), intent(in) :: glued
      !> The joints that count
      integer, intent(in) :: watched(:)
      !> The place
      real(wp), intent(in) :: reaction(3)
      !> The function with its derivatives
      type(energy_t), intent(out) :: energy
      real(wp) :: slope(3)

      call add_failing(chain, load, watched, reaction, energy)
      slope = matmul(glued%curvature, reaction)
      energy%value = energy%value + glued%value &
         & + dot_product(reaction, glued%slope + slope/2.0_wp)
      energy%slope = energy%slope + glued%slope + slope
      energy%curvature = energy%curvature + glued%curvature
      if (chain%halved) call hold_upright(energy%slope, energy%curvature)
   end subroutine find_energy

   !> Energy of the springs if no joint could fail, at zero
   pure function glued_energy(chain, load, watched) result(energy)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Sums of the loads: (3, n + 1)
      real(wp), intent(in) :: load(:, :)
      !> The joints that count
      integer, intent(in) :: watched(:)
      !> The energy
      type(energy_t) :: energy
      real(wp) :: n(3), t(3), m(3), force(3), give
      integer :: c, i, j

      n = 0.0_wp
      t = 0.0_wp
      do i = 1, size(watched)
         j = watched(i)
         give = 1.0_wp/chain%stiffness(j)
         t(1:2) = chain%tangent(:, j)
         n(1) = t(2)
         n(2) = -t(1)
         m(3) = 1.0_wp/chain%half(j)
         m(1) = chain%middle(2, j)*m(3)
         m(2) = -chain%middle(1, j)*m(3)
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

   !> Half the squared distance of the forces from the cones, over the stiffness
   pure subroutine add_failing(chain, load, watched, reaction, energy)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Sums of the loads: (3, n + 1)
      real(wp), intent(in) :: load(:, :)
      !> The joints that count
      integer, intent(in) :: watched(:)
      !> The place
      real(wp), intent(in) :: reaction(3)
      !> What it is added to
      type(energy_t), intent(inout) :: energy
      type(cone_t) :: cone
      type(joint_face_t) :: face
      real(wp) :: force(3), admissible(3), tangent(3, 3), constant(3), g(3, 3), rest(3)
      integer :: i, j

      do i = 1, size(watched)
         j = watched(i)
         force = joint_force(chain, load, reaction, j)
         if (holds(chain, force, j)) cycle
         cone = cone_of(chain, j)
         call project(cone, force, admissible, face)
         call apply_face(cone, face, tangent, constant)
         g = influence(chain, j)
         rest = force - admissible
         energy%value = energy%value + dot_product(rest, rest)/(2.0_wp*chain%stiffness(j))
         energy%slope = energy%slope + matmul(rest, g)/chain%stiffness(j)
         energy%curvature = energy%curvature &
            & + matmul(transpose(g), g - matmul(tangent, g))/chain%stiffness(j)
      end do
   end subroutine add_failing

   !> Forces of all joints, and faces of those that fail more than their neighbours do
   pure subroutine thrust_faces(chain, load, thrust, face, force)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> Sums of the loads: (3, n + 1)
      real(wp), intent(in) :: load(:, :)
      !> The forces
      type(thrust_t), intent(in) :: thrust
      !> The faces: (n + 1)
      type(joint_face_t), intent(out) :: face(:)
      !> The forces N1, N2, T: (3, n + 1) [N/m]
      real(wp), intent(out) :: force(:, :)
      type(joint_face_t) :: wanted(size(face))
      real(wp) :: gap(0:size(face) + 1), admissible(3)
      integer :: j

      gap = 0.0_wp
      call carry_forces(chain, load, thrust%reaction, force)
      do j = 1, size(face)
         if (holds(chain, force(:, j), j)) cycle
         call project(cone_of(chain, j), force(:, j), admissible, wanted(j))
         gap(j) = norm2(force(:, j) - admissible)
      end do
      do j = 1, size(face)
         if (gap(j) > 0.0_wp .and. gap(j) >= (1.0_wp - 1.0e-6_wp)*max(gap(j - 1), gap(j + 1))) &
            & face(j) = wanted(j)
      end do
      if (chain%halved) face(size(face))%slip = 1
   end subroutine thrust_faces
end module dda_chain_thrust
