!> The blocks of a case as a table: corners, how they are held, and how they move
module dda_told_blocks
   use dda_block_system, only : block_system_t
   use dda_deformation, only : displacement_matrix
   use dda_kinds, only : wp
   use dda_scene, only : scene_t
   use dda_write_tables, only : told_blocks_t
   implicit none
   private

   public :: scale_to_one, tell_blocks, tell_mechanism_motion, tell_total_motion

contains

   !> Tell the blocks as they are at the beginning
   pure subroutine tell_blocks(scene, blocks)
      type(scene_t), intent(in) :: scene
      !> The blocks, without displacements
      type(told_blocks_t), intent(out) :: blocks
      integer :: i

      associate (system => scene%system)
         allocate (blocks%first_vertex, source=system%first_vertex)
         allocate (blocks%corner, source=system%vertex)
         blocks%corner(1, :) = blocks%corner(1, :) + scene%origin(1)
         blocks%corner(2, :) = blocks%corner(2, :) + scene%origin(2)
         allocate (blocks%state(size(system%equation)))
         blocks%state = "free"
         if (allocated(scene%settings%boundary%held)) then
            do i = 1, size(scene%settings%boundary%held)
               blocks%state(scene%settings%boundary%held(i)%block) = "held"
            end do
         end if
         where (system%equation == 0) blocks%state = "fixed"
         if (allocated(system%absent)) then
            where (system%absent) blocks%state = ""
         end if
      end associate
   end subroutine tell_blocks

   !> A collapse mechanism: the motion of the last step, which has a shape but no size
   pure subroutine tell_mechanism_motion(system, motion, blocks)
      !> The blocks at the beginning
      type(block_system_t), intent(in) :: system
      !> Motion of the step: (n_dof, n_equation)
      real(wp), intent(in) :: motion(:, :)
      !> The blocks; displacements are set
      type(told_blocks_t), intent(inout) :: blocks
      real(wp) :: of_block(6, size(system%equation))
      integer :: b

      of_block = 0.0_wp
      do b = 1, size(system%equation)
         if (system%equation(b) > 0) of_block(:size(motion, 1), b) = motion(:, system%equation(b))
      end do
      blocks%displacement = small_displacements(system, of_block)
      call scale_to_one(blocks%displacement)
   end subroutine tell_mechanism_motion

   !> Scale a mechanism so that the largest displacement is 1
   pure subroutine scale_to_one(displacement)
      !> Displacements of all corners: (2, n_vertex)
      real(wp), intent(inout) :: displacement(:, :)
      real(wp) :: largest

      largest = maxval(norm2(displacement, dim=1))
      if (largest > 0.0_wp) displacement = displacement/largest
   end subroutine scale_to_one

   !> Displacements at the end of a run
   pure subroutine tell_total_motion(system, moves, blocks)
      type(block_system_t), intent(in) :: system
      !> Whether corners follow the motion; otherwise displacements are small
      logical, intent(in) :: moves
      type(told_blocks_t), intent(inout) :: blocks

      if (moves) then
         blocks%displacement = system%moved - system%vertex
      else
         blocks%displacement = small_displacements(system, system%motion)
      end if
   end subroutine tell_total_motion

   !> Displacements of all corners in a motion without second-order terms
   pure function small_displacements(system, motion) result(displacement)
      type(block_system_t), intent(in) :: system
      !> Motion of all blocks: (6, n_block)
      real(wp), intent(in) :: motion(:, :)
      !> The displacements: (2, n_vertex) [m]
      real(wp) :: displacement(2, size(system%vertex, 2))
      integer :: b, v

      do b = 1, size(system%equation)
         do v = system%first_vertex(b), system%first_vertex(b + 1) - 1
            displacement(:, v) = matmul( &
               & displacement_matrix(system%vertex(:, v), system%centroid(:, b)), motion(:, b))
         end do
      end do
   end function small_displacements
end module dda_told_blocks
