!> Rows of energy.csv: the energy balance of a dynamic run
module dda_write_energy
   use dda_growing_text, only : add_line, fields, growing_text_t, lines_of
   use dda_kinds, only : wp
   use dda_text, only : to_text
   implicit none
   private

   public :: energy_header, energy_lines

   !> Names of the columns
   character(len=*), parameter :: energy_header = &
      & "case,step,time,kinetic,elastic,contact,gravity,work,friction,damping,impact,numerical"

contains

   !> Rows of one case
   pure function energy_lines(number, value) result(lines)
      !> Number of the case
      integer, intent(in) :: number
      !> Time and energies after each step, as the columns have them: (10, n_step) [s, J per metre]
      real(wp), intent(in) :: value(:, :)
      character(len=:), allocatable :: lines
      type(growing_text_t) :: text
      integer :: k

      do k = 1, size(value, 2)
         call add_line(text, to_text(number)//","//to_text(k)//","//fields(value(:, k)))
      end do
      lines = lines_of(text)
   end function energy_lines
end module dda_write_energy
