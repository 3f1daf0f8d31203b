!> Forces carried from one load to another
!>
!> Of many loads most differ little from another one. Forces well inside the cones of all joints
!> that carry one load carry those near it after one correction, the smallest in units of the
!> distance of each force from its bound. For loads farther away the interior-point method follows,
!> which ends as soon as forces or velocities prove something.
!>
!>    A X X A' v = load + A x,    x - X X A' v >= 0
!>
!> A: arms of the rays, x: forces along them, X: their diagonal
submodule (dda_limit_load) dda_load_walk
   use dda_interior_turn, only : lift
   use dda_joint_rays, only : add_ray_forces, n_side
   use dda_joint_strips, only : bear_strips, see_strips
   use dda_limit_decision, only : begin_inside, go_on_to_load
   use dda_ray_matrix, only : set_springs, solve_springs
   implicit none

   !> Steps that draw forces away from their bounds where a load is carried, and the longest of them
   integer, parameter :: n_centring = 2
   real(wp), parameter :: most_of_way = 0.9_wp
   !> Stiffness of free rays over the mean of the others
   real(wp), parameter :: stiffness_of_free = 1.0e8_wp
   !> Gap at which an open walk ends
   real(wp), parameter :: resolution = 1.0e-8_wp
   !> Maximum number of solutions per correction
   integer, parameter :: most_turns = 4
   !> Residual of equilibrium over the largest load
   real(wp), parameter :: balanced = 1.0e-9_wp

contains

   !> Begin with an assembly
   module procedure begin_walk
      walk%unit = unit_of_force(load)
      if (crushes(graph)) then
         call add_strips(graph, walk%unit, walk%graph)
      else
         walk%graph = graph
      end if
      call bound_rays(walk%graph, walk%bounded, walk%free)
      call plan_matrix(walk%graph, walk%springs)
      allocate (walk%mass(3, 0:graph%n_block), source=0.0_wp)
   end procedure begin_walk

   !> Go on to a load
   module procedure walk_to
      type(interior_point_t) :: point
      real(wp) :: scaled(3, 0:walk%graph%n_block)
      logical :: carried

      call scale_load(load, walk%unit, walk%springs%length, scaled)
      state = load_state%stands
      if (allocated(walk%x)) then
         if (walk%springs%usable) then
            call try_correction(scaled, walk, carried)
            if (carried) return
         end if
         point%x = walk%x
         call go_on_to_load(walk%graph, scaled, resolution, walk%springs, point)
         state = state_at_end(point)
      end if
      if (.not. allocated(walk%x) .or. state == load_state%undecided) then
         ! forces that many loads have led near their bounds may lead no further
         call begin_inside(walk%graph, scaled, point)
         call go_on_to_load(walk%graph, scaled, resolution, walk%springs, point)
         state = state_at_end(point)
      end if
      if (state == load_state%stands) walk%x = point%x
      if (allocated(walk%x)) call centre(merge(n_centring, 0, state == load_state%stands &
         & .and. size(walk%springs%strip) == 0), size_of_load(scaled), walk)
   end procedure walk_to

   !> Carry the forces to a load by a correction, if possible
   pure subroutine try_correction(scaled, walk, carried)
      real(wp), intent(in) :: scaled(:, 0:)     !! The load in the units of the rays: (3, 0:n_block)
      type(load_walk_t), intent(inout) :: walk  !! The walk, whose springs are those of its forces
      logical, intent(out) :: carried           !! True if forces inside all bounds balance the load
      real(wp) :: motion(3, 0:walk%graph%n_block), rest(3, 0:walk%graph%n_block)
      real(wp) :: rate(n_side, size(walk%x, 2)), x(n_side, size(walk%x, 2))
      integer :: i, turn

      carried = .false.
      x = walk%x
      rest = scaled
      call add_ray_forces(walk%graph, walk%springs%length, x, rest)
      do turn = 1, most_turns
         call solve_springs(walk%graph, walk%springs, rest, motion, rate)
         x = x - walk%springs%stiffness*rate
         do i = 1, size(walk%springs%strip)
            x(:2, walk%springs%strip(i)%place) = bear_strips(walk%springs%strip(i), x)
         end do
         if (any(x*walk%bounded < 0.0_wp)) return
         rest = scaled
         call add_ray_forces(walk%graph, walk%springs%length, x, rest)
         carried = maxval(abs(rest)) <= balanced*maxval(abs(scaled))
         if (carried) return
      end do
   end subroutine try_correction

   !> Draw the forces away from their bounds, and factor the springs that measure their distance.
   !> Forces that hold one another could grow without end: none is drawn beyond a size
   pure subroutine centre(n_step, largest, walk)
      integer, intent(in) :: n_step    !! Steps
      real(wp), intent(in) :: largest  !! The size
      type(load_walk_t), intent(inout) :: walk
      real(wp) :: motion(3, 0:walk%graph%n_block), push(3, 0:walk%graph%n_block)
      real(wp) :: rate(n_side, size(walk%x, 2)), change(n_side, size(walk%x, 2))
      integer :: i

      do i = 0, n_step
         associate (x => walk%x, bounded => walk%bounded)
            walk%springs%stiffness = bounded*x**2 + walk%free*stiffness_of_free &
               & *sum(bounded*x**2)/real(max(1, count(bounded > 0)), wp)
            call see_strips(x, 1.0_wp/max(x, tiny(1.0_wp)), walk%springs%strip)
            call set_springs(walk%graph, walk%mass, lift, walk%springs)
            if (i == n_step .or. .not. walk%springs%usable) exit
            push = 0.0_wp
            change = x*bounded*(1.0_wp - x/largest)
            call add_ray_forces(walk%graph, walk%springs%length, change, push)
            call solve_springs(walk%graph, walk%springs, push, motion, rate)
            change = change - walk%springs%stiffness*rate
            x = x + min(1.0_wp, most_of_way/max(tiny(1.0_wp), maxval(-change*bounded &
               & /(x*bounded + (1.0_wp - bounded)))))*change
         end associate
      end do
   end subroutine centre

end submodule dda_load_walk
