!> Contact forces of blocks that move in time by interior springs: where many blocks meet, sweeps
!> hand a force on by one block in each, but a factor reaches all at once
!>
!>    base d = load + R f,   gap + R'd + C (f - f0) = F_flow' z,   s = F f >= 0, z >= 0, s z = 0
!>
!> The rows of F are the bounds N1, N2, bound + T and bound - T, those of F_flow N1, N2, T and -T:
!> joints that slide do not open (Coulomb). C is far below what the blocks themselves give, and f0
!> the force of the step before: of all forces that stop the blocks those nearest to them count, so
!> that shear is remembered. With d = z/s the spring of a joint is the inverse of the triangle
!> C + F_flow' d F; each iteration is one factorisation, with predictor and corrector (Mehrotra
!> 1992), of few joints with more correctors where products that stray shorten the step (Gondzio
!> 1996). It begins with the forces of the step before.
submodule (dda_multipliers:dda_contact_sweeps) dda_contact_interior
   use dda_interior_problem, only : distances, factor_springs, interior_t, openings, pose, &
      & problem_t, respond, see_lack
   implicit none

   interface

      !> Find forces and motion whose faces agree, from those of an iterate
      pure module subroutine settle_faces(p, x, passes, agreed)
         type(problem_t), intent(inout) :: p  !! The problem; the size of a force is given
         type(interior_t), intent(inout) :: x
         integer, intent(inout) :: passes     !! Factorisations so far
         logical, intent(out) :: agreed       !! Whether the faces agree
      end subroutine settle_faces

      !> The same of many joints, which rather end than keep to the way that the loads have led
      !> them: with ever firmer springs, as far as these agree
      pure module subroutine settle_many_faces(p, hasty, x, passes, agreed, near)
         !> The problem; the size of a force is given, its springs are as they were in the end
         type(problem_t), intent(inout) :: p
         !> Whether joints are so many that sweeps rather go on where faces do not agree at once
         logical, intent(in) :: hasty
         type(interior_t), intent(inout) :: x
         integer, intent(inout) :: passes
         !> Whether the faces agree with springs as soft as those of few joints at the least
         logical, intent(out) :: agreed
         !> Whether they nearly agree at the least
         logical, intent(out) :: near
      end subroutine settle_many_faces

   end interface

   !> What slack and flow begin with at the least, over the size of a force
   real(wp), parameter :: lift = 1.0e-2_wp, highest = 1.0e-1_wp, afar = 2.0e-1_wp
   !> Forces across gaps, and by openings, that are left, over the size of a force
   real(wp), parameter :: tolerance = 3.0e-7_wp
   !> Compliance of the springs of many joints over that of few: gaps that it leaves are no matter
   real(wp), parameter :: softness_of_many = 1.0e-1_wp
   !> How much smaller than usual faces can leave forces before these are rounding
   real(wp), parameter :: finest = 1.0e-4_wp
   !> A step shorter than this share of the whole is stuck at a bound
   real(wp), parameter :: stuck = 0.2_wp
   !> Forces that are wrong by less are looked for from afar after the first step alone
   real(wp), parameter :: near_enough = 5.0e-2_wp
   !> Correctors of products that stray, at the most, of few joints; of many they bring little
   integer, parameter :: more_correctors = 3
   !> A product strays by more than this, times or over what all are to be
   real(wp), parameter :: astray = 1.0e1_wp
   !> A step of this length is long enough
   real(wp), parameter :: long = 0.95_wp
   !> How much farther another corrector aims, and the share of that which the step must gain
   real(wp), parameter :: farther = 0.3_wp, gain = 0.1_wp
   !> Most iterations
   integer, parameter :: max_iterations = 40
   !> Iterations without progress that end the search
   integer, parameter :: patience = 5

