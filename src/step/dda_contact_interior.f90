!> Contact forces of one group by an interior-point method
!>
!>    A d = load + R f,   gap + R' d + C (f - f0) = F_flow' z,   b = F f >= 0, z >= 0, b z = 0
!>
!> The rows of F are the distances from the bounds: n1, n2, bound + T and bound - T; those of F_flow
!> are n1, n2, T and -T: what slides does not open (Coulomb). The problem is not convex: with steep
!> friction, or where blocks are confined, the search need not come to an end, and the forces that
!> come nearest to the law count.
!>
!> With F in place of F_flow it is convex, and ends always: what slides opens by friction times its
!> slip, less an offset that is given (De Saxce; Acary and Cadoux). The nearer the offset to that
!> product, the nearer are the forces to Coulomb's law; whatever it is, they bring in no energy.
!>
!> C is far below what the blocks give, and f0 the force before: of all forces that stop the blocks
!> those nearest to it count, so that shear is remembered. Predictor and corrector by Mehrotra
!> (1992).
module dda_contact_interior
   use dda_contact_problem, only : admissible, contact_problem_t, move_blocks, openings, &
      & residual_of, residual_t
   use dda_contact_springs, only : factor_springs, lay_out, respond
   use dda_contact_types, only : unbounded
   use dda_contact_yield, only : force_of_flows, interior_search_t, iterate_t, &
      & set_yielding_springs, set_joint_step
   use dda_friction_cone, only : cone_kind
   use dda_kinds, only : wp
   use dda_spring_products, only : add_forces
   implicit none
   private

   public :: solve_convex, solve_interior

   !> Compliance of the regularisation over that of the blocks
   real(wp), parameter :: compliance = 1.0e-6_wp
   !> Maximum number of iterations
   integer, parameter :: most_turns = 30
   !> Maximum number of iterations of the convex problem
   integer, parameter :: max_convex_iterations = 60
   !> Iterations without progress before termination
   integer, parameter :: patience = 5
   !> Least initial distance from the bounds over a force, for known and unknown solutions
   real(wp), parameter :: near = 1.0e-2_wp, afar = 2.0e-1_wp
   !> Initial distance from the bounds for the convex problem
   real(wp), parameter :: convex_lift = 0.3_wp
   !> Largest initial distance for known solutions
   real(wp), parameter :: highest = 1.0e-1_wp
   !> Step below which the iteration is blocked by a bound
   real(wp), parameter :: stuck = 0.2_wp
   !> Step over the distance to the first bound
   real(wp), parameter :: share = 0.995_wp

