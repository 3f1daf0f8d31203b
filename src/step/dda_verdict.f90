!> Verdict of a run: fallen blocks, collapse in time, termination criteria
!>
!> Blocks that rest after that are another structure than the one in question. A block may go far
!> and not have fallen: with others that settle under it, or with prescribed points.
!>
!> True if blocks have collapsed in a dynamic run: one has turned too far, or moved too far
!>
!> Termination criteria of a run: stable, collapsed, or not known yet
module dda_verdict
   use dda_balance, only : measure_balance, measure_way_to_rest
   use dda_bar_springs, only : bar_energies
   use dda_block_inertia, only : kinetic_energy
   use dda_block_system, only : block_system_t
   use dda_boundary, only : held_point_t
   use dda_contacts, only : contacts_t
   use dda_deformation, only : displacement_matrix, moved_point
   use dda_kinds, only : pi, wp
   use dda_settings, only : settings_t, verdict
   use dda_step_context, only : march_t, contact_note_t, run_t, step_context_t
   use dda_step_interval, only : longest_motion
   use dda_submatrices, only : elastic_matrix
   implicit none
   private

   public :: has_fallen, has_collapsed, still_moves_away, tests_collapse
   public :: measure_step, judge_verdict, largest_displacement, outcome_t, is_full, points_to_rest

   !> Rotation of a fallen block [rad]
   real(wp), parameter :: turned = pi/4.0_wp

   !> Share of the duration after which displacements are late
   real(wp), parameter :: late = 0.9_wp
   !> Late growth of displacements over the collapse criterion
   real(wp), parameter :: growth = 0.01_wp

   !> Free fall over elastic motion in a step that proves collapse
   real(wp), parameter :: beyond_elastic = 1.0e8_wp
   !> The same in the longest step that converges, and collapse displacement in current geometry
   !> over elastic motion and round-off
   real(wp), parameter :: collapse_multiple = 100.0_wp
   !> The same over the farthest predicted rest
   real(wp), parameter :: beyond_rest = 10.0_wp
   !> Motion of a full step over the permitted one
   real(wp), parameter :: full = 0.5_wp
   !> Share of the load of a block that rounding leaves without balance
   real(wp), parameter :: rounded = 1.0e-13_wp
   !> Residual of strain equilibrium at rest
   real(wp), parameter :: unstrained = 1.0e-11_wp
   !> Last motion at rest over the displacement
   real(wp), parameter :: still = 1.0e-8_wp
   !> Last motion at rest where it is round-off
   real(wp), parameter :: barely = 1.0e-6_wp

   !> Outcome of a run
   type :: outcome_t
      !> One of verdict
      integer :: verdict = 0
      !> Why the verdict is undecided; unallocated otherwise
      character(len=:), allocatable :: reason
      !> Acceleration of the last step over that of the loads
      real(wp) :: acceleration_ratio = 0.0_wp
      !> Acceleration ratio below which the run would have been at rest
      real(wp) :: rest_tolerance = 0.0_wp
      !> Length of a step in which free fall is the elastic motion [s]
      real(wp) :: elastic_time = 0.0_wp
      !> Estimated condition number of the last equations, if it was asked for
      real(wp) :: condition = 0.0_wp
      !> Motion of the step that gave the verdict: (n_dof, n_equation)
      real(wp), allocatable :: motion(:, :)
      !> Contacts after that step, if a collapse has been followed from there, for its pictures or
      !> beyond the step in which it began
      type(contacts_t), allocatable :: fallen
      !> True if histories were followed, or points led, in a static run
      logical :: has_path = .false.
      !> Time that they were followed to; from -1 to 0 prescribed displacements begin [s]
      real(wp) :: path_time = 0.0_wp
      !> Number of jumps on that path to another rest
      integer :: jumps = 0
      !> The largest of these jumps [m]
      real(wp) :: largest_jump = 0.0_wp
      !> Joints that have slid in stages in which blocks were built or removed
      integer :: n_slid = 0
      !> Those of them that the last stage has, by their numbers there
      integer, allocatable :: slid(:)
      !> True if blocks were built in a stage, so that they carry only what came after them
      logical :: has_built = .false.
      !> True if no joint has slid in stages, and yet the last shape built at once slides or falls
      logical :: slides_at_once = .false.
      !> True if blocks moved in time, and the largest opening or slip against the law of contact
      !> then [m/s]
      logical :: has_residual = .false.
      real(wp) :: residual = 0.0_wp
      !> The largest that matters
      type(contact_note_t) :: rough
      !> The largest reduction of restitution, as a share
      type(contact_note_t) :: reduced
      !> Accepted steps
      integer :: steps = 0
      !> Passes of the open-close loop
      integer :: passes = 0
      !> Factorisations
      integer :: factorisations = 0
   end type outcome_t

