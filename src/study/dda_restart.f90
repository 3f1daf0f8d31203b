!> The state of a run as a file, from which it goes on to the last bit as if it had not been broken
module dda_restart
   use dda_block_system, only : block_system_t
   use dda_contact_detection, only : contacts_t, set_joints
   use dda_contact_types, only : joint_t
   use dda_error, only : error_t, fatal_error
   use dda_file_seal, only : seal_file, seal_holds
   use dda_kinds, only : wp
   use dda_settings, only : settings_t
   use dda_step_context, only : march_t
   implicit none
   private

   public :: check_restart, load_restart, save_restart

   !> First bytes of the file; another layout wants another number
   character(len=*), parameter :: magic = "voussoir restart 2"

contains

   !> Write blocks, contacts and march at the end of a step
   subroutine save_restart(file, system, contacts, march, error)
      !> Name of the file
      character(len=*), intent(in) :: file
      !> The blocks
      type(block_system_t), intent(in) :: system
      !> The contacts
      type(contacts_t), intent(in) :: contacts
      !> The march
      type(march_t), intent(in) :: march
      !> Allocated if it cannot be written
      type(error_t), allocatable, intent(out) :: error
      integer :: unit, stat
      character(len=200) :: reason

      open (newunit=unit, file=file, access="stream", form="unformatted", status="replace", &
         & action="readwrite", iostat=stat, iomsg=reason)
      if (stat == 0) write (unit, iostat=stat, iomsg=reason) magic, size(system%area), &
         & size(system%vertex, 2), size(contacts%joint), system%vertex, system%moved, &
         & system%motion, system%velocity, system%stress, system%initial_stress
      if (stat == 0) write (unit, iostat=stat, iomsg=reason) contacts%joint, contacts%face, &
         & contacts%trial, contacts%force, contacts%gap, contacts%increment, contacts%past_slip, &
         & contacts%broken, contacts%springs%stiffness, contacts%springs%cone, &
         & contacts%springs%shift
      if (stat == 0) write (unit, iostat=stat, iomsg=reason) march%steps, march%time, march%dt, &
         & march%allowed_motion, march%resolution, march%rounding, march%displacement, &
         & march%longest, march%elastic_motion, march%free_acceleration, march%last_acceleration, &
         & march%passes, march%energy, allocated(march%reach), allocated(march%last_motion), &
         & allocated(march%held_force)
      if (stat == 0 .and. allocated(march%reach)) &
         & write (unit, iostat=stat, iomsg=reason) march%reach
      if (stat == 0 .and. allocated(march%last_motion)) &
         & write (unit, iostat=stat, iomsg=reason) shape(march%last_motion), march%last_motion
      if (stat == 0 .and. allocated(march%held_force)) &
         & write (unit, iostat=stat, iomsg=reason) size(march%held_force), march%held_force
      if (stat == 0) call seal_file(unit, stat, reason)
      if (stat == 0) close (unit, iostat=stat, iomsg=reason)
      if (stat /= 0) call fatal_error(error, "the restart file cannot be written: "// &
         & trim(reason), file)
   end subroutine save_restart

   !> Put blocks, contacts and march into the state of a file
   subroutine load_restart(file, settings, system, contacts, march, error)
      !> Name of the file
      character(len=*), intent(in) :: file
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> The blocks at their beginning in, those of the file out
      type(block_system_t), intent(inout) :: system
      !> The contacts likewise
      type(contacts_t), intent(inout) :: contacts
      !> The march of the file
      type(march_t), intent(out) :: march
      !> Allocated if the file is missing, broken or of another scene
      type(error_t), allocatable, intent(out) :: error
      integer :: unit, stat, n_joint

      call open_restart(file, unit, error)
      if (allocated(error)) return
      call read_beginning(unit, file, system, n_joint, error)
      if (.not. allocated(error)) then
         call read_state(unit, n_joint, settings, system, contacts, stat)
         if (stat == 0) call read_march(unit, size(system%area), march, stat)
         if (stat /= 0) call fatal_error(error, "wanted a restart file of the same settings, "// &
            & "found one of others; make it anew", file, 1)
      end if
      close (unit)
   end subroutine load_restart

   !> Check that a run can go on from a file
   subroutine check_restart(file, system, error)
      !> Name of the file
      character(len=*), intent(in) :: file
      !> The blocks at their beginning; without them whose blocks the file tells of is not checked
      type(block_system_t), intent(in), optional :: system
      !> Allocated if the file is missing, broken or of other blocks
      type(error_t), allocatable, intent(out) :: error
      integer :: unit, n_joint

      call open_restart(file, unit, error)
      if (allocated(error)) return
      if (present(system)) call read_beginning(unit, file, system, n_joint, error)
      close (unit)
   end subroutine check_restart

   !> Open a file that is whole
   subroutine open_restart(file, unit, error)
      !> Name of the file
      character(len=*), intent(in) :: file
      !> Its unit, open unless there is an error
      integer, intent(out) :: unit
      !> Allocated if the file is missing or damaged
      type(error_t), allocatable, intent(out) :: error
      character(len=len(magic)) :: found
      integer :: stat

      open (newunit=unit, file=file, access="stream", form="unformatted", status="old", &
         & action="read", iostat=stat)
      if (stat /= 0) then
         call fatal_error(error, "wanted a restart file that can be read, found none; "// &
            & "check its name", file, 1)
         return
      end if
      found = ""
      read (unit, iostat=stat) found
      if (stat /= 0 .or. found /= magic) then
         call fatal_error(error, "wanted a restart file of this version, found another file; "// &
            & "make it anew", file, 1)
      else if (.not. seal_holds(unit)) then
         call fatal_error(error, "wanted a restart file as it was written, found a damaged one; " &
            & //"make it anew", file, 1)
      end if
      if (allocated(error)) close (unit)
   end subroutine open_restart

   !> Read the beginning of a file, which must tell of the same blocks
   subroutine read_beginning(unit, file, system, n_joint, error)
      !> Unit of the file; its state comes next afterwards
      integer, intent(in) :: unit
      !> Name of the file
      character(len=*), intent(in) :: file
      !> The blocks at their beginning
      type(block_system_t), intent(in) :: system
      !> Number of joints in the file
      integer, intent(out) :: n_joint
      !> Allocated if the file is that of other blocks
      type(error_t), allocatable, intent(inout) :: error
      character(len=len(magic)) :: found
      real(wp) :: vertex(2, size(system%vertex, 2))
      integer :: stat, n(2)

      rewind (unit)
      read (unit, iostat=stat) found, n, n_joint
      vertex = huge(vertex)
      if (all(n == [size(system%area), size(system%vertex, 2)])) read (unit, iostat=stat) vertex
      if (any(abs(vertex - system%vertex) > 0.0_wp)) &
         & call fatal_error(error, "wanted a restart file of these blocks, found one of other "// &
         & "blocks; check its name", file, 1)
   end subroutine read_beginning

   !> Read the march
   subroutine read_march(unit, n_block, march, stat)
      !> Unit of the file
      integer, intent(in) :: unit
      !> Number of blocks
      integer, intent(in) :: n_block
      !> Receives the march
      type(march_t), intent(inout) :: march
      !> 0 if all is well
      integer, intent(out) :: stat
      integer :: n(2)
      logical :: has(3)

      read (unit, iostat=stat) march%steps, march%time, march%dt, march%allowed_motion, &
         & march%resolution, march%rounding, march%displacement, march%longest, &
         & march%elastic_motion, march%free_acceleration, march%last_acceleration, march%passes, &
         & march%energy, has
      if (stat == 0 .and. has(1)) then
         allocate (march%reach(n_block))
         read (unit, iostat=stat) march%reach
      end if
      if (stat == 0 .and. has(2)) then
         read (unit, iostat=stat) n
         if (stat == 0) allocate (march%last_motion(n(1), n(2)))
         if (stat == 0) read (unit, iostat=stat) march%last_motion
      end if
      if (stat /= 0 .or. .not. has(3)) return
      read (unit, iostat=stat) n(1)
      if (stat == 0) allocate (march%held_force(n(1)))
      if (stat == 0) read (unit, iostat=stat) march%held_force
   end subroutine read_march

   !> Read the state of blocks and contacts
   subroutine read_state(unit, n_joint, settings, system, contacts, stat)
      !> Unit of the file
      integer, intent(in) :: unit
      !> Number of joints in the file
      integer, intent(in) :: n_joint
      !> Settings of the run
      type(settings_t), intent(in) :: settings
      !> Receives the blocks
      type(block_system_t), intent(inout) :: system
      !> Receives the contacts
      type(contacts_t), intent(inout) :: contacts
      !> 0 if all is well
      integer, intent(out) :: stat
      type(joint_t) :: joint(n_joint)
      real(wp) :: motion(6, size(system%area))

      read (unit, iostat=stat) system%moved, system%motion, system%velocity, system%stress, &
         & system%initial_stress
      if (stat == 0) read (unit, iostat=stat) joint
      if (stat /= 0) return
      motion = merge(1.0_wp, 0.0_wp, settings%current)*system%motion
      call set_joints(system, motion, joint, settings%penalty_ratio, settings%n_dof, contacts)
      read (unit, iostat=stat) contacts%face, contacts%trial, contacts%force, contacts%gap, &
         & contacts%increment, contacts%past_slip, contacts%broken, contacts%springs%stiffness, &
         & contacts%springs%cone, contacts%springs%shift
   end subroutine read_state
end module dda_restart
