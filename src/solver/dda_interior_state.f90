!> Input of an interior-point method, and its state from iteration to iteration
module dda_interior_state
   use dda_joint_graph, only : joint_graph_t, unit_of_length
   use dda_joint_rays, only : bound_rays
   use dda_joint_strips, only : joint_strip_t, list_strips
   use dda_kinds, only : wp
   use, intrinsic :: iso_fortran_env, only : int8
   implicit none
   private

   public :: no_limit, load_path_t, interior_point_t, interior_goal_t, interior_state
   public :: set_path, size_of_load

   !> Factor without limit
   real(wp), parameter :: no_limit = 1.0e200_wp

   !> Least dead load relative to the live load
   real(wp), parameter :: nothing = 1.0e-14_wp

   !> End of the iteration
   type :: interior_state_enum
      integer :: running = 0    !! Not yet
      integer :: optimal = 1    !! Forces and velocities agree to the tolerance
      integer :: reached = 2    !! Forces that balance at the target
      integer :: blocked = 3    !! Velocities that no forces balance at the target
      integer :: stalled = 4    !! No more progress
      integer :: unbounded = 5  !! The factor grows without bound
   end type interior_state_enum

   !> Names of these ends
   type(interior_state_enum), parameter :: interior_state = interior_state_enum()

   !> Loads dead + factor*live in the units of the rays, the sizes of live sum up to one; or a
   !> dead load alone, and masses that it moves; and the signs that forces along the rays may have
   type :: load_path_t
      !> One for rays whose force may not be negative, zero for free and for empty ones:
      !> (n_side, n_joint)
      integer(int8), allocatable :: bounded(:, :)
      !> One for rays of any sign: (n_side, n_joint)
      integer(int8), allocatable :: free(:, :)
      !> True if there are rays of other kinds than bounded ones
      logical :: has_others = .false.
      !> Number of bounded rays, or one
      real(wp) :: n_bounded = 1.0_wp
      !> Unit of length: [m]
      real(wp) :: length = 1.0_wp
      !> Loads at factor zero: (3, 0:n_block)
      real(wp), allocatable :: dead(:, :)
      !> Load added per unit of the factor: (3, 0:n_block)
      real(wp), allocatable :: live(:, :)
      !> Masses: (3, 0:n_block)
      real(wp), allocatable :: mass(:, :)
      !> True if there are any
      logical :: moves = .false.
      !> Joints that crush: (n)
      type(joint_strip_t), allocatable :: strip(:)
      !> Closing of a ray by a unit of force: forces that hold one another, of any size, are small
      real(wp) :: compliance = 0.0_wp
      !> Factor of this path that is one for the caller
      real(wp) :: size = 1.0_wp
      !> Factors whose difference is smaller are taken for equal
      real(wp) :: negligible = 0.0_wp
      !> Largest entries of both, by which an imbalance is judged
      real(wp) :: largest_dead = 0.0_wp, largest_live = 0.0_wp
   end type load_path_t

   !> Goal of the iteration
   type :: interior_goal_t
      !> Relative gap of both problems
      real(wp) :: tolerance = 1.0e-9_wp
      !> Factor at which the iteration ends if it is reached or proven out of reach
      real(wp) :: target = no_limit
      !> Factorisations within which the largest factor is sought below the target; later, a proof
      !> ends the iteration
      integer :: to_limit = 0
      !> A factor for which the live load is so many times as large as the dead load, or one, is
      !> beyond bounds
      real(wp) :: ceiling = 1.0e9_wp
      !> Turns at most
      integer :: max_turn = 100
   end type interior_goal_t

   !> Forces, velocities and the factor
   type :: interior_point_t
      !> Force along each ray: (n_side, n_joint)
      real(wp), allocatable :: x(:, :)
      !> Rate of opening along each ray: (n_side, n_joint)
      real(wp), allocatable :: s(:, :)
      !> Velocities, or accelerations of masses: (3, 0:n_block)
      real(wp), allocatable :: v(:, :)
      !> Factor that the forces carry
      real(wp) :: factor = 0.0_wp
      !> Factor that the velocities do not let pass
      real(wp) :: upper = no_limit
      !> Increase of that factor if the violation is not where forces are small
      real(wp) :: margin = 0.0_wp
      !> Relative gap, imbalance, and violation of the flow rule
      real(wp) :: gap = huge(1.0_wp), imbalance = huge(1.0_wp), violation = huge(1.0_wp)
      !> End of the iteration, one of interior_state
      integer :: state = 0
      !> Turns
      integer :: n_turn = 0
   end type interior_point_t

contains

   !> Loads along a path
   pure subroutine set_path(graph, dead, live, path)
      type(joint_graph_t), intent(in) :: graph
      !> Loads at factor zero, in the units of the rays: (3, 0:n_block)
      real(wp), intent(in) :: dead(:, 0:)
      !> Load added by a factor of one: (3, 0:n_block)
      real(wp), intent(in) :: live(:, 0:)
      type(load_path_t), intent(out) :: path

      call bound_rays(graph, path%bounded, path%free)
      call list_strips(graph, path%strip)
      path%has_others = any(path%bounded == 0_int8)
      path%n_bounded = real(max(1, count(path%bounded > 0)), wp)
      path%length = unit_of_length(graph)
      allocate (path%dead(3, 0:ubound(dead, 2)), path%live(3, 0:ubound(dead, 2)))
      allocate (path%mass(3, 0:ubound(dead, 2)), source=0.0_wp)
      path%size = size_of_load(live)
      if (.not. path%size > 0.0_wp) path%size = 1.0_wp
      path%dead = dead
      path%live = live/path%size
      path%negligible = nothing*size_of_load(dead)
      path%largest_dead = maxval(abs(path%dead))
      path%largest_live = maxval(abs(path%live))
   end subroutine set_path

   !> Sum of all forces and moments, the same whichever way the axes point
   pure real(wp) function size_of_load(load) result(size)
      real(wp), intent(in) :: load(:, 0:)  !! The load: (3, 0:n_block)

      size = sum(hypot(load(1, :), load(2, :))) + sum(abs(load(3, :)))
   end function size_of_load
end module dda_interior_state
