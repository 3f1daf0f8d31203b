!> Traces of a joint set within a circle about the middle of the outline
!>
!> Joints are numbered from the anchor of the set outwards, each with its own random numbers. A
!> larger outline therefore adds joints without changing those of a smaller one.
submodule (dda_map_lines) dda_set_traces
   use dda_joint_map, only : length_law
   use dda_random, only : draw, draw_normal, new_random
   implicit none

   !> Number of generator seeds per seed of a set
   integer, parameter :: n_kind = 6
   !> Random streams per set, enough for both sides
   integer, parameter :: set_streams = 2000003
   !> Maximum number of joints on one side of the anchor
   integer, parameter :: most_joints = 1000000

   !> Axis of one joint
   type :: axis_t
      real(wp) :: along(2) = 0.0_wp   !! Unit vector along it: (2)
      real(wp) :: foot(2) = 0.0_wp    !! Point nearest to the anchor of the set: (2) [m]
      real(wp) :: window(2) = 0.0_wp  !! Start and end in the circle, from the foot: (2) [m]
   end type axis_t

contains

   !> Approximate number of joints of a set across a circle
   module procedure joint_count
      joint_count = 2.0_wp*radius/set%spacing%mean
      if (set%trace%mean > 0.0_wp) joint_count = joint_count*max(1.0_wp, &
         & 2.0_wp*radius/(set%trace%mean + set%bridge%mean))
   end procedure joint_count

   !> Traces of a set within a circle
   module procedure set_traces
      type(random_t) :: random
      real(wp) :: place(2), step, reach
      integer :: way, number

      allocate (trace(4, 64))
      n = 0
      call new_random(n_kind*set%seed(1), set_streams*set%seed(2), random)
      place = 0.0_wp
      if (.not. set%anchored) then
         call draw_covering_length(set%spacing, random, step)
         call draw(random, place(1))
         place = [-place(1)*step, step - place(1)*step]
      end if
      reach = norm2(centre - set%anchor) + radius
      do way = 1, 2
         call new_random(n_kind*set%seed(1) + way, set_streams*set%seed(2), random)
         number = 0
         do while (abs(place(way)) <= reach .and. number < most_joints)
            number = number + 1
            ! a joint through the anchor starts both sequences
            if (.not. (set%anchored .and. way == 2 .and. number == 1)) &
               & call add_joint(set, centre, radius, place(way), &
               & number*merge(1, -1, way == 2), trace, n)
            call draw_length(set%spacing, random, step)
            place(way) = place(way) + merge(step, -step, way == 2)
         end do
      end do
   end procedure set_traces

   !> Add the traces of one joint
   pure subroutine add_joint(set, centre, radius, distance, number, trace, n)
      type(joint_set_t), intent(in) :: set
      real(wp), intent(in) :: centre(2), radius
      !> Distance of the joint from the anchor, along the normal [m]
      real(wp), intent(in) :: distance
      integer, intent(in) :: number  !! Number of the joint, negative on one side
      !> Receives the traces: (4, n or more) [m]
      real(wp), allocatable, intent(inout) :: trace(:, :)
      integer, intent(inout) :: n
      type(random_t) :: random
      type(axis_t) :: axis
      real(wp) :: middle, half_chord, u, dip

      call new_random(n_kind*set%seed(1) + 3, set_streams*set%seed(2) + number, random)
      call draw(random, u)
      dip = set%dip + set%dip_spread*(2.0_wp*u - 1.0_wp)
      axis%along = [cos(dip), sin(dip)]
      axis%foot = set%anchor + distance*[-axis%along(2), axis%along(1)]
      middle = dot_product(centre - axis%foot, axis%along)
      half_chord = radius**2 - sum((axis%foot + middle*axis%along - centre)**2)
      if (half_chord <= 0.0_wp) return
      axis%window = middle + [-1.0_wp, 1.0_wp]*sqrt(half_chord)
      if (set%trace%mean > 0.0_wp) then
         call add_traces(set, axis, number, random, trace, n)
      else
         call add_part(axis, axis%window, trace, n)
      end if
   end subroutine add_joint

   !> Add traces and bridges from the foot of a joint outwards
   pure subroutine add_traces(set, axis, number, random, trace, n)
      type(joint_set_t), intent(in) :: set
      type(axis_t), intent(in) :: axis
      integer, intent(in) :: number
      type(random_t), intent(inout) :: random
      real(wp), allocatable, intent(inout) :: trace(:, :)
      integer, intent(inout) :: n
      type(random_t) :: outward
      real(wp) :: at(2), length, u
      logical :: first_is_trace, is_trace
      integer :: way

      call draw(random, u)
      first_is_trace = u*(set%trace%mean + set%bridge%mean) < set%trace%mean
      call draw_covering_length(part_law(set, first_is_trace), random, length)
      call draw(random, u)
      at = [-u*length, (1.0_wp - u)*length]
      if (first_is_trace) call add_part(axis, at, trace, n)
      do way = 1, 2
         call new_random(n_kind*set%seed(1) + 3 + way, set_streams*set%seed(2) + number, outward)
         is_trace = first_is_trace
         do while (merge(at(2) < axis%window(2), at(1) > axis%window(1), way == 2))
            is_trace = .not. is_trace
            call draw_length(part_law(set, is_trace), outward, length)
            if (way == 1) then
               if (is_trace) call add_part(axis, [at(1) - length, at(1)], trace, n)
               at(1) = at(1) - length
            else
               if (is_trace) call add_part(axis, [at(2), at(2) + length], trace, n)
               at(2) = at(2) + length
            end if
         end do
      end do
   end subroutine add_traces

   !> Distribution of traces or of bridges
   pure type(length_t) function part_law(set, is_trace)
      type(joint_set_t), intent(in) :: set
      logical, intent(in) :: is_trace  !! True for a trace, false for a bridge

      part_law = set%bridge
      if (is_trace) part_law = set%trace
   end function part_law

   !> Add the part of a joint between two positions, clipped to the window
   pure subroutine add_part(axis, part, trace, n)
      type(axis_t), intent(in) :: axis
      real(wp), intent(in) :: part(2)  !! Start and end of the part along the joint: (2) [m]
      real(wp), allocatable, intent(inout) :: trace(:, :)
      integer, intent(inout) :: n      !! Number of traces
      real(wp) :: from, to

      from = max(part(1), axis%window(1))
      to = min(part(2), axis%window(2))
      if (to <= from) return
      call make_room(trace, n + 1)
      n = n + 1
      trace(:, n) = [axis%foot + from*axis%along, axis%foot + to*axis%along]
   end subroutine add_part

   !> Random length with a given distribution
   module procedure draw_length
      real(wp) :: number

      value = length%mean
      select case (length%law)
      case (length_law%uniform)
         call draw(random, number)
         value = value*(1.0_wp + length%randomness*(2.0_wp*number - 1.0_wp))
      case (length_law%exponential)
         call draw(random, number)
         value = -value*log(number)
      case (length_law%normal)
         do
            call draw_normal(random, number)
            if (abs(length%randomness*number) < 1.0_wp) exit
         end do
         value = value*(1.0_wp + length%randomness*number)
      end select
   end procedure draw_length

   !> Random length of the piece that covers a given point
   module procedure draw_covering_length
      real(wp) :: more, number

      if (length%law == length_law%exponential) then
         call draw_length(length, random, value)
         call draw_length(length, random, more)
         value = value + more
         return
      end if
      do
         call draw_length(length, random, value)
         call draw(random, number)
         ! except for the exponential distribution, lengths are below twice the mean
         if (2.0_wp*length%mean*number <= value) exit
      end do
   end procedure draw_covering_length

end submodule dda_set_traces
