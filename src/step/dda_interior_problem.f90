!> Joints and blocks whose contact forces interior springs find, and the matrix of these springs
submodule (dda_settle_in_time) dda_interior_problem
   use dda_block_factor, only : factorise, plan_factor, substitute
   use dda_block_matrix, only : set_pattern
   use dda_contact_types, only : unbounded
   implicit none

   !> Compliance of the springs over that of the blocks, and at the most over that of typical ones:
   !> slivers give too easily to be a measure
   real(wp), parameter :: compliance = 1.0e-4_wp

contains

   !> The joints with their blocks numbered anew, and the pattern of their matrix
   module procedure pose
      integer :: i, k, n, n_dof, pair(2, size(joint))

      n = size(joint)
      n_dof = size(motion, 1)
      ! strain that follows its load has no part in impulses
      if (.not. any(abs(springs%row(4:, :, :, joint)) > 0.0_wp)) n_dof = 3
      allocate (p%joint, source=joint)
      allocate (p%block(2, n), p%entry(n), p%bounded(4, n), p%unit(3, n), p%force_before(3, n))
      allocate (p%opening(3, n), p%product(4, n), p%given(3, n), p%yield(4, n), p%stiff(4, n))
      ! no compliance is negative: the first matrix is made for every joint
      allocate (p%held(7, n), source=-1.0_wp)
      call number_blocks(springs, size(equations%load, 2), p)
      p%entry = 0
      k = 0
      do i = 1, n
         if (any(p%block(:, i) == 0)) cycle
         k = k + 1
         p%entry(i) = k
         pair(:, k) = p%block(:, i)
      end do
      call set_pattern(p%matrix, n_dof, size(p%equation), pair(:, :k), symmetric=.false.)
      call plan_factor(p%matrix, p%factor)
      allocate (p%balance(n_dof, size(p%equation)))
      call pose_springs(springs, view, force, p)
   end procedure pose

   !> Number the blocks of the joints as these come
   pure subroutine number_blocks(springs, n_equation, p)
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: n_equation    !! Movable blocks in all
      type(problem_t), intent(inout) :: p  !! The problem; equations and blocks are set
      integer :: e, i, side, number(0:n_equation), equation(2*size(p%joint))

      number = 0
      e = 0
      do i = 1, size(p%joint)
         do side = 1, 2
            associate (global => springs%equation(side, p%joint(i)))
               if (global > 0 .and. number(global) == 0) then
                  e = e + 1
                  number(global) = e
                  equation(e) = global
               end if
               p%block(side, i) = number(global)
            end associate
         end do
      end do
      p%equation = equation(:e)
   end subroutine number_blocks

   !> What the forces of the joints may be, and how they are measured
   pure subroutine pose_springs(springs, view, force, p)
      type(joint_springs_t), intent(in) :: springs
      type(contact_view_t), intent(in) :: view
      !> Forces of all joints in the step before: (3, n_joint) [N/m]
      real(wp), intent(in) :: force(:, :)
      type(problem_t), intent(inout) :: p
      integer :: i, k

      do i = 1, size(p%joint)
         associate (j => p%joint(i), given => p%given(:, i))
            p%unit(:, i) = [(view%give(k, k, j), k=1, 3)]
            given = p%unit(:, i) > 0.0_wp
            where (.not. given) p%unit(:, i) = 1.0_wp
            p%bounded(1:2, i) = given(1:2) .and. springs%shift(1:2, j) < unbounded
            p%bounded(3:4, i) = given(3) .and. springs%cone(j)%kind /= cone_kind%no_slip
            p%force_before(:, i) = force(:, j)
         end associate
      end do
      p%follows = view%soft(:, p%joint) > 0.0_wp
      where (p%follows) p%force_before = view%rest(:, p%joint)
      p%soft = compliance*min(p%unit, count(p%given)/sum(1.0_wp/p%unit, p%given))
      where (p%follows) p%soft = view%soft(:, p%joint)
   end subroutine pose_springs

   !> Openings and slips after a motion, from the gaps before it
   module procedure see_openings
      integer :: i

      call move_joints(springs, p, motion, opening)
      do i = 1, size(p%joint)
         opening(:, i) = merge(opening(:, i) + view%gap(:, p%joint(i)), 0.0_wp, p%given(:, i))
      end do
   end procedure see_openings

   !> What a motion of the blocks adds to openings and slips
   pure subroutine move_joints(springs, p, motion, opening)
      type(joint_springs_t), intent(in) :: springs
      type(problem_t), intent(in) :: p
      real(wp), intent(in) :: motion(:, :)
      real(wp), intent(out) :: opening(:, :)  !! What it adds: (3, n_joint) [m]
      real(wp) :: sum_of(3)
      integer :: b, d, i, side

      do i = 1, size(p%joint)
         sum_of = 0.0_wp
         do side = 1, 2
            b = p%block(side, i)
            if (b == 0) cycle
            associate (row => springs%row(:, :, side, p%joint(i)))
               ! three unknowns at a time, so that the compiler knows the length
               do d = 1, size(motion, 1), 3
                  sum_of = sum_of + row(d, :)*motion(d, b) + row(d + 1, :)*motion(d + 1, b) &
                     & + row(d + 2, :)*motion(d + 2, b)
               end do
            end associate
         end do
         opening(:, i) = sum_of
      end do
   end subroutine move_joints

   !> Let forces of the joints act on the blocks
   pure subroutine push_blocks(springs, p, force, load)
      type(joint_springs_t), intent(in) :: springs
      type(problem_t), intent(in) :: p
      real(wp), intent(in) :: force(:, :)
      real(wp), intent(inout) :: load(:, :)  !! Receives them: (n_dof, n_block) [N/m]
      integer :: b, d, i, side

      do i = 1, size(p%joint)
         do side = 1, 2
            b = p%block(side, i)
            if (b == 0) cycle
            associate (row => springs%row(:, :, side, p%joint(i)))
               do d = 1, size(load, 1), 3
                  load(d:d + 2, b) = load(d:d + 2, b) + row(d:d + 2, 1)*force(1, i) &
                     & + row(d:d + 2, 2)*force(2, i) + row(d:d + 2, 3)*force(3, i)
               end do
            end associate
         end do
      end do
   end subroutine push_blocks

   !> What forces and motion lack of balance, and of openings that are closed
   module procedure see_lack
      integer :: b, n

      n = size(p%balance, 1)
      do b = 1, size(p%equation)
         associate (e => p%equation(b))
            p%balance(:, b) = equations%load(:n, e) &
               & - matmul(equations%base(:n, :n, e), x%motion(:, b))
         end associate
      end do
      call push_blocks(springs, p, x%force, p%balance)
      call see_openings(springs, view, p, x%motion, p%opening)
      p%opening = merge(-p%opening - p%soft*(x%force - p%force_before), 0.0_wp, p%given)
   end procedure see_lack

   !> Forces and motion that give what is lacking
   module procedure respond
      real(wp) :: moved(3, size(p%joint))
      integer :: i

      do i = 1, size(p%joint)
         force(:, i) = answer(p%stiff(:, i), drive(:, i))
      end do
      motion = p%balance
      call push_blocks(springs, p, force, motion)
      call substitute(p%factor, motion)
      call move_joints(springs, p, motion, moved)
      do i = 1, size(p%joint)
         force(:, i) = answer(p%stiff(:, i), drive(:, i) - moved(:, i))
      end do
   end procedure respond

   !> Distance of the forces from their bounds
   module procedure see_bounds
      real(wp) :: bound
      integer :: i

      do i = 1, size(p%joint)
         associate (cone => springs%cone(p%joint(i)), shift => springs%shift(:, p%joint(i)))
            slack(1:2, i) = force(1:2, i) + shift(1:2)
            bound = cone%limit + cone%friction*(slack(1, i) + slack(2, i))
         end associate
         slack(3, i) = bound + force(3, i)
         slack(4, i) = bound - force(3, i)
      end do
   end procedure see_bounds

   !> The matrix with the springs as their bounds yield, and its factor
   module procedure factor_springs
      real(wp) :: wanted(7)
      logical :: changed(0:size(p%equation))
      integer :: i, n

      n = size(p%balance, 1)
      changed = .not. p%factor%usable
      do i = 1, size(p%joint)
         wanted = [p%soft(:, i), p%yield(:, i)]
         if (all(abs(wanted - p%held(:, i)) <= 0.0_wp)) cycle
         p%held(:, i) = wanted
         p%stiff(:, i) = stiffness(springs%cone(p%joint(i))%friction, p%given(:, i), wanted)
         changed(p%block(:, i)) = .true.
      end do
      if (.not. any(changed(1:))) return
      p%matrix%diagonal = equations%base(:n, :n, p%equation)
      p%matrix%coupling = 0.0_wp
      p%matrix%upper = 0.0_wp
      do i = 1, size(p%joint)
         call add_springs(springs, i, p)
      end do
      call factorise(p%matrix, p%factor, changed(1:))
   end procedure factor_springs

   !> Add the springs of one joint to the matrix
   pure subroutine add_springs(springs, i, p)
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: i             !! Place of the joint in the problem
      type(problem_t), intent(inout) :: p  !! The problem; the matrix receives the stiffness
      real(wp), dimension(6, 3, 2) :: row, steep
      integer :: b, first, k, n, one

      n = size(p%balance, 1)
      row(:n, :, :) = springs%row(:n, :, :, p%joint(i))
      ! R S, of columns opening 1, opening 2, slip
      do k = 1, 2
         steep(:n, k, :) = p%stiff(k, i)*(row(:n, k, :) - p%stiff(4, i)*row(:n, 3, :))
      end do
      steep(:n, 3, :) = p%stiff(3, i)*row(:n, 3, :)
      associate (m => p%matrix, e => p%entry(i))
         do one = 1, 2
            b = p%block(one, i)
            if (b > 0) call add_rows(n, steep(:, :, one), row(:, :, one), m%diagonal(:, :, b))
         end do
         if (e == 0) return
         first = merge(1, 2, m%pair(1, e) == p%block(1, i))
         call add_rows(n, steep(:, :, first), row(:, :, 3 - first), m%coupling(:, :, e))
         call add_rows(n, steep(:, :, 3 - first), row(:, :, first), m%upper(:, :, e))
      end associate
   end subroutine add_springs

   !> Add the product of three columns and three rows
   pure subroutine add_rows(n, steep, row, matrix)
      integer, intent(in) :: n                 !! Unknowns of a block
      real(wp), intent(in) :: steep(6, 3)      !! The columns, n of each
      real(wp), intent(in) :: row(6, 3)        !! The rows, n of each
      real(wp), intent(inout) :: matrix(n, n)  !! Receives it
      integer :: c, i

      do c = 1, n
         ! three unknowns at a time, so that the compiler knows the length
         do i = 1, n, 3
            matrix(i:i + 2, c) = matrix(i:i + 2, c) + steep(i:i + 2, 1)*row(c, 1) &
               & + steep(i:i + 2, 2)*row(c, 2) + steep(i:i + 2, 3)*row(c, 3)
         end do
      end do
   end subroutine add_rows

   !> What the springs of a joint answer
   pure function stiffness(friction, given, compliances)
      real(wp), intent(in) :: friction        !! Coefficient of friction
      logical, intent(in) :: given(3)         !! Which forces there are
      real(wp), intent(in) :: compliances(7)  !! Of the springs, and of the four bounds [m/(N/m)]
      real(wp) :: stiffness(4)                !! The answers

      associate (soft => compliances(:3), yield => compliances(4:))
         stiffness(:3) = merge(1.0_wp/(soft + [yield(1:2), yield(3) + yield(4)]), 0.0_wp, given)
         stiffness(4) = friction*(yield(3) - yield(4))*stiffness(3)
      end associate
   end function stiffness

   !> Forces of a joint's springs that are pressed together
   pure function answer(stiff, drive) result(force)
      real(wp), intent(in) :: stiff(4)  !! What they answer
      real(wp), intent(in) :: drive(3)  !! By how much: (3) [m]
      real(wp) :: force(3)              !! The forces: (3) [N/m]

      force(1:2) = stiff(1:2)*drive(1:2)
      force(3) = stiff(3)*drive(3) - stiff(4)*(force(1) + force(2))
   end function answer

end submodule dda_interior_problem
