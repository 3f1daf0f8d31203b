!> The length of a step (Shi: step)
module dda_step_interval
   use dda_assembly, only : assemble_blocks, equations_t, solve_faces
   use dda_block_system, only : block_system_t
   use dda_error, only : error_t, fatal_error
   use dda_friction_cone, only : cone_t, joint_face_t
   use dda_joint_springs, only : joint_springs_t
   use dda_kinds, only : wp
   use dda_open_close, only : step_state_t
   use dda_settings, only : settings_t
   use dda_step_context, only : march_t
   implicit none
   private

   public :: first_interval, next_interval, largest_motion

   !> Free fall in the first static step over the elastic motion
   real(wp), parameter :: first_fall = 1.0e6_wp
   !> Growth of the static step
   real(wp), parameter :: growth = 10.0_wp
   !> Least ratio of the inertia 2 m/dt**2 to the penalty stiffness: beyond, rounding takes over
   real(wp), parameter :: least_inertia = 1.0e-13_wp

contains

   !> Scales of the problem and the length of the first step: long enough that inertia does not
   !> hide the elastic motion, which is found by gluing all joints
   pure subroutine first_interval(system, springs, settings, equations, state, march, error)
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> The springs of the joints
      type(joint_springs_t), intent(in) :: springs
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The equations; matrix and factor are made anew
      type(equations_t), intent(inout) :: equations
      !> The step's state; its motion becomes that of the glued system
      type(step_state_t), intent(inout) :: state
      !> The march, made new
      type(march_t), intent(out) :: march
      !> Allocated if the system cannot be solved even with all joints glued
      type(error_t), allocatable, intent(out) :: error
      type(cone_t) :: glued(size(springs%stiffness))
      type(joint_face_t) :: closed(size(springs%stiffness))
      real(wp) :: mean_mass
      integer :: e

      mean_mass = 0.0_wp
      do e = 1, size(equations%mass, 3)
         mean_mass = mean_mass + equations%mass(1, 1, e)/real(size(equations%mass, 3), wp)
         march%free_acceleration = max(march%free_acceleration, &
            & norm2(equations%weight(1:2, e))/equations%mass(1, 1, e))
      end do
      march%longest = sqrt(2.0_wp*mean_mass/(least_inertia*maxval(springs%stiffness)))
      if (settings%dynamic) then
         march%dt = dynamic_step(system, settings, march%free_acceleration)
         return
      end if
      march%dt = march%longest
      call assemble_blocks(system, settings, march%dt, equations)
      call solve_faces(equations, springs, glued, closed, state%start, state%motion)
      if (.not. equations%factor%usable) then
         call fatal_error(error, "the blocks with all joints closed make no stable system")
         return
      end if
      march%elastic_motion = largest_motion(system, state%motion)
      if (march%free_acceleration > 0.0_wp) march%dt = min(march%longest, &
         & sqrt(2.0_wp*first_fall*march%elastic_motion/march%free_acceleration))
      if (settings%time_step > 0.0_wp) march%dt = min(march%longest, settings%time_step)
   end subroutine first_interval

   !> Length of a dynamic step: the one that was asked for, or that in which free fall from rest
   !> goes as far as a step may
   pure function dynamic_step(system, settings, free_acceleration) result(dt)
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> Acceleration that the loads would give to free blocks [m/s2]
      real(wp), intent(in) :: free_acceleration
      !> The length [s]
      real(wp) :: dt
      real(wp) :: farthest

      dt = settings%time_step
      if (dt > 0.0_wp) return
      dt = 1.0_wp
      farthest = settings%max_displacement_ratio &
         & *sqrt(minval(system%area, mask=system%equation > 0))
      if (free_acceleration > 0.0_wp) dt = sqrt(2.0_wp*farthest/free_acceleration)
   end function dynamic_step

   !> Length of the step that follows an accepted one
   pure subroutine next_interval(settings, march)
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The march
      type(march_t), intent(inout) :: march

      if (.not. settings%dynamic) march%dt = min(march%longest, growth*march%dt)
   end subroutine next_interval

   !> Largest motion of the points of all blocks: of the centre, and of a point at the radius of
   !> gyration by rotation
   pure function largest_motion(system, motion) result(largest)
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> Motion of the blocks: (n_dof, n_equation)
      real(wp), intent(in) :: motion(:, :)
      !> The largest motion [m]
      real(wp) :: largest
      real(wp) :: gyration
      integer :: b, e

      largest = 0.0_wp
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         gyration = sqrt((system%second(1, b) + system%second(2, b))/system%area(b))
         largest = max(largest, norm2(motion(1:2, e)) + gyration*abs(motion(3, e)))
      end do
   end function largest_motion
end module dda_step_interval
