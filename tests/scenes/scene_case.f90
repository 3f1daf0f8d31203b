!> Cases of decks: read, computed and told as `dda run` does it
module scene_case
   use dda_case, only : case_t, prepare_case
   use dda_case_rows, only : tell_case
   use dda_compute_case, only : compute_case
   use dda_deck, only : deck_t
   use dda_deck_sweep, only : turn_to_case
   use dda_error, only : error_t
   use dda_read_deck, only : read_deck
   use dda_scene, only : scene_t
   use dda_scene_check, only : check_scene
   use dda_write_tables, only : told_blocks_t
   use dda_write_results, only : joint_row_t, result_row_t
   use scene_deck, only : lines_of
   implicit none
   private

   public :: told_t, tell

   !> What is told of a case
   type :: told_t
      !> The case, computed
      type(case_t) :: this
      !> Its row of results.csv; `refused` is the verdict of what cannot be read
      type(result_row_t) :: row
      !> Its rows of joints.csv
      type(joint_row_t), allocatable :: joint(:)
      !> Its rows of blocks.csv
      type(told_blocks_t) :: blocks
      !> What stands beside it; why it was refused
      character(len=:), allocatable :: remark
   end type told_t

contains

   !> Compute the first case of a deck
   subroutine tell(groups, told, blocks)
      !> Lines of the deck, parted by |
      character(len=*), intent(in) :: groups
      type(told_t), intent(out) :: told
      !> Lines of its file of blocks, likewise
      character(len=*), intent(in), optional :: blocks
      character(len=*), parameter :: name = "scene_case"
      character(len=:), allocatable :: head
      character(len=1) :: none(0)
      type(deck_t) :: deck, work
      type(error_t), allocatable :: error
      type(scene_t) :: scene

      head = ""
      if (present(blocks)) then
         head = "&scene kind = 'blocks', geometry = '"//name//".blocks' /"//new_line("a")
         call write_text(name//".blocks", lines_of(blocks)//new_line("a"))
      end if
      call write_text(name//".nml", head//lines_of(groups)//new_line("a"))
      call read_deck(name//".nml", none, deck, error)
      if (.not. allocated(error)) call check_scene(deck, scene, error)
      if (.not. allocated(error)) call turn_to_case(deck, 1, work, error)
      if (allocated(error)) then
         told%row%verdict = "refused"
         told%remark = error%message
         return
      end if
      call prepare_case(work, told%this)
      call compute_case(told%this)
      call tell_case(told%this, told%row, told%joint, told%blocks, told%remark)
   end subroutine tell

   !> Write a text to a file
   subroutine write_text(file, text)
      character(len=*), intent(in) :: file
      character(len=*), intent(in) :: text
      integer :: unit

      open (newunit=unit, file=file, access="stream", form="unformatted", status="replace")
      write (unit) text
      close (unit)
   end subroutine write_text
end module scene_case
