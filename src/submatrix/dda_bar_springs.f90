!> Bars as springs between two points: stiffness s E E', coupling -s E G', tension on both ends
!>
!> E and G are the rows of the bar's elongation for the unknowns of its two blocks. A bar with a
!> force between zero and its strength is elastic, slack or yielding. In dynamic runs its mean force
!> over a step acts, which conserves the energy of an elastic bar.
module dda_bar_springs
   use dda_bar, only : bar_condition
   use dda_bar_place, only : place_bar
   use dda_block_system, only : block_system_t
   use dda_boundary, only : boundary_t
   use dda_kinds, only : wp
   use dda_settings, only : settings_t
   implicit none
   private

   public :: bar_springs_t, acting, bar_motion, add_bars, bar_energies, couple_bars, elongation_by
   public :: follow_bars, judge_bars, keep_bars, longest_give, new_bar_springs

   !> Springs of all bars in a step; the first of two rows is along a bar, the second across it
   type :: bar_springs_t
      !> Equations of the blocks at both ends, 0 for fixed ones: (2, n)
      integer, allocatable :: equation(:, :)
      !> Entry of the matrix that couples them, 0 if one is fixed: (n)
      integer, allocatable :: entry(:)
      !> Elongation and rotation by the unknowns of both blocks: (n_dof, 2, 2, n)
      real(wp), allocatable :: row(:, :, :, :)
      real(wp), allocatable :: stiffness(:, :)  !! Stiffness along and across: (2, n) [N/m]
      !> Force at the beginning of the step without bounds: (n) [N]
      real(wp), allocatable :: trial(:)
      real(wp), allocatable :: force(:)     !! Force at the beginning: (n) [N]
      real(wp), allocatable :: bound(:, :)  !! Smallest and largest force: (2, n) [N]
      integer, allocatable :: condition(:)  !! One of bar_condition: (n)
      !> Weight of the force at the end of the step: 1/2 in dynamic runs, else 1
      real(wp) :: share = 1.0_wp
   end type bar_springs_t

