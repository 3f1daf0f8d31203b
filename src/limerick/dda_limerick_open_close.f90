!> Open-close iteration of Shi's scheme (Shi: df18 to df22)
submodule (dda_limerick_step) dda_limerick_open_close
   use dda_block_factor, only : factorise, substitute
   use dda_deformation, only : displacement_matrix
   use dda_limerick_analysis, only : limerick_constants_t
   use dda_limerick_assembly, only : add_contacts
   use dda_limerick_contact, only : limerick_contact_t, place_shear_spring, projection
   use dda_limerick_model, only : contact_law
   use dda_material, only : joint_law_t
   implicit none

   !> Maximum number of iterations per attempt
   integer, parameter :: max_passes = 8
   !> Reverse slip that keeps a contact sliding, over the half size
   real(wp), parameter :: reversal = 1.0e-7_wp
   !> Friction coefficient (0.9 degrees) below which contacts never lock
   real(wp), parameter :: slippery = 0.0157092553236649_wp

contains

   !> Solve and update states until no contact opens or closes
   module procedure open_and_close
      integer :: pass, c

      settled = .false.
      associate (equations => run%equations, contacts => run%contacts, march => run%march)
         do pass = 1, max_passes
            call add_contacts(model, contacts, run%spring, march, first_pass, equations)
            call factorise(equations%matrix, equations%factor)
            if (.not. equations%factor%usable) return
            call substitute(equations%factor, equations%motion)
            first_pass = .false.
            march%passes = march%passes + 1
            ! the first solution of a run never counts as converged
            settled = march%passes > 1
            do c = 1, contacts%n
               associate (contact => contacts%item(c))
                  call judge_contact(model, run%blocks, equations%motion, march, contact, &
                     & run%spring(c))
                  if ((contact%state == limerick_state%open) &
                     & .neqv. (contact%before == limerick_state%open)) settled = .false.
               end associate
            end do
            march%used_penalty = march%penalty
            if (settled) return
         end do
      end associate
   end procedure open_and_close

   !> Update the state of one contact after a solution
   pure subroutine judge_contact(model, blocks, motion, march, contact, spring)
      type(limerick_model_t), intent(in) :: model
      type(limerick_blocks_t), intent(in) :: blocks
      real(wp), intent(in) :: motion(:, :)  !! Motion of the blocks: (6, n_block)
      type(limerick_march_t), intent(in) :: march
      type(limerick_contact_t), intent(inout) :: contact
      type(contact_spring_t), intent(inout) :: spring
      real(wp) :: gap(2)

      associate (a => motion(:, contact%block(1)), b => motion(:, contact%block(2)), &
         & law => contact_law(model, contact%block(1), contact%vertex(3, 1)))
         contact%before = contact%state
         gap(1) = spring%gap(1) + dot_product(spring%normal(:, 1, 1), a) &
            & + dot_product(spring%normal(:, 2, 1), b)
         gap(2) = gap(1)
         if (contact%corner) gap(2) = spring%gap(2) + dot_product(spring%normal(:, 1, 2), a) &
            & + dot_product(spring%normal(:, 2, 2), b)
         call judge_opening(model%constants, law, march, gap, contact)
         if (contact%corner .or. contact%state == limerick_state%open) return
         if (contact%before == limerick_state%open) &
            & call set_shear_spring(blocks, motion, march%half_size, contact, spring)
         call judge_slip(model%constants, law, march, spring%shear &
            & + dot_product(spring%along(:, 1), a) + dot_product(spring%along(:, 2), b), contact)
      end associate
   end subroutine judge_contact

   !> Set a contact open or closed; of two corners, at the line with less penetration
   pure subroutine judge_opening(constants, law, march, gap, contact)
      type(limerick_constants_t), intent(in) :: constants
      type(joint_law_t), intent(in) :: law
      type(limerick_march_t), intent(in) :: march
      real(wp), intent(in) :: gap(2)                      !! Opening at both lines: (2) [m]
      type(limerick_contact_t), intent(inout) :: contact  !! The contact; state and gap are set
      real(wp) :: sprung, held
      logical :: opens

      contact%state = merge(limerick_state%sliding, limerick_state%second_line, gap(1) >= gap(2))
      contact%gap = maxval(gap)
      if (contact%before == limerick_state%open) then
         opens = contact%gap > -constants%close_ratio*march%half_size
      else
         ! a closed contact is tested at the line of its spring
         sprung = gap(merge(2, 1, contact%before == limerick_state%second_line))
         held = 0.0_wp
         if (contact%bonded .and. .not. contact%corner) &
            & held = law%tension*contact%length/march%penalty
         opens = sprung > held + constants%open_ratio*march%half_size
      end if
      if (opens) contact%state = limerick_state%open
   end subroutine judge_opening

   !> Set a closed contact locked or sliding: by its strength if it has just closed or was locked,
   !> by the direction of slip if it was sliding
   pure subroutine judge_slip(constants, law, march, slip, contact)
      type(limerick_constants_t), intent(in) :: constants
      type(joint_law_t), intent(in) :: law
      type(limerick_march_t), intent(in) :: march
      real(wp), intent(in) :: slip  !! Slip since the shear spring was set [m]
      !> Closed contact of a vertex and an edge; state and slip are set
      type(limerick_contact_t), intent(inout) :: contact
      real(wp) :: last, strength
      logical :: locks

      last = contact%shear
      contact%shear = slip
      select case (contact%before)
      case (limerick_state%open)
         locks = abs(slip) < abs(law%friction*contact%gap)
      case (limerick_state%locked)
         strength = max(0.0_wp, -contact%gap)*law%friction
         if (contact%bonded) strength = strength + law%cohesion*contact%length/march%penalty
         locks = strength > abs(slip)/constants%stiffness_ratio
      case default
         locks = law%friction > slippery .and. abs(slip) > reversal*march%half_size &
            & .and. last*slip < 0.0_wp
      end select
      contact%state = merge(limerick_state%locked, limerick_state%sliding, locks)
   end subroutine judge_slip

   !> Set the shear spring of a closing contact at the point where the vertex meets the edge
   pure subroutine set_shear_spring(blocks, motion, half_size, contact, spring)
      type(limerick_blocks_t), intent(in) :: blocks
      real(wp), intent(in) :: motion(:, :)
      real(wp), intent(in) :: half_size                   !! Half the larger side of the model [m]
      type(limerick_contact_t), intent(inout) :: contact  !! The contact; its place is set
      type(contact_spring_t), intent(inout) :: spring     !! The springs; the shear spring is set
      real(wp) :: at(2, 3), share, closing
      integer :: k, b, v

      ! share of the step at zero opening
      closing = contact%gap - spring%gap(1)
      share = 0.0_wp
      if (spring%gap(1) >= 0.0_wp .and. &
         & abs(closing)*spring%edge_length >= 1.0e-9_wp*half_size**2) &
         & share = min(max(-spring%gap(1)/closing, 0.0_wp), 1.0_wp)
      do k = 1, 3
         v = contact%vertex(k, 1)
         b = blocks%owner(v)
         at(:, k) = blocks%vertex(:, v) + share*matmul( &
            & displacement_matrix(blocks%vertex(:, v), blocks%centroid(:, b)), motion(:, b))
      end do
      contact%place = projection(at(:, 1), at(:, 2), at(:, 3))
      call place_shear_spring(blocks, contact, spring)
   end subroutine set_shear_spring

end submodule dda_limerick_open_close
