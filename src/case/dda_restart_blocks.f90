!> The blocks of a restart file, and what a run carries from step to step
submodule (dda_restart) dda_restart_blocks
   use dda_block_system, only : begin_motion
   use dda_block_update, only : displaced_blocks
   use dda_step_context, only : energy_t
   implicit none

   !> Larger than any displacement over the size of the model, any rotation and any strain
   real(wp), parameter :: far = 1.0e12_wp

   !> Longest reach over the width and height of a block: a step moves no corner by half as much
   real(wp), parameter :: longest_reach = 20.0_wp

   !> More passes than a run can have
   integer, parameter :: most_passes = 1000000000

   !> Shortest and longest step [s]
   real(wp), parameter :: shortest = 1.0e-40_wp, longest = 1.0e15_wp

   !> An edge that is left with this share of its length bounds no block
   real(wp), parameter :: least_edge = 1.0e-3_wp

contains

   !> Put the blocks where they were
   module procedure take_blocks
      real(wp) :: no_motion(settings%n_dof, maxval(system%equation)), size_of_all
      integer :: b

      no_motion = 0.0_wp
      size_of_all = maxval(maxval(system%vertex, dim=2) - minval(system%vertex, dim=2))
      if (any(abs(state%vertex - system%vertex) > 0.0_wp)) then
         fault = "that of other blocks"
      else if (any(abs(state%motion(1:2, :)) > far*size_of_all) &
         & .or. any(abs(state%motion(3:, :)) > far) .or. any(abs(state%velocity) > beyond_all) &
         & .or. any(abs(state%stress) > beyond_all)) then
         fault = "motions that no block has"
      end if
      do b = 1, size(system%equation)
         associate (corner => system%vertex(:, &
            & system%first_vertex(b):system%first_vertex(b + 1) - 1))
            if (state%reach(b) < 0.0_wp .or. state%reach(b) > longest_reach &
               & *sum(maxval(corner, dim=2) - minval(corner, dim=2))) &
               & fault = "search distances that no block has"
         end associate
         if (system%equation(b) > 0) cycle
         if (any(abs(state%motion(:, b)) > 0.0_wp) .or. any(abs(state%velocity(:, b)) > 0.0_wp)) &
            & fault = "fixed blocks that move"
      end do
      if (fault /= "") return
      call begin_motion(system)
      system%motion = state%motion
      system%velocity = state%velocity
      system%stress = state%stress
      if (.not. settings%current) return
      system = displaced_blocks(system, settings, no_motion)
      if (.not. are_blocks(system)) fault = "strains that leave no block"
   end procedure take_blocks

   !> Whether strain has left blocks their shapes: no edge is gone, none is turned inside out
   pure logical function are_blocks(system)
      type(block_system_t), intent(in) :: system
      integer :: b

      are_blocks = .true.
      do b = 1, size(system%equation)
         if (system%equation(b) == 0) cycle
         associate (first => system%first_vertex(b), last => system%first_vertex(b + 1) - 1, &
            & strain => system%motion(4:6, b))
            are_blocks = all(edge_lengths(system%moved(:, first:last)) &
               & > least_edge*edge_lengths(system%vertex(:, first:last))) &
               & .and. strain(1) > -1.0_wp .and. strain(2) > -1.0_wp &
               & .and. (1.0_wp + strain(1))*(1.0_wp + strain(2)) > strain(3)**2/4.0_wp
         end associate
         if (.not. are_blocks) return
      end do
   end function are_blocks

   !> Lengths of the edges of a polygon
   pure function edge_lengths(corner) result(length)
      real(wp), intent(in) :: corner(:, :)  !! Its corners: (2, n) [m]
      real(wp) :: length(size(corner, 2))   !! The lengths: (n) [m]

      length = norm2(cshift(corner, 1, dim=2) - corner, dim=1)
   end function edge_lengths

   !> The march of a file
   module procedure take_march
      march%steps = state%count(8)
      march%passes = state%count(9)
      march%time = state%march(1)
      march%dt = state%march(2)
      march%energy = energy_t(state%march(3), state%march(4), state%march(5), state%march(6), &
         & state%march(7), state%march(8), state%march(9), state%march(10), state%march(11), &
         & state%march(12))
      march%held_force = state%held_force
      if (contacts%searched .and. settings%current .and. march%steps > 0) march%reach = state%reach
      if (march%steps > 0 .and. (march%dt < shortest .or. march%dt > longest)) then
         fault = "a step of a length that no step has"
      else if (march%time < 0.0_wp .or. abs(march%time - march%energy%time) > 0.0_wp &
         & .or. march%passes > most_passes .or. any(abs(state%march) > beyond_all)) then
         fault = "a time or energies that no run has"
      else if (any(abs(state%held_force) > beyond_all)) then
         fault = "forces that no point has"
      end if
   end procedure take_march

end submodule dda_restart_blocks
