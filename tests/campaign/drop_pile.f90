!> Drops a pile of bricks and watches every step: energy, entry, rest
!>
!>    drop_pile columns=25 rows=20 seed=1 n_dof=3 friction=0.6 restitution=0 duration=4
program drop_pile
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use dda_kinds, only : wp
   use dda_scene, only : scene_t
   use scene_pile, only : pile_scene, pile_t, record_t, watch_step
   use dda_settings, only : verdict
   implicit none
   type(pile_t) :: pile
   type(scene_t) :: scene
   type(record_t) :: record
   real(wp) :: now, start
   logical :: ended

   call read_arguments(pile)
   scene = pile_scene(pile)
   call cpu_time(start)
   ended = .false.
   do while (.not. ended)
      call watch_step(scene, record, ended)
      if (modulo(record%march%steps, 100) == 0 .or. ended) call tell()
   end do
   if (record%verdict == verdict%completed) stop
   write (error_unit, "(a)") record%reason
   stop 1

contains

   !> One line of figures
   subroutine tell()
      call cpu_time(now)
      associate (march => record%march)
         write (output_unit, "(a,i0,a,f7.4,4(a,es9.2),2(a,i0),a,f8.1)") "step ", march%steps, &
            & " time ", march%time, " kinetic ", march%energy%kinetic, " peak ", record%peak, &
            & " rise/fall ", record%rise/record%fall, " entry/brick ", &
            & record%entry/minval(pile%brick), " joints ", size(scene%contacts%joint), &
            & " factorisations ", record%factorisations, " cpu ", now - start
      end associate
      flush (output_unit)
   end subroutine tell

   !> Arguments of the form name=value
   subroutine read_arguments(pile)
      !> What is dropped
      type(pile_t), intent(inout) :: pile
      character(len=200) :: argument, line
      integer :: i, status
      integer :: columns, rows, seed, n_dof
      real(wp) :: brick(2), spread, friction, restitution, time_step, duration
      logical :: walls
      namelist /pile_of/ columns, rows, seed, n_dof, brick, spread, friction, restitution, &
         & time_step, duration, walls

      columns = pile%columns
      rows = pile%rows
      seed = pile%seed
      n_dof = pile%n_dof
      brick = pile%brick
      spread = pile%spread
      friction = pile%friction
      restitution = pile%restitution
      time_step = pile%time_step
      duration = pile%duration
      walls = pile%walls
      do i = 1, command_argument_count()
         call get_command_argument(i, argument)
         line = "&pile_of "//trim(argument)//" /"
         read (line, nml=pile_of, iostat=status)
         if (status == 0) cycle
         write (error_unit, "(2a)") "cannot read ", trim(argument)
         stop 2
      end do
      pile = pile_t(columns, rows, seed, n_dof, brick, spread, friction, restitution, time_step, &
         & duration, walls)
   end subroutine read_arguments
end program drop_pile
