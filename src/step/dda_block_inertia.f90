!> Equations of the blocks without contacts: inertia, elasticity, loads (Shi: df11 to df16)
module dda_block_inertia
   use dda_bar_springs, only : add_bars, follow_bars
   use dda_block_system, only : block_system_t
   use dda_deformation, only : turned_tensor
   use dda_step_state, only : equations_t
   use dda_submatrices, only : elastic_matrix, mass_matrix, stress_load
   use dda_fixed_points, only : add_fixed_springs, follow_fixed_points, hold_rigidly
   use dda_kinds, only : wp
   use dda_outer_loads, only : outer_loads
   use dda_material, only : elasticity_matrix
   use dda_settings, only : settings_t
   implicit none
   private

   public :: assemble_blocks, damping_rate, drop_strain_rates, hold_energy, kinetic_energy
   public :: packed_velocity, strain_follows, turn_masses

contains

   !> Block part of matrix and load of one step of length dt. Forces that change with time are their
   !> mean over a dynamic step, those of the time of a static one
   pure subroutine assemble_blocks(system, settings, dt, equations, time)
      type(block_system_t), intent(in) :: system
      type(settings_t), intent(in) :: settings
      real(wp), intent(in) :: dt  !! Length of the step [s]
      type(equations_t), intent(inout) :: equations
      !> Time at the beginning of a dynamic step, or of the loads in a static one; zero if it is
      !> left out [s]
      real(wp), intent(in), optional :: time
      real(wp) :: before(size(equations%base, 1), size(equations%base, 2), size(equations%base, 3))
      real(wp) :: finish, start, damping, full(6, 6)
      integer :: b, e

      before = equations%base
      start = 0.0_wp
      if (present(time)) start = time
      damping = damping_rate(settings, dt)
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         full = elastic_matrix(system%materials(system%material(b)), system%area(b))
         equations%base(:, :, e) = full(:settings%n_dof, :settings%n_dof) &
            & + (2.0_wp/dt**2 + damping/dt)*equations%mass(:, :, e)
      end do
      if (settings%dynamic .and. size(equations%dashpot) > 0) &
         & equations%base = equations%base + equations%dashpot/dt
      call outer_loads(system, settings, start, dt, equations%weight, equations%outer, &
         & equations%felt)
      equations%force_scale = sum(equations%felt(1:2, :))
      equations%gap_noise = 4.0_wp*epsilon(1.0_wp)*maxval(abs(system%moved))
      call load_blocks(system, settings, dt, equations)
      finish = start
      if (settings%dynamic) finish = start + dt
      call follow_fixed_points(system, settings, finish, dt, equations%fixed)
      call add_fixed_springs(equations%fixed, equations%fixed%target, equations%base, &
         & equations%load)
      call follow_bars(system, settings, equations%bars)
      call add_bars(equations%bars, 1.0_wp, equations%base, equations%load)
      ! in reference geometry steps of one length have one matrix
      do e = 1, size(before, 3)
         equations%changed(e) = equations%changed(e) .or. size(equations%bars%entry) > 0 &
            & .or. .not. all(abs(equations%base(:, :, e) - before(:, :, e)) <= 0.0_wp)
      end do
   end subroutine assemble_blocks

   !> Load of the blocks: outer forces, stress, and in a dynamic step the impetus of velocities
   pure subroutine load_blocks(system, settings, dt, equations)
      type(block_system_t), intent(in) :: system
      type(settings_t), intent(in) :: settings
      real(wp), intent(in) :: dt
      type(equations_t), intent(inout) :: equations
      real(wp) :: stress(6), impetus(6)
      integer :: b, e, nd

      nd = settings%n_dof
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         stress = stress_load(system%stress(:, b), system%area(b))
         equations%load(:, e) = equations%outer(:, e) + stress(:nd)
         if (.not. settings%dynamic) cycle
         impetus(:nd) = (2.0_wp/dt)*matmul(equations%mass(:, :, e), system%velocity(:nd, b))
         equations%load(:, e) = equations%load(:, e) + impetus(:nd)
         equations%force_scale = equations%force_scale + sum(abs(impetus(1:2)))
      end do
   end subroutine load_blocks

   !> Rate of mass damping in a dynamic step: never more than what would stop a block within it
   pure real(wp) function damping_rate(settings, dt)
      type(settings_t), intent(in) :: settings
      real(wp), intent(in) :: dt

      damping_rate = 0.0_wp
      if (settings%dynamic) damping_rate = min(settings%damping, 2.0_wp/dt)
   end function damping_rate

   !> Masses of blocks that have turned; it acts on strain rates alone
   pure subroutine turn_masses(system, equations)
      type(block_system_t), intent(in) :: system
      type(equations_t), intent(inout) :: equations
      real(wp) :: full(6, 6)
      integer :: b, e

      if (size(equations%mass, 1) < 6) return
      do b = 1, size(system%equation)
         e = system%equation(b)
         if (e == 0) cycle
         full = mass_matrix(system%density(b), system%area(b), &
            & turned_tensor(system%second(:, b), -system%motion(3, b), 1.0_wp))
         equations%mass(:, :, e) = full
      end do
   end subroutine turn_masses

   !> Energy of motion
   pure real(wp) function kinetic_energy(equations, velocity)
      type(equations_t), intent(in) :: equations
      real(wp), intent(in) :: velocity(:, :)  !! Velocities: (n_dof, n_equation)
      integer :: e

      kinetic_energy = 0.0_wp
      do e = 1, size(velocity, 2)
         kinetic_energy = kinetic_energy + dot_product(velocity(:, e), &
            & matmul(equations%mass(:, :, e), velocity(:, e)))/2.0_wp
      end do
   end function kinetic_energy

   !> Let the velocities have no more energy than there is: mix into them those of constant
   !> acceleration, up to the least energy of all mixtures where none has as little. Momentum stays,
   !> and a mixture of admissible impulses is admissible
   pure subroutine hold_energy(equations, steady, allowed, velocity, share)
      type(equations_t), intent(in) :: equations
      !> Velocities at the end of constant acceleration: (n_dof, n_equation)
      real(wp), intent(in) :: steady(:, :)
      !> The energy [J/m]
      real(wp), intent(in) :: allowed
      real(wp), intent(inout) :: velocity(:, :)
      !> Share of those of constant acceleration that is mixed into them
      real(wp), intent(out) :: share
      real(wp) :: excess, slope, square, root

      share = 0.0_wp
      excess = kinetic_energy(equations, velocity) - allowed
      if (.not. excess > 0.0_wp) return
      square = kinetic_energy(equations, steady - velocity)
      slope = kinetic_energy(equations, steady) - kinetic_energy(equations, velocity) - square
      ! excess + share*slope + share**2*square = 0
      root = slope**2 - 4.0_wp*excess*square
      if (.not. slope < 0.0_wp) return
      share = -slope/(2.0_wp*square)
      if (root > 0.0_wp) share = 2.0_wp*excess/(sqrt(root) - slope)
      share = min(1.0_wp, share)
      velocity = velocity + share*(steady - velocity)
   end subroutine hold_energy

   !> Velocities as the equations have them
   pure function packed_velocity(system, n_dof) result(velocity)
      type(block_system_t), intent(in) :: system
      integer, intent(in) :: n_dof                          !! Unknowns of a block
      real(wp) :: velocity(n_dof, maxval(system%equation))  !! The velocities: (n_dof, n_equation)
      integer :: b

      do b = 1, size(system%equation)
         if (system%equation(b) > 0) velocity(:, system%equation(b)) = system%velocity(:n_dof, b)
      end do
   end function packed_velocity

   !> Blocks whose strain follows their load, as a step does not resolve its swinging: the fastest,
   !> that across the narrow side of the block, goes on by more than one radian, A D11/(rho S)
   pure function strain_follows(system, dt) result(follows)
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: dt                 !! Length of the longest step [s]
      logical :: follows(size(system%equation))  !! The answer: (n_block)
      real(wp) :: d(3, 3), narrow
      integer :: b

      do b = 1, size(follows)
         d = elasticity_matrix(system%materials(system%material(b)))
         associate (s => system%second(:, b))
            narrow = (s(1) + s(2))/2.0_wp - norm2([(s(1) - s(2))/2.0_wp, s(3)])
            follows(b) = dt**2*system%area(b)*d(1, 1) > system%density(b)*narrow
         end associate
      end do
   end function strain_follows

   !> No rates of strains that follow their load
   pure subroutine drop_strain_rates(equation, follows, equations)
      integer, intent(in) :: equation(:)  !! Equation of each block, 0 for a fixed one: (n_block)
      logical, intent(in) :: follows(:)   !! Blocks without strain rates: (n_block)
      type(equations_t), intent(inout) :: equations
      integer :: b, e

      if (size(equations%load, 1) < 6) return
      do b = 1, size(follows)
         e = equation(b)
         if (e == 0 .or. .not. follows(b)) cycle
         equations%base(4:, :3, e) = 0.0_wp
         equations%base(:3, 4:, e) = 0.0_wp
         call hold_rigidly(e, equations%fixed)
         equations%load(4:, e) = 0.0_wp
      end do
   end subroutine drop_strain_rates
end module dda_block_inertia
