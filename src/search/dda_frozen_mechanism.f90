!> The power of the loads on a mechanism whose joints keep to their faces, as a smooth function of
!> the parameter of a search: its zero is where the mechanism stops
submodule (dda_critical:dda_collapse_trace) dda_frozen_mechanism
   use dda_assembly, only : new_equations, solve_faces
   use dda_block_factor, only : substitute
   use dda_block_inertia, only : assemble_blocks
   use dda_block_system, only : block_system_t
   use dda_contact_types, only : joint_springs_t, new_joint_springs, same_joint
   use dda_settings, only : settings_t
   use dda_step_state, only : equations_t
   implicit none

contains

   !> Power of the loads on the mechanism
   module procedure mechanism_power
      type(equations_t) :: equations
      type(joint_springs_t) :: springs
      type(settings_t) :: settings
      real(wp), allocatable :: motion(:, :)
      real(wp) :: scale, trial(3, size(mechanism%face))
      integer :: b, e, pass

      power = 0.0_wp
      noise = 0.0_wp
      usable = is_of(mechanism, scene)
      if (.not. usable) return
      settings = scene%settings
      settings%n_dof = 3
      call new_joint_springs(scene%system, 0.0_wp*scene%system%motion, scene%contacts%joint, &
         & settings%penalty_ratio, settings%n_dof, springs)
      call new_equations(scene%system, springs, settings, equations)
      allocate (motion, source=mechanism%motion)
      call assemble_blocks(scene%system, settings, mechanism%dt, equations)
      trial = 0.0_wp
      call solve_faces(equations, springs, springs%cone, mechanism%face, trial, motion)
      usable = equations%factor%usable
      if (.not. usable) return
      do pass = 1, 2
         call weigh(equations, mechanism%dt, motion)
         call substitute(equations%factor, motion)
      end do
      call weigh(equations, mechanism%dt, motion)
      power = sum(motion*mechanism%motion)
      motion = mechanism%motion
      call weigh(equations, mechanism%dt, motion)
      scale = sum(motion*mechanism%motion)
      power = power/scale
      do b = 1, size(scene%system%equation)
         e = scene%system%equation(b)
         if (e > 0) noise = noise + area_rounding(scene%system, b) &
            & *abs(dot_product(equations%weight(:, e), mechanism%motion(:, e)))
      end do
      noise = noise/scale
   end procedure mechanism_power

   !> Whether a scene has the blocks and joints of a mechanism, in the same order
   pure logical function is_of(mechanism, scene)
      type(frozen_mechanism_t), intent(in) :: mechanism
      type(scene_t), intent(in) :: scene

      is_of = size(mechanism%motion, 2) == maxval(scene%system%equation) &
         & .and. size(mechanism%joint) == size(scene%contacts%joint)
      if (is_of) is_of = all(same_joint(mechanism%joint, scene%contacts%joint))
   end function is_of

   !> Multiply a motion by the inertia
   pure subroutine weigh(equations, dt, motion)
      type(equations_t), intent(in) :: equations
      !> Length of the step [s]
      real(wp), intent(in) :: dt
      !> Motion in, inertia force out: (n_dof, n_equation)
      real(wp), intent(inout) :: motion(:, :)
      integer :: e

      do e = 1, size(motion, 2)
         motion(:, e) = (2.0_wp/dt**2)*matmul(equations%mass(:, :, e), motion(:, e))
      end do
   end subroutine weigh

   !> Relative error of a block's area by the rounding of its corners' coordinates
   pure real(wp) function area_rounding(system, block)
      type(block_system_t), intent(in) :: system
      !> Number of the block
      integer, intent(in) :: block

      associate (vertex => system%vertex(:, &
         & system%first_vertex(block):system%first_vertex(block + 1) - 1))
         area_rounding = epsilon(1.0_wp)*maxval(abs(vertex)) &
            & *sum(norm2(vertex - cshift(vertex, 1, dim=2), dim=1))/system%area(block)
      end associate
   end function area_rounding

end submodule dda_frozen_mechanism
