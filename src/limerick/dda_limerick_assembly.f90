!> Equations of a step: pattern, blocks, contacts, bolts (Shi: df08, df10 to df18)
!>
!> Bolts follow Shi's rule (Shi: df17): linear springs in tension and compression, without strength,
!> along the line between their ends at the beginning of each step.
module dda_limerick_assembly
   use dda_bar_place, only : bar_rows
   use dda_bar_springs, only : add_bars, bar_springs_t, couple_bars, new_bar_springs
   use dda_block_factor, only : block_factor_t, plan_factor
   use dda_block_matrix, only : block_matrix_t, set_pattern
   use dda_block_system, only : n_unknown
   use dda_kinds, only : wp
   use dda_limerick_contact, only : contact_list_t, contact_spring_t, limerick_contact_t
   use dda_limerick_model, only : contact_law, force_at, limerick_blocks_t, limerick_march_t, &
      & limerick_model_t, limerick_state
   use dda_submatrices, only : elastic_matrix, mass_matrix, point_load, stress_load
   implicit none
   private

   public :: add_contacts, assemble_limerick, couple_blocks, limerick_equations_t, placed_bolts

   !> Matrix, loads and unknowns of a step
   type :: limerick_equations_t
      integer, allocatable :: pair(:, :)      !! Coupled blocks of the present pattern: (2, n_pair)
      type(block_matrix_t) :: matrix          !! The matrix
      type(block_factor_t) :: factor          !! Its factor
      real(wp), allocatable :: base(:, :, :)  !! Matrix of the blocks: (6, 6, n_block)
      real(wp), allocatable :: load(:, :)     !! Right-hand side of the blocks: (6, n_block)
      type(bar_springs_t) :: bolts            !! Bolts, always elastic
      !> Right-hand side, then the motion of the step: (6, n_block)
      real(wp), allocatable :: motion(:, :)
   end type limerick_equations_t

