!> The length of a step (Shi: step)
module dda_step_interval
   use dda_assembly, only : solve_faces
   use dda_bar_springs, only : longest_give
   use dda_balance, only : free_acceleration, gyration
   use dda_boundary, only : history_t
   use dda_block_inertia, only : assemble_blocks, kinetic_energy, packed_velocity
   use dda_block_system, only : block_system_t
   use dda_error, only : error_t, fatal_error
   use dda_friction_cone, only : cone_t, joint_face_t
   use dda_kinds, only : wp
   use dda_load_clock, only : has_path, new_load_clock
   use dda_settings, only : settings_t
   use dda_step_context, only : march_t, may_shorten, run_t, step_context_t, step_outcome_t
   use dda_step_state, only : equations_t
   implicit none
   private

   public :: check_length, first_interval, next_interval, largest_motion, measure_scales
   public :: aim, cut, longest_motion

   !> Free fall in the first static step over the elastic motion
   real(wp), parameter :: first_fall = 1.0e2_wp
   !> Acceleration over the previous one below which a step keeps its length
   real(wp), parameter :: settling = 1.0e-3_wp
   !> Growth of the static step
   real(wp), parameter :: growth = 10.0_wp
   !> Cosine between successive motions below which steps oscillate
   real(wp), parameter :: rattling = -0.3_wp
   !> Growth of the step after a reduction
   real(wp), parameter :: calm_growth = 3.0_wp
   !> Oscillation that is ignored, over the displacement
   real(wp), parameter :: rattle_share = 1.0e-4_wp
   !> Motion of a fitted step over the permitted one
   real(wp), parameter :: aim = 0.8_wp
   !> Factor of a step without convergence
   real(wp), parameter :: cut = 0.3_wp
   !> Entry of a step over the size of the smallest block: each is kept, and a few add up to 1e-4
   real(wp), parameter :: deepest = 5.0e-6_wp
   !> Motion over the permitted one above which a step is rejected
   real(wp), parameter :: too_far = 2.0_wp
   !> The same on a loading path
   real(wp), parameter :: on_path = 0.5_wp
   !> Free fall per step over the size of the smallest block
   real(wp), parameter :: longest_fall = 0.25_wp
   !> Least elastic motion over that of the strain
   real(wp), parameter :: least_of_strain = 0.1_wp
   !> Least inertia 2 m/dt**2 over the penalty stiffness
   real(wp), parameter :: least_inertia = 1.0e-13_wp