contains

   !> Find forces from those at hand; better ones are kept
   pure subroutine solve_interior(p, tolerance, force, residual, passes)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: tolerance       !! Openings against the law that are left [m]
      real(wp), intent(inout) :: force(:, :)  !! Forces within their bounds: (3, n_joint) [N/m]
      type(residual_t), intent(inout) :: residual  !! Residual of the forces
      integer, intent(inout) :: passes        !! Factorisations so far
      type(interior_search_t) :: search
      type(iterate_t) :: z
      real(wp) :: gone, least, left
      integer :: turn, waited
      logical :: has_restarted

      call pose(p, force, search)
      call begin(p, search, force, near, z)
      least = huge(least)
      waited = 0
      gone = 0.0_wp
      has_restarted = .false.
      do turn = 1, most_turns
         call see_lack(p, z, search, left)
         call keep_better(p, admissible(p, z%force), force, residual)
         waited = merge(0, waited + 1, left < 0.9_wp*least)
         least = min(least, left)
         if (residual%opening <= tolerance .or. waited == patience &
            & .or. .not. left <= huge(left)) return
         if (turn > 1 .and. turn <= patience .and. gone < stuck .and. .not. has_restarted) then
            has_restarted = .true.
            call begin(p, search, force, afar, z)
            call see_lack(p, z, search, left)
            least = huge(least)
         end if
         call improve(p, search, z, gone)
         passes = passes + 1
         if (.not. search%springs%factor%usable) return
      end do
   end subroutine solve_interior

   !> Solve the convex problem whose offset follows from the slip of the given forces, and replace
   !> these. Its forces add no energy, however far they are from Coulomb's law
   pure subroutine solve_convex(p, tolerance, force, residual, passes)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: tolerance       !! What may be left of the problem, as an opening [m]
      real(wp), intent(inout) :: force(:, :)  !! Forces within their bounds: (3, n_joint) [N/m]
      type(residual_t), intent(inout) :: residual  !! Residual of the forces
      integer, intent(inout) :: passes        !! Factorisations so far
      type(interior_search_t) :: search
      type(iterate_t) :: z
      real(wp) :: gone, left, opening(3, size(p%joint))
      integer :: turn

      call pose(p, force, search)
      opening = openings(p, force, move_blocks(p, force))
      search%convex = .true.
      where (search%bounded(3, :)) search%offset = p%springs%cone%friction*abs(opening(3, :))
      call begin(p, search, force, convex_lift, z)
      do turn = 1, max_convex_iterations
         call see_lack(p, z, search, left)
         if (left <= tolerance .or. .not. left <= huge(left)) exit
         call improve(p, search, z, gone)
         passes = passes + 1
         if (.not. search%springs%factor%usable) return
      end do
      if (.not. left <= tolerance) return
      force = admissible(p, z%force)
      residual = residual_of(p, force, move_blocks(p, force))
   end subroutine solve_convex

   !> Keep the forces with the smaller residual
   pure subroutine keep_better(p, trial, force, residual)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: trial(:, :)          !! Other forces: (3, n_joint) [N/m]
      real(wp), intent(inout) :: force(:, :)       !! The best so far: (3, n_joint) [N/m]
      type(residual_t), intent(inout) :: residual  !! What these leave
      type(residual_t) :: left

      left = residual_of(p, trial, move_blocks(p, trial))
      if (.not. left%energy < residual%energy) return
      force = trial
      residual = left
   end subroutine keep_better

   !> What there is to search for
   pure subroutine pose(p, force, search)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: force(:, :)
      type(interior_search_t), intent(out) :: search
      integer :: i, k, n

      n = size(p%joint)
      call lay_out(p, search%springs)
      allocate (search%given(3, n), search%bounded(4, n))
      allocate (search%unit(3, n), search%soft(3, n), source=0.0_wp)
      allocate (search%balance, mold=p%load)
      allocate (search%offset(n), source=0.0_wp)
      allocate (search%opening(3, n), search%distance(4, n), search%product(4, n), source=0.0_wp)
      do i = 1, n
         do k = 1, 3
            search%unit(k, i) = p%give(k, k, i)
            search%given(k, i) = p%give(k, k, i) > 0.0_wp
         end do
         search%bounded(1:2, i) = search%given(1:2, i) .and. p%springs%shift(1:2, i) < unbounded
         search%bounded(3:4, i) = search%given(3, i) &
            & .and. p%springs%cone(i)%kind /= cone_kind%no_slip
      end do
      where (.not. search%given) search%unit = 1.0_wp
      where (.not. p%soft > 0.0_wp) search%soft = compliance*search%unit
      search%before = force
   end subroutine pose

   !> Where the search begins: forces and their motion, with distances and flows lifted off zero by
   !> the same product everywhere, but where one is larger
   pure subroutine begin(p, search, force, lift, z)
      type(contact_problem_t), intent(in) :: p
      type(interior_search_t), intent(in) :: search
      real(wp), intent(in) :: force(:, :)
      real(wp), intent(in) :: lift  !! By how much at the least, over the size of a force
      type(iterate_t), intent(out) :: z
      real(wp) :: flow, least, opening(3, size(p%joint)), typical, unit
      integer :: i, k

      z%force = force
      z%motion = move_blocks(p, force)
      z%slack = distances(p, force)
      opening = merge(openings(p, z%force, z%motion), 0.0_wp, search%given)
      ! size of a force, and the part of it by which forces are wrong
      associate (normal => search%given(1:2, :))
         typical = max(tiny(1.0_wp)/epsilon(1.0_wp), sum(max(z%slack(1:2, :), &
            & -opening(1:2, :)/search%unit(1:2, :)), normal .and. search%bounded(1:2, :)) &
            & /real(max(1, count(normal)), wp))
         least = sum(abs(min(z%slack(1:2, :), opening(1:2, :)/search%unit(1:2, :))), &
            & normal .and. search%bounded(1:2, :))/real(max(1, count(normal)), wp)
      end associate
      least = max(lift*typical, min(highest*typical, 10.0_wp*least))
      allocate (z%flow(4, size(p%joint)), source=0.0_wp)
      do i = 1, size(p%joint)
         do k = 1, 4
            if (.not. search%bounded(k, i)) cycle
            unit = search%unit(min(k, 3), i)
            flow = merge(opening(min(k, 3), i), -opening(3, i), k < 4)/unit
            if (k < 3) z%slack(k, i) = max(z%slack(k, i), -flow)
            z%slack(k, i) = max(z%slack(k, i), least**2/max(flow, least))
            z%flow(k, i) = unit*max(flow, least**2/max(z%slack(k, i), least))
         end do
      end do
      where (.not. search%bounded) z%slack = 1.0_wp
   end subroutine begin

   !> Distances of forces from their bounds
   pure function distances(p, force) result(slack)
      type(contact_problem_t), intent(in) :: p
      real(wp), intent(in) :: force(:, :)
      real(wp) :: slack(4, size(p%joint))  !! The distances: (4, n_joint) [N/m]

      slack(:2, :) = force(:2, :) + p%springs%shift(:2, :)
      associate (cone => p%springs%cone)
         slack(4, :) = cone%limit + cone%friction*(slack(1, :) + slack(2, :))
      end associate
      slack(3, :) = slack(4, :) + force(3, :)
      slack(4, :) = slack(4, :) - force(3, :)
   end function distances

   !> What an iterate lacks
   pure subroutine see_lack(p, z, search, left)
      type(contact_problem_t), intent(in) :: p
      type(iterate_t), intent(in) :: z
      type(interior_search_t), intent(inout) :: search
      real(wp), intent(out) :: left  !! The most of it, and of products, as an opening [m]
      real(wp) :: mean
      integer :: b, i

      search%balance = p%load
      call add_forces(p%springs, z%force, search%balance)
      do b = 1, size(p%equation)
         search%balance(:, b) = search%balance(:, b) - matmul(p%base(:, :, b), z%motion(:, b))
      end do
      search%opening = -openings(p, z%force, z%motion) - search%soft*(z%force - search%before)
      do i = 1, size(p%joint)
         associate (opening => search%opening(:, i), flow => z%flow(:, i))
            opening(1:2) = opening(1:2) + flow(1:2)
            opening(3) = opening(3) + flow(3) - flow(4)
            if (search%convex) opening(1:2) = opening(1:2) - search%offset(i) &
               & + p%springs%cone(i)%friction*(flow(3) + flow(4))
         end associate
      end do
      where (.not. search%given) search%opening = 0.0_wp
      search%distance = merge(distances(p, z%force) - z%slack, 0.0_wp, search%bounded)
      left = maxval(abs(search%opening))
      do i = 1, size(p%joint)
         mean = maxval(min(z%slack(:, i)*search%unit([1, 2, 3, 3], i), z%flow(:, i)), &
            & search%bounded(:, i))
         left = max(left, mean)
      end do
   end subroutine see_lack

   !> One step: a predictor, and a corrector towards equal products
   pure subroutine improve(p, search, z, gone)
      type(contact_problem_t), intent(in) :: p
      type(interior_search_t), intent(inout) :: search
      type(iterate_t), intent(inout) :: z
      real(wp), intent(out) :: gone  !! How much of the step was gone
      type(iterate_t) :: step
      real(wp) :: aim, mean
      integer :: k

      gone = 0.0_wp
      call set_yielding_springs(p, z, search)
      call factor_springs(p, search%springs)
      if (.not. search%springs%factor%usable) return
      step = z
      search%product = -z%slack*z%flow
      call find_step(p, z, search, step)
      gone = longest(search, z, step, 1.0_wp)
      mean = mean_product(search, z%slack, z%flow)
      aim = mean*min(1.0_wp, mean_product(search, z%slack + gone*step%slack, &
         & z%flow + gone*step%flow)/max(mean, tiny(mean)))**3
      search%product = search%product - gone*step%slack*step%flow
      do k = 1, 4
         search%product(k, :) = search%product(k, :) + aim*search%unit(min(k, 3), :)
      end do
      call find_step(p, z, search, step)
      gone = longest(search, z, step, share)
      z%motion = z%motion + gone*step%motion
      z%force = z%force + gone*step%force
      z%slack = z%slack + gone*step%slack
      z%flow = z%flow + gone*step%flow
   end subroutine improve

   !> The step that brings what is left to nothing
   pure subroutine find_step(p, z, search, step)
      type(contact_problem_t), intent(in) :: p
      type(iterate_t), intent(in) :: z
      type(interior_search_t), intent(in) :: search
      type(iterate_t), intent(inout) :: step
      real(wp) :: given(3, size(p%joint)), moved(3, size(p%joint)), source(4, size(p%joint))
      integer :: i

      do i = 1, size(p%joint)
         source(:, i) = merge((search%product(:, i) - z%flow(:, i)*search%distance(:, i)) &
            & /z%slack(:, i), 0.0_wp, search%bounded(:, i))
         given(:, i) = force_of_flows(p, z, search, i, source(:, i))
         step%force(:, i) = given(:, i) &
            & + matmul(search%springs%stiff(:, :, i), search%opening(:, i))
      end do
      call respond(p, search%springs, search%balance, step%force, step%motion, moved)
      do i = 1, size(p%joint)
         associate (open => search%opening(:, i) - moved(:, i))
            step%force(:, i) = given(:, i) + matmul(search%springs%stiff(:, :, i), open)
            call set_joint_step(p, z, search, i, source(:, i), open, step)
         end associate
         step%slack(:, i) = step%slack(:, i) + search%distance(:, i)
      end do
   end subroutine find_step

   !> Mean of distance times flow, over what the blocks give: in squares of a force
   pure real(wp) function mean_product(search, slack, flow)
      type(interior_search_t), intent(in) :: search
      real(wp), intent(in) :: slack(:, :)  !! Distances: (4, n_joint) [N/m]
      real(wp), intent(in) :: flow(:, :)   !! Flows: (4, n_joint) [m]

      mean_product = (sum(slack(:3, :)*flow(:3, :)/search%unit, search%bounded(:3, :)) &
         & + sum(slack(4, :)*flow(4, :)/search%unit(3, :), search%bounded(4, :))) &
         & /real(max(1, count(search%bounded)), wp)
   end function mean_product

   !> The longest step, 1 at most, that keeps a share of every distance and flow
   pure real(wp) function longest(search, z, step, way)
      type(interior_search_t), intent(in) :: search
      type(iterate_t), intent(in) :: z, step
      real(wp), intent(in) :: way  !! How much of the way to the first zero is gone
      integer :: i, k

      longest = 1.0_wp
      do i = 1, size(z%slack, 2)
         do k = 1, 4
            if (.not. search%bounded(k, i)) cycle
            if (step%slack(k, i)*longest < -way*z%slack(k, i)) &
               & longest = -way*z%slack(k, i)/step%slack(k, i)
            if (step%flow(k, i)*longest < -way*z%flow(k, i)) &
               & longest = -way*z%flow(k, i)/step%flow(k, i)
         end do
      end do
   end function longest

end module dda_contact_interior
