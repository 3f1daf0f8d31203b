!> What was dropped while lines were cut into blocks, and why
module dda_cut_report
   use dda_kinds, only : wp
   implicit none
   private

   public :: cut_remark_t, cut_remarks_t, cut_reason, cut_reason_enum, add_remark

   !> Why a part of a line bounds no block
   type :: cut_reason_enum
      !> The line has no length
      integer :: point = 1
      !> The line meets fewer than two others
      integer :: loose_line = 2
      !> The part ends in nothing
      integer :: loose_edge = 3
      !> The part lies on a part of another line
      integer :: doubled = 4
      !> The part crosses another line although they have no node in common
      integer :: crossing = 5
      !> The part passes a node of other lines too closely
      integer :: too_close = 6
      !> The lines enclose a block without area
      integer :: flat = 7
   end type cut_reason_enum

   !> Names of the reasons
   type(cut_reason_enum), parameter :: cut_reason = cut_reason_enum()

   !> A part of a line that was dropped
   type :: cut_remark_t
      integer :: line = 0            !! Number of the line
      integer :: reason = 0          !! One of cut_reason
      integer :: other = 0           !! Number of the line that is in the way; 0 if none is
      real(wp) :: place(4) = 0.0_wp  !! Ends of the part, from the origin of the cut: (4) [m]
   end type cut_remark_t

   !> A list of remarks
   type :: cut_remarks_t
      integer :: n = 0                            !! How many there are
      type(cut_remark_t), allocatable :: item(:)  !! The remarks: (n or more)
   end type cut_remarks_t

contains

   !> Add a remark
   pure subroutine add_remark(remarks, line, reason, other, place)
      type(cut_remarks_t), intent(inout) :: remarks
      integer, intent(in) :: line       !! Number of the line
      integer, intent(in) :: reason     !! One of cut_reason
      integer, intent(in) :: other      !! Number of the line in the way, or 0
      real(wp), intent(in) :: place(4)  !! Ends of the part: (4) [m]

      if (.not. allocated(remarks%item)) allocate (remarks%item(16))
      ! the second half is room
      if (remarks%n == size(remarks%item)) remarks%item = [remarks%item, remarks%item]
      remarks%n = remarks%n + 1
      remarks%item(remarks%n) = cut_remark_t(line, reason, other, place)
   end subroutine add_remark
end module dda_cut_report