contains

   !> Bolts at the present positions of their blocks
   pure type(bar_springs_t) function placed_bolts(model, blocks) result(bolts)
      type(limerick_model_t), intent(in) :: model
      type(limerick_blocks_t), intent(in) :: blocks  !! The blocks at the beginning of the step
      integer :: i

      bolts = new_bar_springs(model%boundary, [(i, i=1, size(blocks%area))], n_unknown)
      do i = 1, size(bolts%trial)
         associate (bolt => model%boundary%bar(i))
            bolts%row(:, 1, :, i) = bar_rows(blocks%bolt_point(:, :, i), bolt%block, &
               & blocks%centroid)
            bolts%stiffness(1, i) = bolt%stiffness
            bolts%trial(i) = blocks%bolt_force(i)
         end associate
      end do
   end function placed_bolts

   !> Place the bolts, make the pattern if the coupled blocks have changed, and set the matrix entry
   !> of each contact
   pure subroutine couple_blocks(model, blocks, contacts, equations, spring)
      type(limerick_model_t), intent(in) :: model
      type(limerick_blocks_t), intent(in) :: blocks
      type(contact_list_t), intent(in) :: contacts  !! Contacts, sorted by pairs of blocks
      type(limerick_equations_t), intent(inout) :: equations
      !> Springs of the contacts; their entries are set: (at least contacts%n)
      type(contact_spring_t), intent(inout) :: spring(:)
      integer :: pair(2, contacts%n + size(blocks%bolt_force)), c, n
      logical :: same

      n = 0
      do c = 1, contacts%n
         associate (block => contacts%item(c)%block)
            if (n > 0) then
               same = all(pair(:, n) == [minval(block), maxval(block)])
            else
               same = .false.
            end if
            if (.not. same) then
               n = n + 1
               pair(:, n) = [minval(block), maxval(block)]
            end if
         end associate
         spring(c)%entry = n
      end do
      equations%bolts = placed_bolts(model, blocks)
      do c = 1, size(equations%bolts%entry)
         associate (block => equations%bolts%equation(:, c))
            if (any(block == 0)) cycle
            n = n + 1
            equations%bolts%entry(c) = n
            pair(:, n) = [minval(block), maxval(block)]
         end associate
      end do
      same = allocated(equations%pair)
      if (same) same = size(equations%pair, 2) == n
      if (same) same = all(equations%pair == pair(:, :n))
      if (.not. same) then
         equations%pair = pair(:, :n)
         call set_pattern(equations%matrix, n_unknown, size(blocks%area), equations%pair)
         call plan_factor(equations%matrix, equations%factor)
      end if
      do c = 1, contacts%n
         spring(c)%first_is_row = equations%matrix%pair(1, spring(c)%entry) &
            & == contacts%item(c)%block(1)
      end do
   end subroutine couple_blocks

   !> Assemble inertia, elasticity, stress, weight, fixed and loaded points
   pure subroutine assemble_limerick(model, blocks, march, equations)
      type(limerick_model_t), intent(in) :: model
      type(limerick_blocks_t), intent(in) :: blocks
      type(limerick_march_t), intent(in) :: march  !! State of the run, with the time step
      !> The equations; base and load are set
      type(limerick_equations_t), intent(inout) :: equations
      real(wp) :: mass(n_unknown, n_unknown), rate
      integer :: b

      rate = 2.0_wp/march%time_step
      do b = 1, size(blocks%area)
         associate (material => model%material(model%block_material(b)))
            mass = mass_matrix(material%density, blocks%area(b), blocks%second(:, b))
            equations%base(:, :, b) = rate/march%time_step*mass &
               & + elastic_matrix(material%material_t, blocks%area(b))
            equations%load(:, b) = stress_load(blocks%stress(:, b), blocks%area(b))
            equations%load(1:2, b) = equations%load(1:2, b) &
               & + material%unit_weight*blocks%area(b)*model%load_direction
            if (model%constants%dynamic) equations%load(:, b) = equations%load(:, b) &
               & + rate*matmul(mass, blocks%velocity(:, b))
         end associate
      end do
      call add_points(model, blocks, march, equations)
      call add_bars(equations%bolts, 1.0_wp, equations%base, equations%load)
   end subroutine assemble_limerick

   !> Add springs that return the fixed points to their positions, and forces at the load points
   pure subroutine add_points(model, blocks, march, equations)
      type(limerick_model_t), intent(in) :: model
      type(limerick_blocks_t), intent(in) :: blocks
      type(limerick_march_t), intent(in) :: march
      type(limerick_equations_t), intent(inout) :: equations
      real(wp) :: row(n_unknown), axis(2)
      integer :: b, i, k

      do i = 1, size(model%boundary%held)
         b = model%boundary%held(i)%block
         do k = 1, 2
            axis = 0.0_wp
            axis(k) = 1.0_wp
            row = point_load(axis, blocks%fixed_point(:, i), blocks%centroid(:, b))
            call add_outer(march%fixed_stiffness, row, row, equations%base(:, :, b))
            equations%load(:, b) = equations%load(:, b) &
               & - march%fixed_stiffness*blocks%fixed_drift(k, i)*row
         end do
      end do
      do i = 1, size(model%boundary%loaded)
         b = model%boundary%loaded(i)%block
         equations%load(:, b) = equations%load(:, b) &
            & + point_load(force_at(model, i, march%time + march%time_step), &
            & blocks%load_point(:, i), blocks%centroid(:, b))
      end do
   end subroutine add_points

   !> Matrix and right-hand side with the springs and friction of the contacts, by their states
   pure subroutine add_contacts(model, contacts, spring, march, first_pass, equations)
      type(limerick_model_t), intent(in) :: model
      type(contact_list_t), intent(in) :: contacts
      type(contact_spring_t), intent(in) :: spring(:)
      type(limerick_march_t), intent(in) :: march
      logical, intent(in) :: first_pass  !! True for the first solution of this step
      !> The equations; matrix and motion are set
      type(limerick_equations_t), intent(inout) :: equations
      real(wp) :: damper
      integer :: c

      ! a damper resists the mean speed of a step; static steps have no speed at either end
      damper = 0.0_wp
      if (model%constants%dynamic) damper = model%constants%contact_damping/march%time_step
      equations%matrix%diagonal = equations%base
      equations%matrix%coupling = 0.0_wp
      call couple_bars(equations%bolts, equations%matrix%pair, equations%matrix%coupling)
      equations%motion = equations%load
      do c = 1, contacts%n
         associate (contact => contacts%item(c))
            select case (contact%state)
            case (limerick_state%open)
               cycle
            case (limerick_state%second_line)
               call add_spring(contact, spring(c), march%penalty, damper, &
                  & spring(c)%normal(:, :, 2), spring(c)%gap(2), equations)
            case default
               call add_spring(contact, spring(c), march%penalty, damper, &
                  & spring(c)%normal(:, :, 1), spring(c)%gap(1), equations)
            end select
            if (contact%corner) cycle
            if (contact%state == limerick_state%locked) then
               call add_spring(contact, spring(c), &
                  & march%penalty/model%constants%stiffness_ratio, damper, &
                  & spring(c)%along, spring(c)%shear, equations)
            else if (first_pass .or. contact%before /= limerick_state%open) then
               call add_friction(model, contact, spring(c), march%used_penalty, equations%motion)
            end if
         end associate
      end do
   end subroutine add_contacts

   !> Add one spring between two blocks with a parallel damper (Ke 1995)
   pure subroutine add_spring(contact, spring, stiffness, damper, row, start, equations)
      type(limerick_contact_t), intent(in) :: contact
      type(contact_spring_t), intent(in) :: spring  !! Springs of the contact, with its matrix entry
      real(wp), intent(in) :: stiffness             !! Stiffness [N/m2]
      real(wp), intent(in) :: damper  !! Force of the damper over its elongation in the step [N/m2]
      real(wp), intent(in) :: row(:, :)  !! Length of the spring per unknown: (6, 2)
      real(wp), intent(in) :: start      !! Its length at the beginning of the step [m]
      type(limerick_equations_t), intent(inout) :: equations
      real(wp) :: both

      both = stiffness + damper
      associate (a => contact%block(1), b => contact%block(2), matrix => equations%matrix)
         call add_outer(both, row(:, 1), row(:, 1), matrix%diagonal(:, :, a))
         call add_outer(both, row(:, 2), row(:, 2), matrix%diagonal(:, :, b))
         if (spring%first_is_row) then
            call add_outer(both, row(:, 1), row(:, 2), matrix%coupling(:, :, spring%entry))
         else
            call add_outer(both, row(:, 2), row(:, 1), matrix%coupling(:, :, spring%entry))
         end if
         equations%motion(:, a) = equations%motion(:, a) - stiffness*start*row(:, 1)
         equations%motion(:, b) = equations%motion(:, b) - stiffness*start*row(:, 2)
      end associate
   end subroutine add_spring

   !> Add a multiple of the outer product of two vectors
   pure subroutine add_outer(factor, column, row, sum)
      real(wp), intent(in) :: factor                        !! Factor
      real(wp), intent(in) :: column(n_unknown)             !! First vector: (6)
      real(wp), intent(in) :: row(n_unknown)                !! Second vector: (6)
      real(wp), intent(inout) :: sum(n_unknown, n_unknown)  !! Matrix, incremented here: (6, 6)
      integer :: j

      do j = 1, n_unknown
         sum(:, j) = sum(:, j) + (factor*row(j))*column
      end do
   end subroutine add_outer

   !> Friction of a sliding contact opposite to its last slip, from the last penetration
   pure subroutine add_friction(model, contact, spring, penalty, load)
      type(limerick_model_t), intent(in) :: model
      type(limerick_contact_t), intent(in) :: contact
      type(contact_spring_t), intent(in) :: spring
      real(wp), intent(in) :: penalty  !! Stiffness of the contacts in the last solution [N/m2]
      real(wp), intent(inout) :: load(:, :)  !! Right-hand side: (6, n_block)
      real(wp) :: friction

      if (.not. abs(contact%shear) > 0.0_wp) return
      associate (law => contact_law(model, contact%block(1), contact%vertex(3, 1)))
         friction = max(0.0_wp, -contact%gap)*penalty*law%friction
         if (contact%bonded) friction = friction + law%cohesion*contact%length
      end associate
      friction = sign(friction, contact%shear)
      load(:, contact%block(1)) = load(:, contact%block(1)) - friction*spring%along(:, 1)
      load(:, contact%block(2)) = load(:, contact%block(2)) + friction*spring%drag
   end subroutine add_friction

end module dda_limerick_assembly