contains

   !> True if a block has turned by 45 degrees against all blocks whose motion is given, fixed ones
   !> among them, or has moved by its own size and no chain of blocks that touched at the beginning,
   !> each still within its size of the next, ties it to a fixed block or to one that is held
   pure logical function has_fallen(system, pair, held)
      type(block_system_t), intent(in) :: system  !! The blocks, which have moved
      !> The pairs of blocks that touched at the beginning: (2, n_pair)
      integer, intent(in) :: pair(:, :)
      type(held_point_t), intent(in), optional :: held(:)  !! Held and prescribed points
      integer :: directions(size(system%area)), i, last
      logical :: far(size(system%area)), tied(size(system%area)), near
      real(wp) :: least, most

      directions = merge(3, 0, system%equation == 0)
      if (present(held)) then
         do i = 1, size(held)
            associate (n => directions(held(i)%block))
               n = n + count(held(i)%along)
            end associate
         end do
      end if
      associate (turn => system%motion(3, :))
         least = min(0.0_wp, minval(turn, mask=directions >= 3))
         most = max(0.0_wp, maxval(turn, mask=directions >= 3))
         has_fallen = any(turn - most >= turned .or. least - turn >= turned)
      end associate
      far = norm2(system%motion(1:2, :), dim=1) >= sqrt(system%area)
      if (has_fallen .or. .not. any(far)) return
      tied = directions >= 2 .or. .not. far
      last = 0
      do while (count(tied) > last)
         last = count(tied)
         do i = 1, size(pair, 2)
            if (all(tied(pair(:, i))) .or. .not. any(tied(pair(:, i)))) cycle
            near = parted(system, pair(:, i)) < sqrt(minval(system%area(pair(:, i))))
            tied(pair(:, i)) = tied(pair(:, i)) .or. near
         end do
      end do
      has_fallen = .not. all(tied)
   end function has_fallen

   !> Distance of the smaller of two blocks from the place to which the larger would carry it
   pure real(wp) function parted(system, pair)
      type(block_system_t), intent(in) :: system
      integer, intent(in) :: pair(2)  !! The two blocks: (2)
      integer :: large, small

      large = pair(maxloc(system%area(pair), dim=1))
      small = sum(pair) - large
      associate (centre => system%centroid(:, small), motion => system%motion(:, small))
         parted = norm2(moved_point(centre, system%centroid(:, large), system%motion(:, large)) &
            & - centre - motion(1:2))
      end associate
   end function parted

   !> True if a dynamic run has a criterion of collapse
   pure logical function tests_collapse(settings)
      type(settings_t), intent(in) :: settings

      tests_collapse = settings%dynamic .and. settings%current &
         & .and. (settings%collapse_rotation > 0.0_wp .or. settings%collapse_displacement > 0.0_wp)
   end function tests_collapse

   !> Compare the blocks with the criteria of collapse; keeps their progress
   pure subroutine has_collapsed(run, collapsed)
      type(run_t), intent(inout) :: run
      logical, intent(out) :: collapsed  !! True if they have collapsed
      real(wp) :: displacement

      collapsed = .false.
      if (.not. tests_collapse(run%settings)) return
      associate (settings => run%settings, march => run%march)
         march%progress = 0.0_wp
         if (settings%collapse_rotation > 0.0_wp) march%progress &
            & = maxval(abs(run%system%motion(3, :)))/settings%collapse_rotation
         if (settings%collapse_displacement > 0.0_wp) then
            displacement = march%displacement
            if (settings%collapse_point > 0) &
               & displacement = displacement_of_point(settings, run%system)
            march%progress = max(march%progress, displacement/settings%collapse_displacement)
         end if
         collapsed = march%progress >= 1.0_wp
         if (march%time <= late*settings%duration) &
            & march%early_progress = max(march%early_progress, march%progress)
      end associate
   end subroutine has_collapsed

   !> Displacement of the monitoring point that is asked for [m]
   pure real(wp) function displacement_of_point(settings, system)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system

      associate (measured => settings%boundary%measured(settings%collapse_point))
         displacement_of_point = norm2(moved_point(measured%point, &
            & system%centroid(:, measured%block), system%motion(:, measured%block)) &
            & - measured%point)
      end associate
   end function displacement_of_point

   !> True if the blocks are farther at the end of a run than before its last part, so that it is
   !> unknown whether they come back
   pure logical function still_moves_away(settings, march)
      type(settings_t), intent(in) :: settings
      type(march_t), intent(in) :: march

      still_moves_away = .false.
      if (tests_collapse(settings)) &
         & still_moves_away = march%progress > march%early_progress + growth
   end function still_moves_away

   !> Energies and acceleration of a settled static step, before it is carried over
   pure subroutine measure_step(run)
      type(run_t), intent(inout) :: run
      real(wp) :: bar(2), full(6, 6)
      integer :: b, e

      call measure_balance(run%system, run%contacts%springs, run%equations, run%step)
      call measure_way_to_rest(run%equations, run%step)
      associate (system => run%system, equations => run%equations, step => run%step, &
         & motion => run%step%state%motion)
         bar = bar_energies(equations%bars, motion)
         step%work = sum(equations%outer*motion) - bar(2)
         step%kinetic = 4.0_wp*kinetic_energy(equations, motion)/step%dt**2
         step%stored = sum(sum(step%state%force**2 - run%contacts%force**2, dim=1) &
            & /(2.0_wp*run%contacts%springs%stiffness)) + bar(1)
         if (size(motion, 1) < 6) return
         do b = 1, size(system%equation)
            e = system%equation(b)
            if (e == 0) cycle
            full = elastic_matrix(system%materials(system%material(b)), system%area(b))
            step%stored = step%stored + dot_product(motion(4:6, e), matmul(full(4:6, 4:6), &
               & motion(4:6, e))/2.0_wp + system%area(b)*system%stress(:, b))
         end do
      end associate
   end subroutine measure_step

   !> Judge a static run by its last two steps. It stands if the joint forces balance the full load
   !> of every block except for a negligible share, and its strains. It falls if a step proves so;
   !> or, where a displacement means collapse, if a corner has moved as far. After a block has
   !> fallen, rest is collapse
   pure integer function judge_verdict(march, step, settings)
      type(march_t), intent(in) :: march  !! The march, with the acceleration of the last step
      type(step_context_t), intent(in) :: step
      type(settings_t), intent(in) :: settings
      logical :: at_rest, falls

      if (settings%collapse_displacement > 0.0_wp) then
         falls = march%displacement > settings%collapse_displacement
      else if (settings%current) then
         falls = march%moved > far_away(march, settings) .and. step%way_to_rest > march%extent &
            & .and. relaxes_enough(march, step)
      else
         falls = proves_fall(march, step, settings)
      end if
      at_rest = is_at_rest(march, step, settings)
      judge_verdict = verdict%undecided
      if (march%has_fallen .and. (at_rest .or. .not. settings%collapse_displacement > 0.0_wp)) then
         judge_verdict = verdict%collapsed
      else if (at_rest) then
         judge_verdict = verdict%stable
      else if (falls .and. march%steps - march%begun >= 2) then
         judge_verdict = verdict%collapsed
      end if
   end function judge_verdict

   !> Displacement that may prove a fall where blocks move [m]
   pure real(wp) function far_away(march, settings)
      type(march_t), intent(in) :: march
      type(settings_t), intent(in) :: settings

      far_away = max(collapse_multiple*max(march%elastic_motion, march%rounding), &
         & beyond_rest*march%expected_rest)
      ! on a path blocks may leap to another rest
      if (march%begun > 0) &
         & far_away = max(far_away, march%allowed_motion/settings%max_displacement_ratio)
   end function far_away

   !> True if a step is no shorter than the one before, so that its forces do not grow because stiff
   !> parts relax less in it; or shorter only because it goes as far as a step may
   pure logical function relaxes_enough(march, step)
      type(march_t), intent(in) :: march
      type(step_context_t), intent(in) :: step

      relaxes_enough = .not. step%is_shorter .or. is_full(march, step)
   end function relaxes_enough

   !> True if a step goes about as far as it may
   pure logical function is_full(march, step)
      type(march_t), intent(in) :: march
      type(step_context_t), intent(in) :: step

      is_full = step%farthest >= full*longest_motion(march)
   end function is_full

   !> True if the forces of a step show where blocks would come to rest: they lose a good part in
   !> it, or have turned
   pure logical function points_to_rest(step)
      type(step_context_t), intent(in) :: step

      points_to_rest = step%way_to_rest <= beyond_rest*step%farthest
   end function points_to_rest

   !> True if the forces of a step balance all loads. Where blocks move, a step that comes to rest
   !> has only proven the shape it started from
   pure logical function is_at_rest(march, step, settings)
      type(march_t), intent(in) :: march
      type(step_context_t), intent(in) :: step
      type(settings_t), intent(in) :: settings

      is_at_rest = step%residue <= settings%rest_tolerance .and. step%strain_residue <= unstrained
      ! the forces that are kept balance better after one more step
      if (.not. settings%current) is_at_rest = is_at_rest .and. (step%residue <= rounded .or. &
         & march%last_acceleration <= settings%rest_tolerance*march%free_acceleration)
      if (settings%current) is_at_rest = is_at_rest .and. march%steps - march%begun >= 2 &
         & .and. step%farthest <= max(still*march%displacement, march%resolution, &
         & min(march%rounding, barely*march%displacement))
   end function is_at_rest

   !> True if a step proves a fall: blocks have fallen far beyond any elastic motion, and the loads'
   !> work turns into speed alone, or acceleration is steady while no energy is stored
   pure logical function proves_fall(march, step, settings)
      type(march_t), intent(in) :: march
      type(step_context_t), intent(in) :: step
      type(settings_t), intent(in) :: settings
      logical :: far_beyond_elastic, is_certain, is_steady, stores_nothing
      real(wp) :: fall

      fall = march%free_acceleration*step%dt**2/2.0_wp
      ! what slides must itself have moved that far, for joints settle in their slips for a while
      far_beyond_elastic = fall >= beyond_elastic*march%elastic_motion &
         & .and. (step%farthest >= march%elastic_motion .or. .not. slides(step)) &
         & .or. (step%was_cut .or. step%dt >= march%longest) &
         & .and. fall >= collapse_multiple*march%elastic_motion
      ! what drives the blocks must be more than what the bounds of friction are off by, and speed
      ! without work is rounding
      is_certain = step%kinetic > 2.0_wp*step%state%unsettled_work &
         & .and. (step%kinetic < 1.1_wp*step%work .or. allocated(settings%boundary%held))
      is_steady = abs(step%acceleration - march%last_acceleration) < 0.01_wp*march%last_acceleration
      stores_nothing = abs(step%stored) < 1.0e-3_wp*abs(step%work)
      proves_fall = far_beyond_elastic .and. is_certain .and. (step%kinetic > 0.999_wp*step%work &
         & .or. is_steady .and. (step%kinetic > 0.9_wp*step%work .or. stores_nothing))
   end function proves_fall

   !> True if a joint slides at the end of a step
   pure logical function slides(step)
      type(step_context_t), intent(in) :: step

      slides = .false.
      if (allocated(step%state%face)) slides = any(step%state%face%slip /= 0)
   end function slides

   !> Farthest that a corner has moved since the beginning
   pure function largest_displacement(system, current, since) result(largest)
      type(block_system_t), intent(in) :: system
      !> True if they move
      logical, intent(in) :: current
      !> The blocks at another time to measure from, where they move
      type(block_system_t), intent(in), optional :: since
      !> The displacement [m]
      real(wp) :: largest
      real(wp) :: t(2, 6), displacement(2)
      integer :: b, v

      largest = 0.0_wp
      do b = 1, size(system%equation)
         if (system%equation(b) == 0) cycle
         do v = system%first_vertex(b), system%first_vertex(b + 1) - 1
            if (current) then
               displacement = system%moved(:, v) - system%vertex(:, v)
               if (present(since)) displacement = system%moved(:, v) - since%moved(:, v)
            else
               t = displacement_matrix(system%vertex(:, v), system%centroid(:, b))
               displacement = matmul(t, system%motion(:, b))
            end if
            largest = max(largest, norm2(displacement))
         end do
      end do
   end function largest_displacement

end module dda_verdict
