!> The load of least factor among many live loads
!>
!> The loads lie on arcs along which they are quadratic in a share of the way. A mechanism of one
!> load gives the power of all others on it, and so a load with a smaller factor. That none has been
!> missed is proven by forces, arc by arc: the loads of an arc lie within the triangle of its ends
!> and the point where its tangents meet, and forces that carry these three carry all of them.
submodule (dda_compute_case) dda_worst_load
   use dda_limit_decision, only : decide_load, load_decision_t, load_state
   use dda_limit_load, only : begin_walk, find_limit, limit_load_t, limit_state, load_walk_t, &
      & walk_to
   implicit none

   !> Working data of a search
   type :: chase_t
      type(joint_graph_t) :: graph         !! The joints
      real(wp), allocatable :: dead(:, :)  !! Loads at a factor of zero: (3, n_block) [N/m, N/m, N]
      integer :: missed = 0                !! Loads without a limit, before one was found
      real(wp) :: near = 0.0_wp            !! Arcs shorter than this are not halved [m]
      !> True if each load is carried at the least factor so far, or has its own limit found
      logical :: is_last = .false.
      type(load_walk_t) :: walk            !! Forces that go from load to load
   end type chase_t

   !> Relative gap of a limit
   real(wp), parameter :: gap = 1.0e-9_wp
   !> Relative difference of a smaller factor
   real(wp), parameter :: smaller = 1.0e-7_wp
   !> Difference below which loads are equal, over the largest
   real(wp), parameter :: same = 1.0e-7_wp
   !> So many loads without a limit, and none with one, are undecided
   integer, parameter :: most_missed = 8

