!> Cases of decks: read, computed and told as `dda run` does it
module scene_case
   use dda_case, only : case_t, prepare_case
   use dda_case_rows, only : tell_case
   use dda_compute_case, only : compute_case
   use dda_deck, only : deck_t
   use dda_deck_sweep, only : turn_to_case
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_read_deck, only : read_deck
   use dda_restart, only : save_restart
   use dda_scene, only : scene_t
   use dda_scene_check, only : check_scene
   use dda_write_results, only : joint_row_t, result_row_t, told_blocks_t
   use scene_deck, only : lines_of
   use scratch_folder, only : scratch, write_text
   implicit none
   private

   public :: told_t, tell, write_text

   !> What is told of a case
   type :: told_t
      !> Its row of results.csv; `refused` is the verdict of what cannot be read
      type(result_row_t) :: row
      type(joint_row_t), allocatable :: joint(:)  !! Its rows of joints.csv
      type(told_blocks_t) :: blocks               !! Its rows of blocks.csv
      character(len=:), allocatable :: remark     !! What stands beside it; why it was refused
      character(len=:), allocatable :: warnings   !! What its deck was warned of, parted by |
      !> Velocities of the blocks at the end of a decision: (n_dof, n_block)
      real(wp), allocatable :: velocity(:, :)
      real(wp), allocatable :: motion(:, :)  !! Motions of the blocks: (n_dof, n_block)
      real(wp), allocatable :: bar_force(:)  !! Forces of its bars: (n_bar) [N/m]
      integer :: pictures = 0                !! Number of its pictures
      !> How far corners have gone in the last of them: (2, n_vertex) [m]
      real(wp), allocatable :: seen(:, :)
      logical, allocatable :: absent(:)  !! True if blocks are taken away: (n_block)
   end type told_t

contains

   !> Compute the first case of a deck
   subroutine tell(groups, told, blocks, restart)
      character(len=*), intent(in) :: groups  !! Lines of the deck, parted by |
      !> What is told of it; begun anew here, for compilers write that out at each call otherwise
      type(told_t), intent(inout) :: told
      character(len=*), intent(in), optional :: blocks  !! Lines of its file of blocks, likewise
      !> File that receives the end of a run in time
      character(len=*), intent(in), optional :: restart
      character(len=*), parameter :: name = "scene_case"
      character(len=:), allocatable :: head
      character(len=1) :: none(0)
      type(case_t) :: this
      type(deck_t) :: deck
      type(deck_t), allocatable :: work
      type(error_t), allocatable :: error
      type(scene_t) :: scene
      integer :: i

      call begin_anew(told)
      head = ""
      if (present(blocks)) then
         head = "&scene kind = 'blocks', geometry = '"//name//".blocks' /"//new_line("a")
         call write_text(name//".blocks", lines_of(blocks)//new_line("a"))
      end if
      call write_text(name//".nml", head//lines_of(groups)//new_line("a"))
      call read_deck(scratch(name//".nml"), none, deck, error)
      if (.not. allocated(error)) call check_scene(deck, scene, error)
      if (allocated(deck%warnings%item)) then
         do i = 1, size(deck%warnings%item)
            told%warnings = told%warnings//deck%warnings%item(i)%message//"|"
         end do
      end if
      allocate (work)
      if (.not. allocated(error)) call turn_to_case(deck, 1, work, error)
      if (allocated(error)) then
         told%row%verdict = "refused"
         told%remark = error%message
         return
      end if
      call prepare_case(work, this)
      call compute_case(this)
      told%pictures = this%album%n
      if (told%pictures > 0) told%seen = this%album%frame(told%pictures)%moved - this%scene%system%vertex
      call tell_case(this, told%row, told%joint, told%blocks, told%remark)
      associate (system => this%decision%system)
         if (allocated(system%velocity)) told%velocity = system%velocity
         if (allocated(system%motion)) told%motion = system%motion
         if (allocated(system%bar)) told%bar_force = system%bar%force
         if (allocated(system%absent)) told%absent = system%absent
         if (present(restart)) call save_restart(scratch(restart), this%scene%settings, system, &
            & this%decision%contacts, this%onward, error)
      end associate
   end subroutine tell

   !> Forget what was told
   subroutine begin_anew(told)
      type(told_t), intent(out) :: told

      told%remark = ""
      told%warnings = ""
   end subroutine begin_anew
end module scene_case
