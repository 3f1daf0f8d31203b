!> Coulomb friction without dilatancy: shear bounds from converged normal forces
!>
!> Equation (M4) of docs/method.md
module dda_friction
   use dda_contact_types, only : joint_springs_t
   use dda_friction_cone, only : cone_kind, cone_t
   use dda_kinds, only : wp
   use dda_open_close, only : iterate_open_close
   use dda_small_systems, only : least_squares
   use dda_step_state, only : equations_t, force_noise, step_state_t
   implicit none
   private

   public :: iterate_friction, negligible

   !> Last points of a fixed-point iteration
   type :: anderson_t
      integer :: kept = 0                   !! Number of stored points
      real(wp), allocatable :: point(:, :)  !! The points, the newest last: (n, kept or more)
      !> Changes of each of them by the iteration: (n, kept or more)
      real(wp), allocatable :: change(:, :)
   end type anderson_t

   !> Maximum number of corrections per step
   integer, parameter :: max_corrections = 200
   !> Corrections without progress after which a shorter step is cheaper
   integer, parameter :: max_stale = 25
   !> Number of corrections in the acceleration
   integer, parameter :: memory = 6
   !> Change of forces that is rounding over the largest, or over the sum of forces
   real(wp), parameter :: negligible = 1.0e-10_wp

contains

   !> Find the motion and the states of one step under Coulomb friction. In a dynamic run the bounds
   !> begin with the normal forces of the last step, and faces as they were: small changes cost
   !> little, and joints that slid go on sliding. Else, and where that fails, no joint may
   !> slide at first
   pure subroutine iterate_friction(equations, springs, max_changes, goes_on, state)
      !> Blocks assembled; matrix and factor are made again
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      !> Most changes of faces before Newton's method is used
      integer, intent(in) :: max_changes
      !> True if the step goes on from the forces of the last one
      logical, intent(in) :: goes_on
      !> Faces to begin with in, motion and joints out
      type(step_state_t), intent(inout) :: state
      type(step_state_t) :: begun
      real(wp) :: bound(size(springs%stiffness)), tolerance

      tolerance = 1.0e-11_wp*equations%force_scale
      if (goes_on .and. any(abs(state%force) > 0.0_wp)) then
         begun = state
         bound = max(0.0_wp, coulomb_bound(springs, state))
         call follow_bounds(equations, springs, max_changes, tolerance, bound, state)
         if (state%settled) return
         begun%passes = state%passes
         state = begun
      end if
      state%cone = cone_t(kind=cone_kind%no_slip)
      state%face%slip = 0
      state%unsettled_work = 0.0_wp
      call iterate_open_close(equations, springs, max_changes, state)
      if (.not. state%settled) return
      bound = coulomb_bound(springs, state)
      if (all(abs(state%force(3, :)) <= bound + tolerance &
         & .or. springs%cone%kind == cone_kind%no_slip)) return
      call follow_bounds(equations, springs, max_changes, tolerance, bound, state)
   end subroutine iterate_friction

   !> Bound all shear forces by friction times the normal forces of the previous pass, until
   !> these no longer change. Where blocks fall so far that smaller changes are rounding, the pass
   !> with the least change is the result
   pure subroutine follow_bounds(equations, springs, max_changes, tolerance, bound, state)
      type(equations_t), intent(inout) :: equations
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: max_changes
      real(wp), intent(in) :: tolerance    !! Tolerance of a bound [N/m]
      real(wp), intent(inout) :: bound(:)  !! Bounds: (n_joint) [N/m]
      type(step_state_t), intent(inout) :: state
      real(wp), dimension(size(bound)) :: change, next
      real(wp) :: largest, least
      type(step_state_t) :: best
      type(anderson_t) :: known
      integer :: correction, stale

      allocate (known%point(size(bound), memory + 1), known%change(size(bound), memory + 1))
      state%cone = cone_t()
      state%cone%kind = springs%cone%kind
      stale = 0
      least = huge(least)
      do correction = 1, max_corrections
         state%cone%limit = bound
         call iterate_open_close(equations, springs, max_changes, state)
         if (.not. state%settled) exit
         change = coulomb_bound(springs, state) - bound
         largest = maxval(abs(change))
         state%unsettled_work = sum(abs(change*state%increment(3, :)))
         if (largest <= tolerance) return
         stale = merge(0, stale + 1, largest < least)
         if (stale == 0) best = state
         least = min(least, largest)
         if (stale > merge(memory, max_stale, least <= force_noise(equations, springs, state))) exit
         call accelerate(known, bound, change, next)
         bound = max(0.0_wp, next)
      end do
      state%settled = .false.
      if (least > force_noise(equations, springs, state)) return
      best%passes = state%passes
      state = best
   end subroutine follow_bounds

   !> Anderson's acceleration of a fixed-point iteration: the mixture of the stored points whose
   !> mixed change is least, moved by that change
   pure subroutine accelerate(known, point, change, next)
      type(anderson_t), intent(inout) :: known
      real(wp), intent(in) :: point(:)   !! The last point: (n)
      real(wp), intent(in) :: change(:)  !! Its change by the iteration: (n)
      real(wp), intent(out) :: next(:)   !! The point to try next: (n)
      integer :: k

      if (known%kept == memory + 1) then
         known%point(:, :memory) = known%point(:, 2:)
         known%change(:, :memory) = known%change(:, 2:)
         known%kept = memory
      end if
      k = known%kept + 1
      known%kept = k
      known%point(:, k) = point
      known%change(:, k) = change
      next = point + change
      if (k == 1) return
      associate (steps => spread(point, 2, k - 1) - known%point(:, :k - 1), &
         & turns => spread(change, 2, k - 1) - known%change(:, :k - 1))
         next = next - matmul(steps + turns, least_squares(turns, change, negligible))
      end associate
   end subroutine accelerate

   !> Largest shear forces that the joints carry with the normal forces that they have; 0 where they
   !> cannot slide
   pure function coulomb_bound(springs, state) result(bound)
      type(joint_springs_t), intent(in) :: springs
      type(step_state_t), intent(in) :: state
      real(wp) :: bound(size(springs%stiffness))  !! The bounds: (n_joint) [N/m]

      bound = springs%cone%limit + springs%cone%friction &
         & *sum(state%force(1:2, :) + springs%shift(1:2, :), dim=1)
   end function coulomb_bound
end module dda_friction