contains

   !> Forces of some joints if these keep nearly to the faces that they had
   module procedure keep_to_faces
      type(problem_t) :: p
      type(interior_t) :: x
      logical :: near

      call pose(equations, springs, view, joint, before, p)
      call begin(before, moved, lift, p, x)
      p%fineness = max(finest, fineness)
      if (size(joint) > many) then
         call settle_many_faces(p, hasty, x, passes, agreed, near)
      else
         call settle_faces(p, x, passes, agreed)
         near = agreed
      end if
      if (near) call take_forces(x, p, force)
   end procedure keep_to_faces

   !> Forces of some joints, wherever the search for them begins
   module procedure solve_interior
      type(problem_t) :: p
      type(interior_t) :: on_faces, x

      call pose(equations, springs, view, joint, before, p)
      if (size(joint) > many) then
         p%left = left
         where (.not. p%follows) p%soft = softness_of_many*p%soft
      end if
      call begin(force, motion, lift, p, x)
      call iterate(force, motion, p, x, passes)
      on_faces = x
      call settle_faces(p, on_faces, passes, agreed)
      if (agreed) x = on_faces
      call take_forces(x, p, force)
   end procedure solve_interior

   !> Iterate from slack and flow to the iterate that comes nearest to the law of contact
   pure subroutine iterate(force, motion, p, x, passes)
      real(wp), intent(in) :: force(:, :), motion(:, :)
      type(problem_t), intent(inout) :: p
      type(interior_t), intent(inout) :: x
      integer, intent(inout) :: passes
      type(interior_t) :: best
      real(wp) :: least, length, mean, merit
      integer :: i, waited
      logical :: near

      best = x
      least = huge(least)
      length = 1.0_wp
      waited = 0
      near = .true.
      do i = 1, max_iterations
         call find_rest(p, x, mean, merit)
         waited = merge(0, waited + 1, merit < 0.9_wp*least)
         if (merit < least) best = x
         least = min(least, merit)
         if (min(merit, sqrt(mean)/p%size) < tolerance .or. waited == patience &
            & .or. .not. merit <= huge(merit)) exit
         if (near .and. length < stuck .and. (i == 2 .or. merit > near_enough)) then
            near = .false.
            waited = 0
            least = huge(least)
            call begin(force, motion, afar, p, x)
            call find_rest(p, x, mean, merit)
         end if
         p%yield = x%flow/x%slack
         call factor_springs(p)
         passes = passes + 1
         if (.not. p%factor%usable) exit
         call improve(mean, merit, p, x, length)
      end do
      x = best
   end subroutine iterate

   !> One step from an iterate: a predictor, a corrector towards equal products, and of few joints
   !> more for those that stray
   pure subroutine improve(mean, merit, p, x, length)
      real(wp), intent(in) :: mean     !! Mean product of slack and flow, in squares of a force
      real(wp), intent(in) :: merit    !! Forces that are wrong, over the size of a force
      type(problem_t), intent(inout) :: p
      type(interior_t), intent(inout) :: x
      real(wp), intent(out) :: length  !! How much of the step was gone
      type(interior_t) :: step
      real(wp) :: goal(4, size(p%joint)), share

      step = x
      p%product = -x%slack*x%flow
      call find_step(p, x, step)
      length = longest(p, x, step, 1.0_wp)
      goal = weighted(p, mean*min(1.0_wp, &
         & mean_product(p, x%slack + length*step%slack, x%flow + length*step%flow)/mean)**3)
      p%product = p%product - length*step%slack*step%flow + goal
      call find_step(p, x, step)
      share = max(0.995_wp, 1.0_wp - merit**2)
      length = longest(p, x, step, share)
      if (size(p%joint) <= many) call lengthen(goal, share, p, x, step, length)
      x%motion = x%motion + length*step%motion
      x%force = x%force + length*step%force
      x%slack = x%slack + length*step%slack
      x%flow = x%flow + length*step%flow
   end subroutine improve

   !> Lengthen a step by correctors that bring products back which a longer one would let stray
   pure subroutine lengthen(goal, share, p, x, step, length)
      real(wp), intent(in) :: goal(:, :)  !! What the products are to be: (4, n_joint)
      real(wp), intent(in) :: share       !! How much of the way to a bound may be gone
      type(problem_t), intent(inout) :: p
      type(interior_t), intent(in) :: x
      type(interior_t), intent(inout) :: step
      real(wp), intent(inout) :: length
      type(interior_t) :: other
      real(wp) :: aim, longer, product_of(4, size(p%joint))
      integer :: k

      other = step
      do k = 1, more_correctors
         if (length > long) return
         aim = min(1.0_wp, length + farther)
         product_of = (x%slack + aim*step%slack)*(x%flow + aim*step%flow)
         p%product = p%product + merge(max(-astray*goal, &
            & min(max(product_of, goal/astray), goal*astray) - product_of), 0.0_wp, p%bounded)
         call find_step(p, x, other)
         longer = longest(p, x, other, share)
         if (longer < length + gain*(aim - length)) return
         step = other
         length = longer
      end do
   end subroutine lengthen

   !> The forces of the step before, and the motion that they make, lifted off the bounds
   pure subroutine begin(force, motion, shallow, p, x)
      real(wp), intent(in) :: force(:, :), motion(:, :)
      !> How far off the bounds at the least, over the size of a force
      real(wp), intent(in) :: shallow
      type(problem_t), intent(inout) :: p  !! The problem; the size of a force is set
      type(interior_t), intent(out) :: x
      real(wp) :: opening(3, size(p%joint)), flow, least, unit
      integer :: i, k

      x%motion = motion(:size(p%balance, 1), p%equation)
      x%force = force(:, p%joint)
      allocate (x%flow(4, size(p%joint)))
      opening = openings(p, x%motion)
      where (p%follows) opening = opening + p%soft*(x%force - p%force_before)
      p%size = sum(max(abs(x%force(1:2, :)), -opening(1:2, :)/p%unit(1:2, :)), &
         & p%given(1:2, :))/real(max(1, count(p%given(1:2, :))), wp)
      p%size = max(p%size, tiny(1.0_wp)/epsilon(1.0_wp))
      x%slack = distances(p, x%force)
      least = p%size*max(shallow, min(highest, 10.0_wp*sum(abs(min(x%slack(:2, :), &
         & opening(:2, :)/p%unit(:2, :))), p%given(:2, :)) &
         & /(p%size*real(max(1, count(p%given(:2, :))), wp))))
      do i = 1, size(p%joint)
         do k = 1, 4
            unit = p%unit(min(k, 3), i)
            flow = merge(opening(min(k, 3), i), -opening(3, i), k < 4)/unit
            if (k < 3) x%slack(k, i) = max(x%slack(k, i), -flow)
            ! the same product everywhere, but where one is larger already
            x%slack(k, i) = max(x%slack(k, i), least**2/max(flow, least))
            x%flow(k, i) = unit*max(flow, least**2/max(x%slack(k, i), least))
         end do
      end do
      where (.not. p%bounded)
         x%slack = 1.0_wp
         x%flow = 0.0_wp
      end where
   end subroutine begin

   !> What an iterate leaves of balance and openings
   pure subroutine find_rest(p, x, mean, merit)
      type(problem_t), intent(inout) :: p  !! The problem; the rests are set
      type(interior_t), intent(in) :: x
      real(wp), intent(out) :: mean, merit

      call see_lack(x, p)
      p%opening(1:2, :) = p%opening(1:2, :) + x%flow(1:2, :)
      p%opening(3, :) = p%opening(3, :) + x%flow(3, :) - x%flow(4, :)
      where (.not. p%given) p%opening = 0.0_wp
      mean = mean_product(p, x%slack, x%flow)
      merit = max(sqrt(mean), maxval(abs(p%opening)/p%unit))/p%size
   end subroutine find_rest

   !> The step that brings what is left to nothing
   pure subroutine find_step(p, x, step)
      type(problem_t), intent(in) :: p
      type(interior_t), intent(in) :: x
      type(interior_t), intent(inout) :: step
      real(wp) :: drive(3, size(p%joint)), rest(4, size(p%joint)), slack(4), source(4), bound
      integer :: i

      rest = lacking_slack(p, x)
      do i = 1, size(p%joint)
         source = (p%product(:, i) - x%flow(:, i)*rest(:, i))/x%slack(:, i)
         drive(1:2, i) = p%opening(1:2, i) + source(1:2)
         drive(3, i) = p%opening(3, i) + source(3) - source(4)
      end do
      call respond(p, drive, step%force, step%motion)
      do i = 1, size(p%joint)
         associate (f => step%force(:, i))
            bound = p%springs%cone(i)%friction*(f(1) + f(2))
            slack = [f(1), f(2), bound + f(3), bound - f(3)] + rest(:, i)
         end associate
         step%slack(:, i) = merge(slack, 0.0_wp, p%bounded(:, i))
         step%flow(:, i) = merge((p%product(:, i) - x%flow(:, i)*slack)/x%slack(:, i), 0.0_wp, &
            & p%bounded(:, i))
      end do
   end subroutine find_step

   !> What the slacks of an iterate lack
   pure function lacking_slack(p, x) result(rest)
      type(problem_t), intent(in) :: p
      type(interior_t), intent(in) :: x
      real(wp) :: rest(4, size(p%joint))  !! What they lack: (4, n_joint) [N/m]
      integer :: i

      do i = 1, size(p%joint)
         associate (cone => p%springs%cone(i), f => x%force(:, i), &
            & shift => p%springs%shift(:, i))
            rest(1:2, i) = f(1:2) + shift(1:2)
            rest(3, i) = cone%limit + cone%friction*(rest(1, i) + rest(2, i)) + f(3)
            rest(4, i) = rest(3, i) - 2.0_wp*f(3)
         end associate
      end do
      rest = merge(rest - x%slack, 0.0_wp, p%bounded)
   end function lacking_slack

   !> Mean of slack times flow, over what the blocks give: in squares of a force
   pure real(wp) function mean_product(p, slack, flow)
      type(problem_t), intent(in) :: p
      real(wp), intent(in) :: slack(:, :)  !! Slacks: (4, n_joint) [N/m]
      real(wp), intent(in) :: flow(:, :)   !! Flows: (4, n_joint) [m]

      mean_product = (sum(slack(:3, :)*flow(:3, :)/p%unit, p%bounded(:3, :)) &
         & + sum(slack(4, :)*flow(4, :)/p%unit(3, :), p%bounded(4, :))) &
         & /real(max(1, count(p%bounded)), wp)
   end function mean_product

   !> A product that is the same for all bounds, as each joint has it
   pure function weighted(p, mean) result(product_of)
      type(problem_t), intent(in) :: p
      real(wp), intent(in) :: mean
      real(wp) :: product_of(4, size(p%joint))  !! The products: (4, n_joint) [J/m]

      product_of(:3, :) = mean*p%unit
      product_of(4, :) = product_of(3, :)
      where (.not. p%bounded) product_of = 0.0_wp
   end function weighted

   !> The longest step, 1 at most, that keeps a share of every slack and flow
   pure real(wp) function longest(p, x, step, share)
      type(problem_t), intent(in) :: p
      type(interior_t), intent(in) :: x, step
      real(wp), intent(in) :: share  !! How much of the way to the first zero is gone
      integer :: i, k

      longest = 1.0_wp
      do i = 1, size(p%joint)
         do k = 1, 4
            if (.not. p%bounded(k, i)) cycle
            if (step%slack(k, i)*longest < -share*x%slack(k, i)) &
               & longest = -share*x%slack(k, i)/step%slack(k, i)
            if (step%flow(k, i)*longest < -share*x%flow(k, i)) &
               & longest = -share*x%flow(k, i)/step%flow(k, i)
         end do
      end do
   end function longest

   !> Forces of an iterate, those of open contacts none, and no shear force beyond its bound
   pure subroutine take_forces(x, p, force)
      type(interior_t), intent(in) :: x
      type(problem_t), intent(inout) :: p     !! The problem; what is lacking is set
      real(wp), intent(inout) :: force(:, :)  !! Receives the forces: (3, n_joint of all) [N/m]
      real(wp) :: bound
      integer :: i

      call see_lack(x, p)
      do i = 1, size(p%joint)
         associate (f => force(:, p%joint(i)), shift => p%springs%shift(:, i), &
            & cone => p%springs%cone(i))
            where (p%given(:, i)) f = x%force(:, i)
            where (p%bounded(1:2, i) .and. (p%unit(1:2, i)*(f(1:2) + shift(1:2)) &
               & < -p%opening(1:2, i) .or. f(1:2) < -shift(1:2))) f(1:2) = -shift(1:2)
            if (.not. p%bounded(3, i)) cycle
            bound = cone%limit + cone%friction*sum(f(1:2) + shift(1:2))
            f(3) = max(-bound, min(bound, f(3)))
         end associate
      end do
   end subroutine take_forces

end submodule dda_contact_interior
