!> What is read, checked and locked before a deck is run
submodule (dda_verbs:dda_run) dda_run_start
   use dda_binary_file, only : binary_file_t, close_binary, descriptor_of, open_binary
   use dda_error, only : fatal_error
   use dda_screen, only : end_watch, terminal_watch_t
   use dda_read_deck, only : read_deck
   use dda_scene, only : scene_t
   use dda_scene_check, only : check_scene
   use dda_table_file, only : remove_file
   implicit none

   !> C's LOCK_EX and LOCK_NB: alone, and without waiting
   integer(c_int), parameter :: alone = 2, at_once = 4

contains

   !> Read a deck, and check that its scene can be run
   module procedure read_and_check
      type(scene_t) :: scene
      type(terminal_watch_t) :: watch

      watch%shown = error_is_terminal() .and. .not. command%quiet
      call read_deck(name_of(command, number), command%setting, deck, error, watch, &
         & command%cases, command%tight)
      if (.not. allocated(error)) call check_scene(deck, scene, error, watch)
      call end_watch(watch)
   end procedure read_and_check

   !> No two decks may write into the same folder
   module procedure check_folder
      integer :: i

      do i = 1, number - 1
         if (.not. good(i) .or. folder_of(command, name_of(command, i)) &
            & /= folder_of(command, name_of(command, number))) cycle
         call fatal_error(error, "expected a deck with a folder of its own, got "// &
            & folder_of(command, name_of(command, i))//", to which "//name_of(command, i)// &
            & " writes too; rename one deck", name_of(command, number), 1)
         return
      end do
   end procedure check_folder

   !> Take a folder for the rest of the program
   module procedure lock_folder
      character(len=:), allocatable :: file
      type(binary_file_t) :: held

      file = folder//"/run.lock"
      call open_binary(file, held, error, keep=.true.)
      if (allocated(error)) return
      if (is_locked(held)) return
      if (has_locks(file)) then
         call fatal_error(error, "expected a folder that no other run or deck writes to, got "// &
            & "one in use; choose another folder with --out, or wait for that run to end", file, 1)
      else if (.not. quiet) then
         write (error_unit, "(a)") file//":1: warning: this file system knows no locks: "// &
            & "nothing keeps another run from writing to "//folder
      end if
   end procedure lock_folder

   !> Lock an open file, if nobody else has
   logical function is_locked(file)
      !> The file; stays locked until it is closed, at the end of the program
      type(binary_file_t), intent(in) :: file
      integer(c_int) :: failed

      failed = c_flock(int(descriptor_of(file), c_int), ior(alone, at_once))
      is_locked = failed == 0
   end function is_locked

   !> Whether files of a folder can be locked at all: one that nobody else knows of must
   logical function has_locks(file)
      character(len=*), intent(in) :: file  !! Name of the file that could not be locked
      character(len=:), allocatable :: name
      type(binary_file_t) :: probe
      type(error_t), allocatable :: error

      name = file//"."//to_text(int(c_getpid()))
      call open_binary(name, probe, error)
      has_locks = .true.
      if (allocated(error)) return
      has_locks = is_locked(probe)
      call close_binary(probe, error)
      call remove_file(name)
   end function has_locks

   !> Folder that a deck's results go to
   module procedure folder_of
      folder = deck_stem(name)
      if (.not. allocated(command%out)) return
      if (size(command%name) == 1) then
         folder = command%out
      else
         folder = command%out//"/"//folder
      end if
   end procedure folder_of

end submodule dda_run_start
