!> A static run along the path of its histories, and the pictures at its end
submodule (dda_forward) dda_path_run
   use dda_load_clock, only : goes_on_at, has_path
   implicit none

contains

   !> Let the clock of a static run go on where the blocks are at rest before the end of its path
   module procedure follow_path
      logical :: falls, returned

      if (.not. has_path(march%clock)) return
      if (allocated(rest)) then
         falls = allocated(error) .or. answer == verdict%collapsed .or. leaps(settings, march) &
            & .or. march%steps - march%begun >= settings%max_steps
         returned = .false.
         if (falls .or. .not. step%accepted) call return_to_rest(settings, rest, falls, system, &
            & contacts, equations, march, returned, album)
         if (returned) then
            answer = verdict%undecided
            if (allocated(error)) deallocate (error)
            return
         end if
      end if
      if (answer /= verdict%stable) return
      if (allocated(rest) .and. leaps(settings, march)) then
         march%jumps = march%jumps + 1
         march%largest_jump = max(march%largest_jump, march%moved)
      end if
      if (.not. goes_on_at(march%clock)) return
      answer = verdict%undecided
      call leave_rest(settings, system, contacts, equations, march, rest, album)
   end procedure follow_path

   !> Follow a collapse beyond its verdict as far as the album wants to see it
   module procedure end_pictures
      type(error_t), allocatable :: error

      if (outcome%verdict == verdict%collapsed .and. march%displacement < album%follow) &
         & outcome%fallen = contacts
      do while (allocated(outcome%fallen) .and. march%displacement < album%follow)
         if (march%steps == settings%max_steps) exit
         call next_interval(settings, system, step, march)
         call advance(settings, system, contacts, equations, march, step, error)
         if (allocated(error)) exit
         march%displacement = largest_displacement(system, settings%current)
         call keep_pictures(settings, system, contacts, march, step%farthest, .false., album)
      end do
      call keep_pictures(settings, system, contacts, march, step%farthest, .true., album)
   end procedure end_pictures

end submodule dda_path_run
