!> The least and the greatest thrust of a joint under the load of the assembly
!>
!> The thrust is the horizontal force in the joint, positive where it presses. A block without
!> weight is put between the joint and one of its blocks, tied to that block upright and against
!> turning alone: what goes through horizontally is a pair of forces on the two, a load factor, and
!> limit analysis finds its ends.
submodule (dda_limit_load) dda_thrust_range
   use dda_joint_graph, only : joint_kind
   implicit none

   !> Relative gap of the bounds of either end
   real(wp), parameter :: tolerance = 1.0e-10_wp
   !> Least horizontal component of a joint normal with a thrust
   real(wp), parameter :: least_normal = 1.0e-6_wp

contains

   !> The range of thrust of a joint
   module procedure find_thrust_range
      type(joint_graph_t) :: split
      type(limit_load_t) :: limit
      real(wp) :: dead(3, graph%n_block + 1), live(3, graph%n_block + 1), share(3), way, middle
      integer :: k, side

      known = .false.
      thrust = 0.0_wp
      side = merge(1, 2, graph%block(1, joint) > 0)
      share = graph%row(1, :, side, joint)
      if (.not. abs(share(1)) > least_normal) return
      way = sign(1.0_wp, share(1))
      middle = way*dot_product(share, force(:, joint))
      call split_graph(graph, joint, side, split)
      dead = 0.0_wp
      dead(:, :graph%n_block) = load
      live = 0.0_wp
      live(1, graph%n_block + 1) = -way
      live(1, graph%block(side, joint)) = way
      dead = dead + middle*live
      do k = 1, 2
         call find_limit(split, dead, merge(-1.0_wp, 1.0_wp, k == 1)*live, tolerance, limit, &
            & stands=.true.)
         known(k) = limit%state == limit_state%found
         if (known(k)) thrust(k) = middle &
            & + merge(-0.5_wp, 0.5_wp, k == 1)*(limit%lower + limit%upper)
      end do
   end procedure find_thrust_range

   !> The same joints, with a block without weight between one of them and one of its blocks
   pure subroutine split_graph(graph, joint, side, split)
      type(joint_graph_t), intent(in) :: graph
      integer, intent(in) :: joint
      integer, intent(in) :: side  !! Its block, 1 or 2, from which it is separated
      type(joint_graph_t), intent(out) :: split
      integer :: n

      n = size(graph%kind)
      split%n_block = graph%n_block + 1
      allocate (split%block(2, n + 1), split%kind(n + 1))
      allocate (split%row(3, 3, 2, n + 1), split%friction(n + 1), split%length(n + 1), &
         & source=0.0_wp)
      split%block(:, :n) = graph%block
      split%kind(:n) = graph%kind
      split%row(:, :, :, :n) = graph%row
      split%friction(:n) = graph%friction
      split%length(:n) = graph%length
      if (allocated(graph%crush)) split%crush = [graph%crush, huge(1.0_wp)]
      split%block(side, joint) = split%n_block
      split%kind(n + 1) = joint_kind%pin
      split%block(:, n + 1) = [graph%block(side, joint), split%n_block]
      split%row(2, 1, :, n + 1) = [-1.0_wp, 1.0_wp]
      split%row(3, 3, :, n + 1) = [-1.0_wp, 1.0_wp]
   end subroutine split_graph

end submodule dda_thrust_range
