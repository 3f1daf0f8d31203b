!> The state of a run as a file, for a continuation that is equal to the last bit
!>
!> The file holds what a run cannot compute again: motions, velocities, stresses, joints with their
!> forces, and the march; everything else follows from the deck. Each number is checked on reading,
!> since a checksum does not prove its origin.
module dda_restart
   use, intrinsic :: iso_fortran_env, only : int32, int64
   use dda_binary_file, only : write_file
   use dda_block_system, only : block_system_t
   use dda_check_sum, only : crc_32
   use dda_contacts, only : contacts_t
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_settings, only : settings_t
   use dda_step_context, only : march_t
   use dda_table_file, only : part_name, rename_part
   use dda_text_file, only : read_bytes
   implicit none
   private

   public :: check_restart, load_restart, save_restart, write_numbers, read_numbers

   !> First bytes of the file; another layout needs another number
   character(len=*), parameter :: title = "voussoir restart 6"

   !> Integers of a file beside those of its joints: blocks, corners, unknowns per block, true if
   !> blocks move, true if joints are searched; joints, springs at restrained points, steps, passes,
   !> steps to spare for events
   integer, parameter :: n_count = 10
   !> Numbers of the march: time, length of the next step, energies with their time
   integer, parameter :: n_march = 12

   !> Contents of a file
   type :: state_t
      integer(int32) :: count(n_count) = 0  !! The whole numbers: (n_count)
      !> The joints as whole numbers: (n_joint_whole, n_joint)
      integer(int32), allocatable :: joint_whole(:, :)
      !> The joints as numbers: (n_joint_number, n_joint)
      real(wp), allocatable :: joint_number(:, :)
      real(wp), allocatable :: vertex(:, :)    !! Corners in the reference shape: (2, n_vertex) [m]
      real(wp), allocatable :: motion(:, :)    !! Motion of the blocks: (6, n_block)
      real(wp), allocatable :: velocity(:, :)  !! Rates of the same: (6, n_block)
      !> Mean strain rates and accelerations of the last step: (3, n_block)
      real(wp), allocatable :: strain_rate(:, :), acceleration(:, :)
      real(wp), allocatable :: stress(:, :)    !! Stress of the blocks: (3, n_block) [Pa]
      !> Reach of the blocks, zero where nothing is searched: (n_block) [m]
      real(wp), allocatable :: reach(:)
      real(wp), allocatable :: held_force(:)  !! Forces at restrained points: (n_spring) [N/m]
      real(wp) :: march(n_march) = 0.0_wp     !! The march: (n_march)
   end type state_t

   !> Upper limit of all numbers of a run
   real(wp), parameter :: beyond_all = 1.0e60_wp

   !> Whole numbers of a joint: contacts; of both contacts which block owns the edge, corner, edge,
   !> whether it is open; direction of sliding
   integer, parameter :: n_joint_whole = 12

   !> Numbers of a joint: length; of both contacts length, share, lock and height at which it is
   !> closed; past slip; trial force, force, gap and increment; share of strength of both contacts
   integer, parameter :: n_joint_number = 24

   interface

      !> Joints as numbers
      pure module subroutine pack_joints(contacts, whole, number)
         type(contacts_t), intent(in) :: contacts
         !> Their whole numbers: (n_joint_whole, n_joint)
         integer(int32), allocatable, intent(out) :: whole(:, :)
         !> Their numbers: (n_joint_number, n_joint)
         real(wp), allocatable, intent(out) :: number(:, :)
      end subroutine pack_joints

      !> Put the blocks where they were; where blocks move, their corners and stresses are made from
      !> their motion, as each step makes them
      pure module subroutine take_blocks(settings, state, system, fault)
         type(settings_t), intent(in) :: settings
         type(state_t), intent(in) :: state
         !> The blocks at their beginning in, where they were out
         type(block_system_t), intent(inout) :: system
         character(len=*), intent(inout) :: fault  !! Fault; unchanged if there is none
      end subroutine take_blocks

      !> The march of a file
      pure module subroutine take_march(settings, contacts, state, march, fault)
         type(settings_t), intent(in) :: settings
         type(contacts_t), intent(in) :: contacts
         type(state_t), intent(in) :: state
         type(march_t), intent(out) :: march
         character(len=*), intent(inout) :: fault
      end subroutine take_march

      !> Joints from numbers that are finite: found again where blocks move, given ones with their
      !> stored state
      pure module subroutine unpack_joints(settings, system, whole, number, contacts, sound)
         type(settings_t), intent(in) :: settings
         type(block_system_t), intent(in) :: system
         integer(int32), intent(in) :: whole(:, :)
         real(wp), intent(in) :: number(:, :)
         !> The contacts at their beginning in, with these joints out
         type(contacts_t), intent(inout) :: contacts
         !> True if the numbers are those of joints between the blocks
         logical, intent(out) :: sound
      end subroutine unpack_joints

   end interface