contains

   !> Springs of all bars, without positions
   pure type(bar_springs_t) function new_bar_springs(boundary, equation, n_dof) result(bars)
      type(boundary_t), intent(in) :: boundary
      integer, intent(in) :: equation(:)  !! Equation of each block, 0 for a fixed one: (n_block)
      integer, intent(in) :: n_dof        !! Unknowns of a block
      integer :: i, n, side

      n = 0
      if (allocated(boundary%bar)) n = size(boundary%bar)
      allocate (bars%equation(2, n), source=0)
      allocate (bars%entry(n), bars%condition(n), source=0)
      allocate (bars%row(n_dof, 2, 2, n), bars%stiffness(2, n), bars%bound(2, n), source=0.0_wp)
      allocate (bars%trial(n), bars%force(n), source=0.0_wp)
      do i = 1, n
         do side = 1, 2
            associate (b => boundary%bar(i)%block(side))
               if (b > 0) bars%equation(side, i) = equation(b)
            end associate
         end do
      end do
   end function new_bar_springs

   !> Place the bars between the present blocks
   pure subroutine follow_bars(system, settings, bars)
      type(block_system_t), intent(in) :: system
      type(settings_t), intent(in) :: settings
      type(bar_springs_t), intent(inout) :: bars
      real(wp) :: elongation
      integer :: i

      bars%share = merge(0.5_wp, 1.0_wp, settings%dynamic)
      do i = 1, size(bars%trial)
         associate (bar => settings%boundary%bar(i), state => system%bar(i))
            call place_bar(system, settings%current, bar, bars%row(:, :, :, i), elongation, &
               & bars%stiffness(2, i))
            bars%stiffness(1, i) = bar%stiffness
            bars%bound(:, i) = [0.0_wp, bar%strength]
            if (settings%dynamic .and. bar%pushes) bars%bound(1, i) = -huge(1.0_wp)
            if (state%condition == bar_condition%broken) bars%bound(:, i) = 0.0_wp
            bars%trial(i) = bar%prestress + bar%stiffness*(elongation - state%plastic)
            bars%force(i) = min(max(bars%trial(i), bars%bound(1, i)), bars%bound(2, i))
            bars%stiffness(2, i) = max(0.0_wp, bars%force(i))*bars%stiffness(2, i)
            bars%condition(i) = condition_of(bars%trial(i), bars%bound(:, i))
         end associate
      end do
   end subroutine follow_bars

   !> Condition of a bar at a trial force
   pure integer function condition_of(trial, bound)
      real(wp), intent(in) :: trial     !! Force without bounds [N]
      real(wp), intent(in) :: bound(2)  !! Smallest and largest force: (2) [N]

      condition_of = bar_condition%elastic
      if (trial < bound(1)) condition_of = bar_condition%slack
      if (trial > bound(2)) condition_of = bar_condition%yielding
      if (.not. bound(2) > bound(1)) condition_of = bar_condition%slack
   end function condition_of

   !> Stiffness of a bar in this step, along and across
   pure function acting(bars, i) result(stiffness)
      type(bar_springs_t), intent(in) :: bars
      integer, intent(in) :: i  !! Number of the bar
      real(wp) :: stiffness(2)  !! Stiffness along and across: (2) [N/m]

      stiffness = bars%share*bars%stiffness(:, i)
      if (bars%condition(i) /= bar_condition%elastic) stiffness(1) = 0.0_wp
   end function acting

   !> Force of a bar in this step without motion
   pure real(wp) function acting_force(bars, i) result(force)
      type(bar_springs_t), intent(in) :: bars
      integer, intent(in) :: i

      select case (bars%condition(i))
      case (bar_condition%elastic)
         force = bars%trial(i)
      case (bar_condition%slack)
         force = max(bars%bound(1, i), min(0.0_wp, bars%bound(2, i)))
      case default
         force = bars%bound(2, i)
      end select
      force = bars%share*force + (1.0_wp - bars%share)*bars%force(i)
   end function acting_force

   !> Add the bars to the matrix and load of the blocks, or subtract them
   pure subroutine add_bars(bars, sign, matrix, load)
      type(bar_springs_t), intent(in) :: bars
      real(wp), intent(in) :: sign  !! 1 to add, -1 to subtract
      !> Stiffness of the blocks: (n_dof, n_dof, n_equation)
      real(wp), intent(inout) :: matrix(:, :, :)
      real(wp), intent(inout) :: load(:, :)  !! Loads: (n_dof, n_equation)
      real(wp) :: stiffness(2)
      integer :: c, i, k, side

      do i = 1, size(bars%trial)
         stiffness = sign*acting(bars, i)
         do side = 1, 2
            associate (e => bars%equation(side, i), row => bars%row(:, :, side, i))
               if (e == 0) cycle
               do k = 1, 2
                  do c = 1, size(row, 1)
                     matrix(:, c, e) = matrix(:, c, e) + stiffness(k)*row(c, k)*row(:, k)
                  end do
               end do
               load(:, e) = load(:, e) - sign*acting_force(bars, i)*row(:, 1)
            end associate
         end do
      end do
   end subroutine add_bars

   !> Coupling stiffness between the blocks of the bars
   pure subroutine couple_bars(bars, pair, coupling)
      type(bar_springs_t), intent(in) :: bars
      !> Blocks of each entry of the matrix, in the order of its rows and columns: (2, n_entry)
      integer, intent(in) :: pair(:, :)
      real(wp), intent(inout) :: coupling(:, :, :)  !! Couplings: (n_dof, n_dof, n_entry)
      real(wp) :: stiffness(2)
      integer :: c, e, first, i, k

      do i = 1, size(bars%trial)
         e = bars%entry(i)
         if (e == 0) cycle
         coupling(:, :, e) = 0.0_wp
         first = merge(1, 2, pair(1, e) == bars%equation(1, i))
         stiffness = acting(bars, i)
         do k = 1, 2
            do c = 1, size(coupling, 2)
               coupling(:, c, e) = coupling(:, c, e) + stiffness(k) &
                  & *bars%row(c, k, 3 - first, i)*bars%row(:, k, first, i)
            end do
         end do
      end do
   end subroutine couple_bars

   !> Product of the couplings of the bars and a motion
   pure function bar_motion(bars, motion) result(force)
      type(bar_springs_t), intent(in) :: bars
      real(wp), intent(in) :: motion(:, :)  !! Motion of the blocks: (n_dof, n_equation)
      !> Coupling times motion: (n_dof, n_equation)
      real(wp) :: force(size(motion, 1), size(motion, 2))
      real(wp) :: stiffness(2)
      integer :: i, k, side

      force = 0.0_wp
      do i = 1, size(bars%trial)
         if (bars%entry(i) == 0) cycle
         stiffness = acting(bars, i)
         do side = 1, 2
            associate (e => bars%equation(side, i), other => bars%equation(3 - side, i))
               do k = 1, 2
                  force(:, e) = force(:, e) + stiffness(k)*bars%row(:, k, side, i) &
                     & *dot_product(bars%row(:, k, 3 - side, i), motion(:, other))
               end do
            end associate
         end do
      end do
   end function bar_motion

   !> Elongation of a bar by a motion
   pure real(wp) function elongation_by(bars, motion, i)
      type(bar_springs_t), intent(in) :: bars
      real(wp), intent(in) :: motion(:, :)
      integer, intent(in) :: i  !! Number of the bar
      integer :: side

      elongation_by = 0.0_wp
      do side = 1, 2
         if (bars%equation(side, i) > 0) elongation_by = elongation_by &
            & + dot_product(bars%row(:, 1, side, i), motion(:, bars%equation(side, i)))
      end do
   end function elongation_by

   !> Update the conditions of bars that contradict a motion
   pure subroutine judge_bars(bars, motion, one_by_one, agreed)
      type(bar_springs_t), intent(inout) :: bars
      real(wp), intent(in) :: motion(:, :)
      logical, intent(in) :: one_by_one  !! True to change only the bar with the largest difference
      logical, intent(out) :: agreed     !! True if no condition contradicts the motion
      real(wp) :: off(size(bars%trial)), trial
      integer :: i, wanted(size(bars%trial))

      off = 0.0_wp
      do i = 1, size(bars%trial)
         trial = bars%trial(i) + bars%stiffness(1, i)*elongation_by(bars, motion, i)
         wanted(i) = condition_of(trial, bars%bound(:, i))
         if (wanted(i) /= bars%condition(i)) &
            & off(i) = max(tiny(trial), min(abs(trial - bars%bound(1, i)), &
            & abs(trial - bars%bound(2, i))))
         ! ignore differences by round-off
         if (off(i) <= 1.0e-13_wp*(abs(bars%trial(i)) + abs(trial))) off(i) = 0.0_wp
      end do
      agreed = .not. any(off > 0.0_wp)
      if (agreed) return
      where (off > 0.0_wp .and. (.not. one_by_one .or. off >= maxval(off))) bars%condition = wanted
   end subroutine judge_bars

   !> Update the states of the bars after an accepted step
   pure subroutine keep_bars(bars, settings, motion, system)
      type(bar_springs_t), intent(in) :: bars
      type(settings_t), intent(in) :: settings
      real(wp), intent(in) :: motion(:, :)  !! Motion of the step: (n_dof, n_equation)
      type(block_system_t), intent(inout) :: system
      real(wp) :: trial
      integer :: i

      do i = 1, size(bars%trial)
         associate (bar => settings%boundary%bar(i), state => system%bar(i))
            if (state%condition == bar_condition%broken) cycle
            trial = bars%trial(i) + bars%stiffness(1, i)*elongation_by(bars, motion, i)
            state%force = min(max(trial, bars%bound(1, i)), bars%bound(2, i))
            state%condition = bars%condition(i)
            if (state%condition /= bar_condition%yielding) cycle
            state%plastic = state%plastic + max(0.0_wp, trial - bar%strength)/bar%stiffness
            if (.not. bar%breaks) cycle
            state%condition = bar_condition%broken
            state%force = 0.0_wp
         end associate
      end do
   end subroutine keep_bars

   !> Largest elongation of any bar under a force
   pure real(wp) function longest_give(bars, force)
      type(bar_springs_t), intent(in) :: bars
      real(wp), intent(in) :: force  !! The force [N]
      integer :: i

      longest_give = 0.0_wp
      do i = 1, size(bars%trial)
         if (bars%stiffness(1, i) > 0.0_wp) &
            & longest_give = max(longest_give, force/bars%stiffness(1, i))
      end do
   end function longest_give

   !> Energy stored in elastic bars during a step, and work of the other bars
   pure function bar_energies(bars, motion) result(energy)
      type(bar_springs_t), intent(in) :: bars
      real(wp), intent(in) :: motion(:, :)
      real(wp) :: energy(2)  !! Stored energy, work: (2) [J/m]
      real(wp) :: longer, stiffness(2)
      integer :: i

      energy = 0.0_wp
      do i = 1, size(bars%trial)
         longer = elongation_by(bars, motion, i)
         stiffness = acting(bars, i)
         associate (place => energy(merge(1, 2, bars%condition(i) == bar_condition%elastic)))
            place = place + longer*(acting_force(bars, i) + merge(1.0_wp, 0.5_wp, &
               & bars%share < 1.0_wp)*stiffness(1)*longer)
         end associate
      end do
   end function bar_energies
end module dda_bar_springs
