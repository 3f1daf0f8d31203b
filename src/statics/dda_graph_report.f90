!> Blocks and contacts of a verdict of the joint graph
module dda_graph_report
   use dda_bar_joints, only : keep_bar_forces
   use dda_block_system, only : begin_motion, block_system_t
   use dda_boundary, only : value_at
   use dda_contact_types, only : joint_place_t, rows_of_joint
   use dda_contacts, only : begin_forces, contacts_t, joint_place
   use dda_coulomb_law, only : coulomb_state_t, face
   use dda_deformation, only : displacement_matrix
   use dda_joint_graph, only : breaks, joint_graph_t, joint_motion, rubs
   use dda_kinds, only : wp
   use dda_load_stations, only : last_history_time
   use dda_material, only : elasticity_matrix
   use dda_scene_graph, only : graph_verdict_t, scene_graph
   use dda_settings, only : factor_of, flow_rule, settings_t
   use dda_submatrices, only : point_load
   implicit none
   private

   public :: show_mechanism, show_state, strain_blocks

   !> Motion below which it is round-off, over the largest
   real(wp), parameter :: still = 1.0e-6_wp

contains

   !> Openings, slips and faces of the joints in a mechanism. Under the associated rule a joint that
   !> slides opens by its friction; what it opens beyond that is a hinge. A joint that crushes turns
   !> about the edge of its strip: one corner opens, and both press. A corner that has opened on the
   !> loading path is open whatever it does in the end
   pure subroutine show_mechanism(settings, system, verdict, contacts)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(graph_verdict_t), intent(in) :: verdict
      !> The contacts; their increments and faces are set
      type(contacts_t), intent(inout) :: contacts
      type(joint_graph_t) :: graph
      real(wp), allocatable :: rate(:, :)
      real(wp) :: dilatancy, least, pressed, share
      integer :: j

      call scene_graph(settings, system, contacts, graph)
      call begin_forces(contacts)
      if (allocated(verdict%state)) call keep_whole(verdict%state, contacts)
      allocate (rate(3, size(graph%kind)))
      call joint_motion(graph, verdict%mechanism, rate)
      contacts%increment = rate(:, :size(contacts%joint))
      if (allocated(verdict%force)) contacts%force = verdict%force(:, :size(contacts%joint))
      if (allocated(verdict%fall_force)) &
         & contacts%force = verdict%fall_force(:, :size(contacts%joint))
      ! a block that turns about its one corner moves, its joint does not
      least = still*max(maxval(abs(rate)), maxval(abs(verdict%mechanism(1:2, :))))
      ! what presses is closed, and moves by what the solution leaves
      share = 0.0_wp
      if (allocated(verdict%force)) share = least/still &
         & /max(maxval(abs(contacts%force)), tiny(1.0_wp))
      do j = 1, size(contacts%joint)
         dilatancy = 0.0_wp
         if (verdict%flow == flow_rule%associated) dilatancy = graph%friction(j)*abs(rate(3, j))
         pressed = 0.0_wp
         if (allocated(graph%crush)) then
            if (graph%crush(j) < huge(1.0_wp)) &
               & pressed = sum(contacts%force(1:2, j))**2/max(2.0_wp*graph%crush(j), tiny(pressed))
         end if
         contacts%face(j)%open = rate(1:2, j) - dilatancy &
            & > max(least, share*(contacts%force(1:2, j) - pressed))
         if (allocated(verdict%state)) contacts%face(j)%open = contacts%face(j)%open &
            & .or. verdict%state%gap(:, j) > still*maxval(abs(verdict%state%motion(1:2, :)))
         if (contacts%joint(j)%n_contact == 1) contacts%face(j)%open(2) = .true.
         contacts%face(j)%slip = 0
         if (abs(rate(3, j)) > least .and. .not. all(contacts%face(j)%open)) &
            & contacts%face(j)%slip = merge(-1, 1, rate(3, j) > 0.0_wp)
         contacts%gap(:, j) = merge(rate(:, j), 0.0_wp, [contacts%face(j)%open, &
            & contacts%face(j)%slip /= 0])
         ! interior points leave a trace of force there, and its friction
         where (contacts%face(j)%open) contacts%force(1:2, j) = pressed
         if (any(contacts%face(j)%open) .and. rubs(graph%kind(j), graph%friction(j)) &
            & .and. .not. breaks(graph)) call limit_shear(graph%friction(j), contacts%force(:, j))
         if (all(contacts%face(j)%open)) contacts%force(:, j) = 0.0_wp
      end do
   end subroutine show_mechanism

   !> Reduce a shear force to what the normal forces let friction carry
   pure subroutine limit_shear(friction, force)
      real(wp), intent(in) :: friction     !! Coefficient of friction
      real(wp), intent(inout) :: force(3)  !! N1, N2, T [N/m]

      force(3) = sign(min(abs(force(3)), friction*(force(1) + force(2))), force(3))
   end subroutine limit_shear

   !> Forces, openings and faces of the joints of what stands, and motion and strain of its blocks
   pure subroutine show_state(settings, verdict, system, contacts)
      type(settings_t), intent(in) :: settings
      type(graph_verdict_t), intent(in) :: verdict
      !> The blocks; their motions are set where they are known
      type(block_system_t), intent(inout) :: system
      type(contacts_t), intent(inout) :: contacts  !! The contacts; forces, gaps and faces are set
      real(wp), allocatable :: force(:, :)
      integer :: b, j, n

      call begin_motion(system)
      call begin_forces(contacts)
      n = size(contacts%joint)
      allocate (force(3, 0))
      if (allocated(verdict%force)) force = verdict%force
      if (allocated(verdict%state)) force = verdict%state%force
      if (size(force) == 0) return
      contacts%force = force(:, :n)
      call keep_bar_forces(settings, force, system)
      if (settings%n_dof == 6) call strain_blocks(settings, last_history_time(settings), &
         & contacts%force, force(:, n + 1:), contacts, system)
      if (.not. allocated(verdict%state)) return
      call keep_whole(verdict%state, contacts)
      associate (state => verdict%state)
         contacts%gap(1:2, :) = state%gap(:, :n)
         contacts%gap(3, :) = state%slip(:n)
         do j = 1, n
            contacts%face(j)%open = state%face(1:2, j) == face%open
            contacts%face(j)%slip = 0
            if (abs(state%face(3, j)) == face%slides) contacts%face(j)%slip = state%face(3, j)
         end do
         do b = 1, size(system%equation)
            if (system%equation(b) > 0) system%motion(:3, b) = state%motion(:3, system%equation(b))
         end do
      end associate
   end subroutine show_state

   !> Set the contacts that have kept their strength
   pure subroutine keep_whole(state, contacts)
      type(coulomb_state_t), intent(in) :: state
      type(contacts_t), intent(inout) :: contacts

      if (allocated(state%whole)) contacts%intact = merge(1.0_wp, 0.0_wp, &
         & state%whole(:, :size(contacts%joint)))
   end subroutine keep_whole

   !> Set strains and stresses of the blocks that can move: area*stress = moment of the forces
   pure subroutine strain_blocks(settings, time, force, pin_force, contacts, system)
      type(settings_t), intent(in) :: settings
      real(wp), intent(in) :: time         !! Time of the histories [s]
      real(wp), intent(in) :: force(:, :)  !! N1, N2, T of each joint: (3, n_joint) [N/m]
      !> Forces of the restrained points of blocks that can move, in their order: (3, n_pin) [N/m]
      real(wp), intent(in) :: pin_force(:, :)
      type(contacts_t), intent(in) :: contacts
      !> The blocks; their strains and stresses are set
      type(block_system_t), intent(inout) :: system
      real(wp), parameter :: no_motion(6) = 0.0_wp
      type(joint_place_t) :: place
      real(wp) :: moment(6, size(system%equation)), d(3, 3), stress(3)
      integer :: b, i, j, side

      moment = 0.0_wp
      do j = 1, size(force, 2)
         place = joint_place(system, contacts, j)
         do side = 1, 2
            b = contacts%joint(j)%block(side)
            moment(:, b) = moment(:, b) + matmul(rows_of_joint(contacts%joint(j), place, side, &
               & system%centroid(:, b), no_motion, 6), force(:, j))
         end do
      end do
      if (allocated(settings%boundary%loaded)) then
         do i = 1, size(settings%boundary%loaded)
            associate (loaded => settings%boundary%loaded(i))
               b = loaded%block
               moment(:, b) = moment(:, b) + point_load(factor_of(settings, loaded) &
                  & *value_at(loaded%force, time), loaded%point, system%centroid(:, b))
            end associate
         end do
      end if
      call add_pins(settings, pin_force, system, moment)
      do b = 1, size(system%equation)
         if (system%equation(b) == 0) cycle
         d = elasticity_matrix(system%materials(system%material(b)))
         stress = moment(4:6, b)/system%area(b)
         system%stress(:, b) = stress
         stress = stress - system%initial_stress(:, b)
         system%motion(4:5, b) = [d(2, 2)*stress(1) - d(1, 2)*stress(2), &
            & d(1, 1)*stress(2) - d(2, 1)*stress(1)]/(d(1, 1)*d(2, 2) - d(1, 2)*d(2, 1))
         system%motion(6, b) = stress(3)/d(3, 3)
      end do
   end subroutine strain_blocks

   !> Add the forces of restrained points; both forces act along a single restrained axis
   pure subroutine add_pins(settings, pin_force, system, moment)
      type(settings_t), intent(in) :: settings
      real(wp), intent(in) :: pin_force(:, :)
      type(block_system_t), intent(in) :: system
      real(wp), intent(inout) :: moment(:, :)  !! Forces on the unknowns of all blocks: (6, n_block)
      real(wp) :: t(2, 6)
      integer :: i, n

      if (.not. allocated(settings%boundary%held)) return
      n = 0
      do i = 1, size(settings%boundary%held)
         associate (held => settings%boundary%held(i), b => settings%boundary%held(i)%block)
            if (system%equation(b) == 0) cycle
            n = n + 1
            t = displacement_matrix(held%point, system%centroid(:, b))
            moment(:, b) = moment(:, b) &
               & + t(merge(1, 2, held%along(1)), :)*pin_force(1, n) &
               & + t(merge(2, 1, held%along(2)), :)*pin_force(3, n)
         end associate
      end do
   end subroutine add_pins
end module dda_graph_report
