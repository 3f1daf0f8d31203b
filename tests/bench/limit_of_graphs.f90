!> Limits of joint graphs that are read from the standard input, and decisions around them
!>
!> A graph is what Assembly.text of tests/bench/assembly.py writes. A line of output is its name,
!> blocks, joints, state, lower and upper factor, cone violation, factorisations,
!> milliseconds, then for each share of the limit state and factorisations of the
!> decision, the worst figure of what proves them, and the milliseconds of the slowest.
program limit_of_graphs
   use, intrinsic :: iso_fortran_env, only : int64, iostat_end
   use dda_joint_graph, only : joint_graph_t
   use dda_kinds, only : wp
   use dda_limit_decision, only : decide_load, load_decision_t
   use dda_limit_load, only : find_limit, limit_load_t, limit_state
   use graph_shapes, only : new_graph
   implicit none
   real(wp), parameter :: share(9) = [0.5_wp, 0.9_wp, 0.99_wp, 1.0_wp - 1.0e-6_wp, &
      & 1.0_wp + 1.0e-6_wp, 1.01_wp, 1.1_wp, 1.5_wp, 5.0_wp]
   type(joint_graph_t) :: graph
   real(wp), allocatable :: dead(:, :), live(:, :)
   character(80) :: name
   logical :: ended

   do
      call read_graph(graph, dead, live, name, ended)
      if (ended) exit
      call report(graph, dead, live, trim(name))
   end do

contains

   !> The next graph
   subroutine read_graph(graph, dead, live, name, ended)
      type(joint_graph_t), intent(out) :: graph
      !> Loads at factor zero, what a factor of one adds: (3, n_block)
      real(wp), allocatable, intent(out) :: dead(:, :), live(:, :)
      character(*), intent(out) :: name  !! Its name
      logical, intent(out) :: ended      !! True if there is none
      integer :: b, j, n_block, n_joint, status

      read (*, *, iostat=status) n_block, n_joint, name
      ended = status == iostat_end
      if (ended) return
      call new_graph(n_block, n_joint, graph)
      allocate (dead(3, n_block), live(3, n_block))
      do b = 1, n_block
         read (*, *) dead(:, b), live(:, b)
      end do
      do j = 1, n_joint
         read (*, *) graph%block(:, j), graph%kind(j), graph%friction(j), graph%length(j), &
            & graph%row(:, :, :, j)
      end do
   end subroutine read_graph

   !> Limit and decisions of one graph
   subroutine report(graph, dead, live, name)
      type(joint_graph_t), intent(in) :: graph
      !> Loads at factor zero, what a factor of one adds: (3, n_block)
      real(wp), intent(in) :: dead(:, :), live(:, :)
      character(*), intent(in) :: name  !! Name of the graph
      type(limit_load_t) :: limit
      type(load_decision_t) :: decision
      integer(int64) :: start, finish, rate
      integer :: state(size(share)), count(size(share)), i
      real(wp) :: took, slowest, worst

      call system_clock(start, rate)
      call find_limit(graph, dead, live, 1.0e-10_wp, limit)
      call system_clock(finish)
      took = 1.0e3_wp*real(finish - start, wp)/real(rate, wp)
      state = 0
      count = 0
      slowest = 0.0_wp
      worst = 0.0_wp
      do i = 1, size(share)
         if (limit%state /= limit_state%found) exit
         call system_clock(start)
         call decide_load(graph, dead + share(i)*limit%lower*live, decision)
         call system_clock(finish)
         slowest = max(slowest, 1.0e3_wp*real(finish - start, wp)/real(rate, wp))
         worst = max(worst, decision%imbalance, decision%violation)
         state(i) = decision%state
         count(i) = decision%n_factorisation
      end do
      print '(a, 3i5, 2es25.15e3, es9.1, i5, f10.3, 9(i3, i4), es9.1, f10.3)', name, &
         & graph%n_block, size(graph%kind), limit%state, limit%lower, limit%upper, &
         & limit%cone_violation, limit%n_factorisation, &
         & took, (state(i), count(i), i=1, size(share)), worst, slowest
   end subroutine report
end program limit_of_graphs