contains

   !> Scales of the problem and the length of the first step
   pure subroutine first_interval(run, error)
      !> The run; its march begins, the motion of the step becomes that of the bonded system, its
      !> faces those to begin with
      type(run_t), intent(inout) :: run
      !> Allocated if the system cannot be solved even with all joints bonded
      type(error_t), allocatable, intent(out) :: error

      if (.not. run%settings%dynamic) run%march%clock = new_load_clock(run%settings)
      if (has_path(run%march%clock)) run%march%time = run%march%clock%now
      call measure_scales(run)
      if (run%settings%dynamic) then
         run%march%dt = run%march%longest
         call fit_interval(run%settings, largest_motion(run%system, &
            & packed_velocity(run%system, size(run%equations%weight, 1))), run%march)
      else
         call first_static_interval(run, error)
      end if
   end subroutine first_interval

   !> Length of the first static step: long enough that inertia does not hide the elastic motion,
   !> which is found by gluing all joints
   pure subroutine first_static_interval(run, error)
      type(run_t), intent(inout) :: run
      type(error_t), allocatable, intent(out) :: error
      type(cone_t) :: glued(size(run%contacts%joint))
      type(joint_face_t) :: closed(size(run%contacts%joint))
      real(wp) :: stiffest

      associate (march => run%march, springs => run%contacts%springs, &
         & equations => run%equations, state => run%step%state)
         stiffest = maxval(run%system%materials%young)
         if (size(glued) > 0) stiffest = maxval(springs%stiffness)
         march%longest = sqrt(2.0_wp*sum(equations%mass(1, 1, :) &
            & /real(size(equations%mass, 3), wp))/(least_inertia*stiffest))
         march%dt = march%longest
         call assemble_first_loads(run)
         call solve_faces(equations, springs, glued, closed, state%trial, state%motion)
         if (.not. equations%factor%usable) then
            call fatal_error(error, "stiffness matrix is singular even with all joints closed")
            return
         end if
         march%free_acceleration = free_acceleration(run%system, equations)
         march%last_acceleration = march%free_acceleration
         march%elastic_motion = elastic_motion(run)
         if (march%free_acceleration > 0.0_wp) march%dt = min(march%longest, &
            & sqrt(2.0_wp*first_fall*march%elastic_motion/march%free_acceleration))
         if (run%settings%time_step > 0.0_wp) &
            & march%dt = min(march%longest, run%settings%time_step)
      end associate
   end subroutine first_static_interval

   !> The scale of elastic motion, once the bonded system has moved. Where blocks fall even so, as
   !> one that stands on a corner does, most work of the loads is speed [m]
   pure real(wp) function elastic_motion(run)
      type(run_t), intent(in) :: run
      real(wp) :: whole
      logical :: falls

      associate (springs => run%contacts%springs, equations => run%equations, &
         & motion => run%step%state%motion)
         whole = sum(norm2(equations%felt(1:2, :), dim=1))
         elastic_motion = max(largest_motion(run%system, motion), &
            & least_of_strain*straining_motion(run%system, motion))
         falls = 4.0_wp*kinetic_energy(equations, motion)/run%march%dt**2 &
            & > 0.5_wp*sum(equations%outer*motion)
         if (falls .and. size(springs%stiffness) > 0) elastic_motion = min(elastic_motion, &
            & (1.0_wp + run%settings%penalty_ratio)*whole/minval(springs%stiffness))
         elastic_motion = max(elastic_motion, longest_give(equations%bars, whole))
      end associate
   end function elastic_motion

   !> The blocks with the loads that scales are measured by: those of the beginning, or the first
   !> that come where there are none. Prescribed points do not move
   pure subroutine assemble_first_loads(run)
      type(run_t), intent(inout) :: run
      type(settings_t) :: unled
      integer :: i

      associate (clock => run%march%clock, equations => run%equations)
         call assemble_blocks(run%system, run%settings, run%march%dt, equations, clock%now)
         if (any(abs(equations%outer) > 0.0_wp)) return
         unled = run%settings
         if (allocated(unled%boundary%held)) unled%boundary%held%path = history_t()
         do i = 2, size(clock%bend)
            call assemble_blocks(run%system, unled, run%march%dt, equations, clock%bend(i))
            if (any(abs(equations%outer) > 0.0_wp)) return
         end do
      end associate
   end subroutine assemble_first_loads

   !> Scales of the problem, which do not change as it goes on, and of a dynamic run the longest
   !> step
   pure subroutine measure_scales(run)
      type(run_t), intent(inout) :: run
      integer :: e

      associate (march => run%march, system => run%system, equations => run%equations)
         do e = 1, size(equations%mass, 3)
            march%free_acceleration = max(march%free_acceleration, &
               & norm2(equations%weight(1:2, e))/equations%mass(1, 1, e))
         end do
         march%last_acceleration = march%free_acceleration
         march%resolution = epsilon(1.0_wp)*maxval(abs(system%vertex))
         march%extent = extent_of_movable(system)
         if (run%settings%current) march%rounding = feigned_motion(system)
         march%allowed_motion = run%settings%max_displacement_ratio &
            & *sqrt(minval(system%area, mask=system%equation > 0))
         if (run%settings%dynamic) march%longest = dynamic_step(run%settings, march)
      end associate
   end subroutine measure_scales

   !> Size of all blocks that can move: the diagonal of the box around them
   pure function extent_of_movable(system) result(extent)
      type(block_system_t), intent(in) :: system
      real(wp) :: extent  !! The diagonal [m]
      real(wp) :: low(2), high(2)
      integer :: b

      low = huge(low)
      high = -huge(high)
      do b = 1, size(system%equation)
         if (system%equation(b) == 0) cycle
         associate (vertex => system%vertex(:, &
            & system%first_vertex(b):system%first_vertex(b + 1) - 1))
            low = min(low, minval(vertex, dim=2))
            high = max(high, maxval(vertex, dim=2))
         end associate
      end do
      extent = norm2(high - low)
   end function extent_of_movable

   !> Apparent motion by rounding of coordinates: a corner off by eps of the model's size tilts
   !> a block, and that moves its far end by the block's aspect ratio times as much; errors of many
   !> blocks add up by chance
   pure function feigned_motion(system) result(motion)
      type(block_system_t), intent(in) :: system
      real(wp) :: motion  !! The motion [m]
      real(wp) :: slender
      integer :: b

      slender = 0.0_wp
      do b = 1, size(system%equation)
         if (system%equation(b) == 0) cycle
         associate (vertex => system%vertex(:, &
            & system%first_vertex(b):system%first_vertex(b + 1) - 1))
            slender = max(slender, sum(norm2(vertex - cshift(vertex, 1, dim=2), dim=1))**2 &
               & /system%area(b))
         end associate
      end do
      motion = epsilon(1.0_wp)*maxval(abs(system%vertex))*slender &
         & *sqrt(real(count(system%equation > 0), wp))
   end function feigned_motion

   !> Length of a dynamic step: that in which free fall from rest goes as far as a step may, or the
   !> length in the deck, unless blocks would move in it by a large part of their size: contacts
   !> in such a step depend on the place of the search
   pure function dynamic_step(settings, march) result(dt)
      type(settings_t), intent(in) :: settings
      type(march_t), intent(in) :: march
      real(wp) :: dt  !! The length [s]
      real(wp) :: fall

      dt = settings%time_step
      if (.not. march%free_acceleration > 0.0_wp) then
         if (.not. dt > 0.0_wp) dt = 1.0_wp
      else if (.not. dt > 0.0_wp) then
         dt = sqrt(2.0_wp*march%allowed_motion/march%free_acceleration)
      else if (settings%current) then
         fall = march%allowed_motion*min(1.0_wp, longest_fall/settings%max_displacement_ratio)
         dt = min(dt, sqrt(2.0_wp*fall/march%free_acceleration))
      end if
   end function dynamic_step

   !> Shorten a dynamic step that would move too far, or beyond the end of the run
   pure subroutine fit_interval(settings, speed, march)
      type(settings_t), intent(in) :: settings
      real(wp), intent(in) :: speed          !! Speed of the fastest point [m/s]
      type(march_t), intent(inout) :: march  !! The march; the length of the next step is set
      real(wp) :: left

      if (settings%current .and. speed*march%dt > march%allowed_motion) &
         & march%dt = march%allowed_motion/speed
      if (.not. settings%duration > 0.0_wp) return
      left = settings%duration - march%time
      ! what many rounded steps leave over is no step of its own
      if (.not. left > 0.0_wp .or. left >= march%dt*(2.0_wp - 1.0e-6_wp)) return
      ! nor is a small rest, in which strain would follow rounding
      march%dt = merge(left, left/2.0_wp, left < march%dt*(1.0_wp + 1.0e-6_wp))
   end subroutine fit_interval

   !> Check that a try has settled, that no block has entered another by what contact forces leave,
   !> and, where blocks move, that none has moved too far for a linear step (Shi: df24)
   pure type(step_outcome_t) function check_length(run) result(outcome)
      type(run_t), intent(in) :: run
      real(wp) :: factor, limit

      outcome%dt = run%step%dt
      outcome%accepted = run%step%state%settled .and. .not. enters(run)
      if (.not. outcome%accepted) then
         outcome%dt = cut*run%step%dt
         outcome%was_cut = .true.
         return
      end if
      limit = longest_motion(run%march)
      outcome%accepted = .not. run%settings%current .or. run%step%farthest <= limit
      if (outcome%accepted) return
      factor = aim*sqrt(limit/run%step%farthest)
      ! what strain alone holds goes as far in a step a little shorter
      if (run%step%last_farthest > limit) factor = min(cut, factor)
      outcome%dt = factor*run%step%dt
   end function check_length

   !> True if contact forces of a dynamic run leave blocks inside one another
   pure logical function enters(run)
      type(run_t), intent(in) :: run

      enters = run%step%state%residual > deepest*sqrt(minval(run%system%area, &
         & mask=run%system%equation > 0)) .and. may_shorten(run)
   end function enters

   !> Most that a step may move where blocks move
   pure real(wp) function longest_motion(march)
      type(march_t), intent(in) :: march

      longest_motion = merge(on_path, too_far, march%begun > 0)*march%allowed_motion
   end function longest_motion

   !> Length of the step that follows an accepted one. Where blocks move it aims at the motion that
   !> a step may make, and shrinks where blocks oscillate
   pure subroutine next_interval(run)
      type(run_t), intent(inout) :: run
      real(wp) :: factor, speed

      associate (march => run%march, step => run%step, settings => run%settings)
         factor = merge(1.0_wp, growth, step%acceleration < settling*march%last_acceleration)
         march%last_acceleration = step%acceleration
         if (settings%dynamic) then
            march%dt = march%longest
            if (step%was_cut) march%dt = min(march%longest, calm_growth*step%dt)
            speed = 0.0_wp
            if (settings%current) speed = largest_motion(run%system, step%velocity)
            call fit_interval(settings, speed, march)
            return
         end if
         if (step%was_cut) factor = min(factor, calm_growth)
         if (settings%current) then
            if (step%farthest > 0.0_wp) &
               & factor = min(growth, aim*sqrt(longest_motion(march)/step%farthest))
            if (allocated(march%last_motion)) &
               & factor = merge(1.0_wp/growth, min(factor, calm_growth), rattles(march, step))
            march%last_motion = step%state%motion
         end if
         march%dt = min(march%longest, factor*march%dt)
      end associate
   end subroutine next_interval

   !> True if a step goes back on the one before
   pure logical function rattles(march, step)
      type(march_t), intent(in) :: march
      type(step_context_t), intent(in) :: step
      real(wp) :: alike

      alike = sum(march%last_motion*step%state%motion) &
         & /max(tiny(1.0_wp), norm2(march%last_motion)*norm2(step%state%motion))
      rattles = alike < rattling &
         & .and. step%farthest > max(march%rounding, rattle_share*march%displacement)
   end function rattles

   !> Largest motion of a point at the radius of gyration by the strain of its block
   pure function straining_motion(system, motion) result(largest)
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: motion(:, :)  !! Motion of the blocks: (n_dof, n_equation)
      real(wp) :: largest                   !! The largest motion [m]
      integer :: b, e

      largest = 0.0_wp
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e > 0) largest = max(largest, norm2(motion(4:, e))*gyration(system, b))
      end do
   end function straining_motion

   !> Largest motion of the points of all blocks: of the centre, and of a point at the radius of
   !> gyration by rotation
   pure function largest_motion(system, motion) result(largest)
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: motion(:, :)
      real(wp) :: largest  !! The largest motion [m]
      integer :: b, e

      largest = 0.0_wp
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e > 0) largest = max(largest, norm2(motion(1:2, e)) &
            & + gyration(system, b)*abs(motion(3, e)))
      end do
   end function largest_motion
end module dda_step_interval
