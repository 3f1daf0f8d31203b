!> Rows of joints.csv that run from left to right
module dda_turned_rows
   use dda_block_system, only : block_system_t
   use dda_kinds, only : wp
   use dda_write_results, only : joint_row_t
   implicit none
   private

   public :: turn_rows

   !> Distance of centres along x that is none, over the width of all blocks
   real(wp), parameter :: same_place = 1.0e-9_wp

contains

   !> Turn joints of an arch whose first block is on the right, as at a left springing: their
   !> intrados and extrados become those of the arch
   pure subroutine turn_rows(system, row)
      type(block_system_t), intent(in) :: system  !! The blocks
      type(joint_row_t), intent(inout) :: row(:)  !! The rows: (n_joint)
      real(wp) :: width
      integer :: j

      if (size(row) == 0) return
      width = maxval(system%vertex(1, :)) - minval(system%vertex(1, :))
      do j = 1, size(row)
         associate (x => system%centroid(1, row(j)%block))
            if (x(2) < x(1) - same_place*width) call turn_row(row(j))
         end associate
      end do
   end subroutine turn_rows

   !> Take the second block of a joint for the first: shear and slip stay, as the way along the
   !> joint turns with them
   pure elemental subroutine turn_row(row)
      type(joint_row_t), intent(inout) :: row
      real(wp) :: extrados(2), opening

      extrados = row%intrados
      row%intrados = row%extrados
      row%extrados = extrados
      row%block = row%block([2, 1])
      row%force = -row%force
      row%slides%value = -row%slides%value
      row%eccentricity_ratio%value = -row%eccentricity_ratio%value
      row%state = other_end(row%state)
      row%mechanism = other_end(row%mechanism)
      if (.not. row%opening_extrados%known) return
      opening = row%opening_intrados
      row%opening_intrados = row%opening_extrados%value
      row%opening_extrados%value = opening
   end subroutine turn_row

   !> The hinge at the other end of a joint; any other word as it is
   pure elemental character(len=14) function other_end(word)
      character(len=14), intent(in) :: word  !! State or role of a joint

      other_end = word
      if (word == "hinge_intrados") other_end = "hinge_extrados"
      if (word == "hinge_extrados") other_end = "hinge_intrados"
   end function other_end
end module dda_turned_rows
