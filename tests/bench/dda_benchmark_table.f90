!> The figures of the benchmark as tables
module dda_benchmark_table
   use, intrinsic :: iso_fortran_env, only : compiler_version, output_unit
   use dda_benchmark, only : figures_t
   use dda_kinds, only : wp
   use dda_settings, only : verdict
   use dda_text, only : to_text
   implicit none
   private

   public :: print_tables, print_row, rounded, machine_line

   !> Characters of a cell
   integer, parameter :: cell = 14

contains

   !> Print day and machine, the figures, and the parts of a decision
   subroutine print_tables(figures, markdown)
      type(figures_t), intent(in) :: figures(:)  !! Figures, one number of voussoirs each: (n)
      logical, intent(in) :: markdown            !! Markdown instead of plain text
      integer :: i

      write (output_unit, "(a)") machine_line(), ""
      call print_row([character(len=cell) :: "voussoirs", "unknowns", "decision us", "right", &
         & "search us", "error", "decisions", "passes", "factorisations", "memory kB", &
         & "LAPACK us", "decision/LAP."], markdown, head=.true.)
      do i = 1, size(figures)
         call print_row(figure_cells(figures(i)), markdown, head=.false.)
      end do
      if (all(figures%unknowns == 3)) return
      write (output_unit, "(a)") ""
      call print_row([character(len=cell) :: "of a decision", "set up %", "assemble %", &
         & "fact., solve %", "judge, rest %", "factorisations", "us a factor."], markdown, &
         & head=.true.)
      do i = 1, size(figures)
         if (figures(i)%unknowns == 3) cycle
         call print_row(part_cells(figures(i)), markdown, head=.false.)
      end do
   end subroutine print_tables

   !> One line of the first table
   function figure_cells(figures) result(cells)
      type(figures_t), intent(in) :: figures
      character(len=cell) :: cells(12)  !! Text of each column: (12)

      associate (critical => figures%critical)
         cells = [character(len=cell) :: to_text(figures%voussoirs), &
            & to_text(figures%unknowns), microseconds(figures%decision), &
            & to_text(figures%right)//" of 4", &
            & microseconds(figures%search), small(figures%error), to_text(critical%decisions), &
            & to_text(critical%passes), to_text(critical%factorisations), "-", &
            & microseconds(figures%lapack), rounded(figures%ratio, 1)]
         if (figures%memory >= 0) cells(10) = to_text(figures%memory)
         if (critical%verdict /= verdict%found) cells(6) = "not found"
      end associate
   end function figure_cells

   !> One line of the second table
   function part_cells(figures) result(cells)
      type(figures_t), intent(in) :: figures
      character(len=cell) :: cells(7)  !! Text of each column: (7)
      integer :: i

      cells(1) = to_text(figures%voussoirs)
      do i = 1, size(figures%share)
         cells(1 + i) = rounded(100.0_wp*figures%share(i), 0)
      end do
      cells(6) = rounded(figures%factorisations, 2)
      cells(7) = microseconds(figures%decision/figures%factorisations)
   end function part_cells

   !> Print one line of a table
   subroutine print_row(cells, markdown, head)
      character(len=*), intent(in) :: cells(:)  !! Text of each column: (:)
      logical, intent(in) :: markdown           !! Markdown instead of plain text
      logical, intent(in) :: head               !! True if a rule follows
      integer :: i

      if (markdown) then
         write (output_unit, "(*(a))") "|", (" ", trim(cells(i)), " |", i=1, size(cells))
         if (head) write (output_unit, "(*(a))") "|", (" ---: |", i=1, size(cells))
      else
         write (output_unit, "(*(a, 1x))") (adjustr(cells(i)), i=1, size(cells))
         if (head) write (output_unit, "(a)") repeat("-", (len(cells) + 1)*size(cells) - 1)
      end if
   end subroutine print_row

   !> A time with at least three digits
   function microseconds(seconds) result(text)
      real(wp), intent(in) :: seconds        !! The time [s]
      character(len=:), allocatable :: text  !! The time in microseconds
      integer :: digits

      digits = 0
      if (seconds < 1.0e-4_wp) digits = 1
      if (seconds < 1.0e-5_wp) digits = 2
      text = rounded(1.0e6_wp*seconds, digits)
   end function microseconds

   !> A number with a fixed number of decimals
   function rounded(number, decimals) result(text)
      real(wp), intent(in) :: number  !! The number
      integer, intent(in) :: decimals  !! Digits after the point; without any there is no point
      character(len=:), allocatable :: text  !! The text
      character(len=40) :: buffer
      character(len=12) :: form

      write (form, "('(f40.', i0, ')')") decimals
      write (buffer, form) number
      text = trim(adjustl(buffer))
      if (decimals == 0) text = text(:len(text) - 1)
   end function rounded

   !> A number of which only the magnitude matters
   function small(number) result(text)
      real(wp), intent(in) :: number         !! The number
      character(len=:), allocatable :: text  !! The text
      character(len=12) :: buffer

      write (buffer, "(es9.1)") number
      text = trim(adjustl(buffer))
   end function small

   !> Day, processor and compiler
   function machine_line() result(line)
      character(len=:), allocatable :: line  !! The line
      character(len=8) :: day

      call date_and_time(date=day)
      line = day(:4)//"-"//day(5:6)//"-"//day(7:)//", "//processor()//", "//compiler_version()
   end function machine_line

   !> Number and kind of the processors, where the system tells it
   function processor() result(text)
      character(len=:), allocatable :: text  !! The text
      character(len=120) :: line
      integer :: cores, stat, unit

      text = "unknown processor"
      cores = 0
      open (newunit=unit, file="/proc/cpuinfo", action="read", status="old", iostat=stat)
      do while (stat == 0)
         read (unit, "(a)", iostat=stat) line
         if (stat /= 0) exit
         if (line(:9) == "processor") cores = cores + 1
         if (line(:10) == "model name") text = trim(adjustl(line(index(line, ":") + 1:)))
      end do
      if (cores == 0) return
      close (unit)
      text = to_text(cores)//" cores "//text
   end function processor
end module dda_benchmark_table