contains

   !> Seek the least factor of the loads of all arcs
   module procedure seek_least_factor
      type(chase_t) :: chase
      type(load_decision_t) :: decision
      integer :: k, stride

      chase%graph = graph
      chase%dead = dead
      if (.not. stands) then
         call decide_load(graph, dead, decision)
         if (decision%state == load_state%falls) then
            least%factor = 0.0_wp
            least%place = 0.5_wp*(arc(1)%from + arc(size(arc))%to)
            return
         end if
      end if
      chase%near = near
      stride = size(arc)
      do while (least%factor >= no_limit .and. stride > 0 .and. least%is_known)
         stride = stride/2
         do k = max(1, stride), size(arc), 2*max(1, stride)
            call descend(arc, k, 0.5_wp, chase, least)
            if (least%factor < no_limit .or. .not. least%is_known) exit
         end do
      end do
      do k = 1, size(arc)
         call find_bounded(arc, k, 0.0_wp, 1.0_wp, chase, least)
      end do
      if (least%factor >= no_limit .or. .not. least%is_known) return
      call begin_walk(graph, dead, chase%walk)
      chase%is_last = .true.
      do k = 1, size(arc)
         if (.not. goes_on(arc, k)) call pass(arc, k, 0.0_wp, chase, least)
         call pass(arc, k, 1.0_wp, chase, least)
         call pass_between(arc, k, 0.0_wp, 1.0_wp, chase, least)
      end do
   end procedure seek_least_factor

   !> True if an arc begins with the load that the arc before ends with
   pure logical function goes_on(arc, k)
      type(load_arc_t), intent(in) :: arc(:)
      integer, intent(in) :: k  !! Number of the arc
      real(wp), allocatable :: load(:, :)
      integer :: i, n

      goes_on = .false.
      if (k == 1) return
      n = max(maxval(arc(k)%block), maxval(arc(k - 1)%block))
      allocate (load(3, n), source=0.0_wp)
      call add_live([-1.0_wp, 0.0_wp, 0.0_wp], arc(k), load)
      call add_live([0.0_wp, 0.0_wp, 1.0_wp], arc(k - 1), load)
      do i = 1, 3
         if (maxval(abs(load(i, :))) > same*maxval(abs(arc(k)%load(i, :, 1)))) return
      end do
      goes_on = .true.
   end function goes_on

   !> Find a load of an arc that not every factor carries, if no other was found. Loads that every
   !> factor carries are a cone: a piece has none if its ends and the load in which its tangents
   !> meet are in it
   pure recursive subroutine find_bounded(arc, k, from, to, chase, least)
      type(load_arc_t), intent(in) :: arc(:)
      integer, intent(in) :: k
      real(wp), intent(in) :: from, to  !! Shares of the way along it
      type(chase_t), intent(inout) :: chase
      type(least_factor_t), intent(inout) :: least
      type(limit_load_t) :: limit
      real(wp) :: live(3, size(chase%dead, 2)), middle

      if (size(arc(k)%block) == 0) return
      middle = 0.5_wp*(from + to)
      if (.not. least%is_known) return
      if (least%factor >= no_limit) call descend(arc, k, from, chase, least)
      if (least%factor >= no_limit) call descend(arc, k, to, chase, least)
      if (least%factor >= no_limit) call descend(arc, k, middle, chase, least)
      if (least%factor < no_limit .or. (to - from)*(arc(k)%to - arc(k)%from) <= chase%near) return
      live = 0.0_wp
      call add_live(2.0_wp*weights(middle) - 0.5_wp*(weights(from) + weights(to)), arc(k), live)
      call find_limit(chase%graph, chase%dead, live, gap, limit, stands=.true.)
      if (limit%state == limit_state%not_converged) least%is_known = .false.
      if (limit%state /= limit_state%found) return
      call find_bounded(arc, k, from, middle, chase, least)
      call find_bounded(arc, k, middle, to, chase, least)
   end subroutine find_bounded

   !> Pass a load: carry it at the least factor so far, or go down from it
   pure subroutine pass(arc, k, share, chase, least)
      type(load_arc_t), intent(in) :: arc(:)
      integer, intent(in) :: k
      real(wp), intent(in) :: share  !! Share of the way along it
      type(chase_t), intent(inout) :: chase
      type(least_factor_t), intent(inout) :: least
      logical :: carried

      if (.not. least%is_known) return
      call carry(arc(k), weights(share), least%factor, chase, carried)
      if (.not. carried) call descend(arc, k, share, chase, least)
   end subroutine pass

   !> Pass the loads between two of an arc that are passed
   pure recursive subroutine pass_between(arc, k, from, to, chase, least)
      type(load_arc_t), intent(in) :: arc(:)
      integer, intent(in) :: k
      real(wp), intent(in) :: from, to
      type(chase_t), intent(inout) :: chase
      type(least_factor_t), intent(inout) :: least
      real(wp) :: middle
      logical :: carried

      if (.not. least%is_known) return
      middle = 0.5_wp*(from + to)
      call carry(arc(k), 2.0_wp*weights(middle) - 0.5_wp*(weights(from) + weights(to)), &
         & least%factor, chase, carried)
      if (carried .or. (to - from)*(arc(k)%to - arc(k)%from) <= chase%near) return
      if (to - from < 1.0_wp) then
         call pass(arc, k, middle, chase, least)
      else
         ! so near to the least its own least is sought
         call descend(arc, k, middle, chase, least)
      end if
      call pass_between(arc, k, from, middle, chase, least)
      call pass_between(arc, k, middle, to, chase, least)
   end subroutine pass_between

   !> True if a load of an arc is carried at a factor less a small share of it
   pure subroutine carry(arc, weight, factor, chase, carried)
      type(load_arc_t), intent(in) :: arc
      real(wp), intent(in) :: weight(3)  !! Shares of its three loads
      real(wp), intent(in) :: factor     !! The factor
      type(chase_t), intent(inout) :: chase
      logical, intent(out) :: carried    !! True if it is
      real(wp) :: load(3, size(chase%dead, 2))
      integer :: state

      load = chase%dead
      call add_live((1.0_wp - smaller)*factor*weight, arc, load)
      call walk_to(load, chase%walk, state)
      carried = state == load_state%stands
   end subroutine carry

   !> The factor of a load of an arc; then that of the load with most power on its mechanism, if the
   !> mechanism lets that load be carried at less than the least so far, and so on
   pure subroutine descend(arc, k, share, chase, least)
      type(load_arc_t), intent(in) :: arc(:)
      integer, intent(in) :: k
      real(wp), intent(in) :: share
      type(chase_t), intent(inout) :: chase
      type(least_factor_t), intent(inout) :: least
      type(limit_load_t) :: limit
      real(wp) :: live(3, size(chase%dead, 2)), at, power
      integer :: i

      i = k
      at = share
      do
         live = 0.0_wp
         call add_live(weights(at), arc(i), live)
         if (.not. maxval(abs(live)) > 0.0_wp) return
         call find_limit(chase%graph, chase%dead, live, gap, limit, stands=.true.)
         if (limit%state == limit_state%not_converged) then
            ! where no limit is found at so many places none will be; at the end each one matters
            if (least%factor >= no_limit) chase%missed = chase%missed + 1
            least%is_known = chase%missed < most_missed .and. .not. (chase%is_last &
               & .and. limit%lower < (1.0_wp - smaller)*least%factor)
         end if
         if (limit%state /= limit_state%found) return
         if (0.5_wp*(limit%lower + limit%upper) < least%factor) then
            least%factor = 0.5_wp*(limit%lower + limit%upper)
            least%place = arc(i)%from + at*(arc(i)%to - arc(i)%from)
         end if
         power = sum(live*limit%velocity(1:3, :))*limit%upper/least%factor
         call find_most_power(arc, limit%velocity, (1.0_wp + 2.0_wp*gap)*power, i, at)
         if (i == 0) return
      end do
   end subroutine descend

   !> The load of all arcs with most power on a mechanism
   pure subroutine find_most_power(arc, velocity, least, k, share)
      type(load_arc_t), intent(in) :: arc(:)
      real(wp), intent(in) :: velocity(:, :)  !! Velocities of the mechanism: (3, n_block)
      real(wp), intent(in) :: least           !! Power that it must have more than
      integer, intent(out) :: k               !! Number of its arc; 0 where none has
      real(wp), intent(out) :: share
      real(wp) :: most, power(3), place(3), slope, bend
      integer :: i, j

      most = least
      k = 0
      share = 0.0_wp
      do i = 1, size(arc)
         do j = 1, 3
            power(j) = sum(arc(i)%load(:, :, j)*velocity(1:3, arc(i)%block))
         end do
         slope = 4.0_wp*power(2) - 3.0_wp*power(1) - power(3)
         bend = 2.0_wp*(power(1) - 2.0_wp*power(2) + power(3))
         place = [0.0_wp, 0.5_wp, 1.0_wp]
         if (bend < 0.0_wp) place(2) = min(1.0_wp, max(0.0_wp, -0.5_wp*slope/bend))
         do j = 1, 3
            if (.not. power(1) + place(j)*(slope + place(j)*bend) > most) cycle
            most = power(1) + place(j)*(slope + place(j)*bend)
            k = i
            share = place(j)
         end do
      end do
   end subroutine find_most_power

   !> Add a load of an arc to others
   pure subroutine add_live(weight, arc, load)
      real(wp), intent(in) :: weight(3)  !! Factors of its three loads
      type(load_arc_t), intent(in) :: arc
      !> Loads, to which its are added: (3, n_block) [N/m, N/m, N]
      real(wp), intent(inout) :: load(:, :)
      integer :: i, j

      do j = 1, 3
         do i = 1, size(arc%block)
            load(:, arc%block(i)) = load(:, arc%block(i)) + weight(j)*arc%load(:, i, j)
         end do
      end do
   end subroutine add_live

   !> Shares of the three loads of an arc in that at a share of the way
   pure function weights(share)
      real(wp), intent(in) :: share
      real(wp) :: weights(3)  !! Shares of the loads

      weights = [(1.0_wp - share)*(1.0_wp - 2.0_wp*share), 4.0_wp*share*(1.0_wp - share), &
         & share*(2.0_wp*share - 1.0_wp)]
   end function weights

end submodule dda_worst_load