contains

   !> Write blocks, contacts and march at the end of a step
   subroutine save_restart(file, settings, system, contacts, march, error)
      character(len=*), intent(in) :: file  !! Name of the file
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      type(march_t), intent(in) :: march
      type(error_t), allocatable, intent(out) :: error
      integer(int32), allocatable :: joint_whole(:, :)
      real(wp), allocatable :: joint_number(:, :), held_force(:), reach(:)

      allocate (held_force(0))
      if (allocated(march%held_force)) held_force = march%held_force
      allocate (reach(size(system%area)), source=0.0_wp)
      if (allocated(march%reach)) reach = march%reach
      call pack_joints(contacts, joint_whole, joint_number)
      associate (e => march%energy, all => .true.)
         call write_numbers(file, title, [owner_of(settings, system, contacts), &
            & size(contacts%joint), size(held_force), march%steps, march%passes, &
            & march%spare_cuts, pack(joint_whole, all)], [pack(system%vertex, all), &
            & pack(system%motion, all), pack(system%velocity, all), &
            & pack(system%strain_rate, all), pack(system%acceleration, all), &
            & pack(system%stress, all), reach, held_force, &
            & march%time, march%dt, e%time, e%kinetic, e%elastic, e%contact, e%gravity, &
            & e%work, e%friction, e%damping, e%impact, e%numerical, &
            & pack(joint_number, all)], error)
      end associate
   end subroutine save_restart

   !> Put blocks, contacts and march into the state of a file
   subroutine load_restart(file, settings, system, contacts, march, error)
      character(len=*), intent(in) :: file
      type(settings_t), intent(in) :: settings
      !> The blocks at their beginning in, those of the file out
      type(block_system_t), intent(inout) :: system
      type(contacts_t), intent(inout) :: contacts
      type(march_t), intent(out) :: march
      !> Allocated if the file is missing, broken, of another scene or made up
      type(error_t), allocatable, intent(out) :: error
      integer(int64), parameter :: all_ones = int(z"7FF0000000000000", int64)
      type(state_t) :: state
      integer(int32), allocatable :: whole(:)
      real(wp), allocatable :: number(:)
      character(len=70) :: fault
      logical :: sound

      call read_numbers(file, title, whole, number, error)
      if (allocated(error)) return
      fault = ""
      call check_counts(settings, system, contacts, whole, size(number), fault)
      ! distinguished by the bits of infinity and NaN: a signalling NaN may not be touched
      if (fault == "" .and. any(iand(transfer(number, [0_int64]), all_ones) == all_ones)) &
         & fault = "numbers that are none"
      if (fault == "") call take_state(whole, number, state)
      if (fault == "") call take_blocks(settings, state, system, fault)
      if (fault == "") call take_march(settings, contacts, state, march, fault)
      if (fault == "") then
         sound = all(abs(state%joint_number) <= beyond_all)
         if (sound) call unpack_joints(settings, system, state%joint_whole, state%joint_number, &
            & contacts, sound)
         if (.not. sound) fault = "joints that these blocks cannot have"
      end if
      if (fault /= "") call fatal_error(error, "expected the end of a run of these blocks, got "// &
         & trim(fault)//"; write the file again", file, 1)
   end subroutine load_restart

   !> Check that a file is whole and a restart file, whatever its blocks
   subroutine check_restart(file, error)
      character(len=*), intent(in) :: file
      type(error_t), allocatable, intent(out) :: error
      integer(int32), allocatable :: whole(:)
      real(wp), allocatable :: number(:)

      call read_numbers(file, title, whole, number, error)
   end subroutine check_restart

   !> Numbers that a file and the run that continues it have in common
   pure function owner_of(settings, system, contacts) result(owner)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      integer(int32) :: owner(5)  !! The first of its whole numbers: (5)

      owner = [size(system%area), size(system%vertex, 2), settings%n_dof, &
         & merge(1, 0, settings%current), merge(1, 0, contacts%searched)]
   end function owner_of

   !> Check the owner and the lengths of a file
   pure subroutine check_counts(settings, system, contacts, whole, n_number, fault)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      integer(int32), intent(in) :: whole(:)  !! Whole numbers of the file: (:)
      integer, intent(in) :: n_number         !! Number of its other numbers
      character(len=*), intent(inout) :: fault  !! Fault; unchanged if there is none
      integer(int64) :: wanted(2)
      logical :: same(5)

      if (size(whole) < n_count) then
         fault = "too few numbers"
         return
      end if
      associate (n_block => int(whole(1), int64), n_vertex => int(whole(2), int64), &
         & n_joint => int(whole(6), int64))
         wanted = [n_count + n_joint_whole*n_joint, n_march + 22*n_block + 2*n_vertex &
            & + whole(7) + n_joint_number*n_joint]
      end associate
      same = whole(:5) == owner_of(settings, system, contacts)
      if (.not. all(same(:2))) then
         fault = "that of other blocks"
      else if (.not. all(same)) then
         fault = "that of a run with other unknowns or another geometry"
      else if (any(whole(6:n_count) < 0)) then
         fault = "counts below zero"
      else if (any(wanted /= [size(whole), n_number])) then
         fault = "counts that do not fit the length of the file"
      end if
   end subroutine check_counts

   !> The state that the numbers of a file make
   subroutine take_state(whole, number, state)
      integer(int32), intent(in) :: whole(:)
      real(wp), intent(in) :: number(:)  !! Its other numbers: (:)
      type(state_t), intent(out) :: state
      integer :: at

      state%count = whole(:n_count)
      at = 0
      associate (n_block => state%count(1), n_vertex => state%count(2), n_joint => state%count(6))
         state%joint_whole = reshape(whole(n_count + 1:), [n_joint_whole, n_joint])
         state%vertex = reshape(next(2*n_vertex), [2, n_vertex])
         state%motion = reshape(next(6*n_block), [6, n_block])
         state%velocity = reshape(next(6*n_block), [6, n_block])
         state%strain_rate = reshape(next(3*n_block), [3, n_block])
         state%acceleration = reshape(next(3*n_block), [3, n_block])
         state%stress = reshape(next(3*n_block), [3, n_block])
         state%reach = next(n_block)
         state%held_force = next(state%count(7))
         state%march = next(n_march)
         state%joint_number = reshape(next(n_joint_number*n_joint), [n_joint_number, n_joint])
      end associate

   contains

      !> The next numbers of the file
      function next(n) result(values)
         integer, intent(in) :: n  !! Number of them
         real(wp) :: values(n)     !! The numbers: (n)

         values = number(at + 1:at + n)
         at = at + n
      end function next
   end subroutine take_state

   !> Write a file of numbers in the machine's own form, after a checksum; a file of that name is
   !> replaced when the new one is complete
   subroutine write_numbers(file, title, whole, number, error)
      character(len=*), intent(in) :: file
      character(len=*), intent(in) :: title  !! Its first bytes, which identify its contents
      integer(int32), intent(in) :: whole(:)
      real(wp), intent(in) :: number(:)
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: bytes

      bytes = transfer([size(whole), size(number)], repeat(" ", 8)) &
         & //transfer(whole, repeat(" ", 4*size(whole))) &
         & //transfer(number, repeat(" ", 8*size(number)))
      ! before the numbers: behind them, the sum of the whole file would be the same for all files
      call write_file(part_name(file), title//transfer(crc_32(bytes), repeat(" ", 8))//bytes, error)
      if (.not. allocated(error)) call rename_part(file, error)
   end subroutine write_numbers

   !> Read a file of numbers that is whole
   subroutine read_numbers(file, title, whole, number, error)
      character(len=*), intent(in) :: file
      character(len=*), intent(in) :: title  !! Its required first bytes
      integer(int32), allocatable, intent(out) :: whole(:)
      real(wp), allocatable, intent(out) :: number(:)
      !> Allocated if it is missing, another file, or damaged
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: bytes
      type(error_t), allocatable :: failure
      integer(int32) :: n(2)
      integer :: at
      logical :: sound

      ! by C: two threads may read one file
      call read_bytes(file, bytes, failure)
      if (allocated(failure)) then
         call fatal_error(error, "the file cannot be read; check its name", file, 1)
      else if (index(bytes, title) /= 1) then
         call fatal_error(error, "expected a "//title//" file, got another one; write it again", &
            & file, 1)
      else
         n = -1
         at = len(title) + 16
         if (len(bytes) >= at) n = transfer(bytes(at - 7:), n)
         sound = all(n >= 0)
         if (sound) sound = len(bytes, int64) == at + 4*int(n(1), int64) + 8*int(n(2), int64)
         if (sound) then
            whole = transfer(bytes(at + 1:at + 4*n(1)), 0_int32, n(1))
            number = transfer(bytes(at + 4*n(1) + 1:), 0.0_wp, n(2))
            sound = transfer(bytes(at - 15:), 0_int64) == crc_32(bytes(at - 7:))
         end if
         if (.not. sound) call fatal_error(error, "expected a file as it was written, got a "// &
            & "damaged one; write it again", file, 1)
      end if
   end subroutine read_numbers

end module dda_restart
