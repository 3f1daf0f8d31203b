!> Rows of energy.csv: the energy balance of a dynamic run
module dda_write_energy
   use dda_growing_text, only : add_line, growing_text_t, lines_of
   use dda_kinds, only : wp
   use dda_text, only : to_text
   implicit none
   private

   public :: energy_header, energy_lines

contains

   !> Names of the columns
   pure function energy_header() result(line)
      !> The line
      character(len=:), allocatable :: line

      line = "case,step,time,kinetic,elastic,contact,gravity,work,friction,damping,impact,numerical"
   end function energy_header

   !> Rows of one case
   pure function energy_lines(number, value) result(lines)
      !> Number of the case
      integer, intent(in) :: number
      !> Time and energies after each step, as the columns have them: (10, n_step) [s, J per metre]
      real(wp), intent(in) :: value(:, :)
      !> The rows
      character(len=:), allocatable :: lines
      type(growing_text_t) :: text
      character(len=:), allocatable :: line
      integer :: i, k

      do k = 1, size(value, 2)
         line = to_text(number)//","//to_text(k)
         do i = 1, size(value, 1)
            line = line//","//to_text(value(i, k))
         end do
         call add_line(text, line)
      end do
      lines = lines_of(text)
   end function energy_lines
end module dda_write_energy
