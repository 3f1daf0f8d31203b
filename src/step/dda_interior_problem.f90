!> Joints and blocks whose contact forces interior springs find, and the matrix of these springs
module dda_interior_problem
   use dda_block_factor, only : block_factor_t, factorise, plan_factor, substitute
   use dda_block_matrix, only : block_matrix_t, set_pattern
   use dda_contact_types, only : joint_springs_t, unbounded
   use dda_contact_view, only : contact_view_t
   use dda_friction_cone, only : cone_kind
   use dda_kinds, only : wp
   use dda_spring_products, only : add_forces, add_product, relative_displacement
   use dda_step_state, only : equations_t
   implicit none
   private

   public :: distances, factor_springs, interior_t, many, openings, pose, problem_t, respond
   public :: see_lack

   !> One iterate, or a step from it
   type :: interior_t
      !> Motion of the blocks: (n_dof, n_block) [m]
      real(wp), allocatable :: motion(:, :)
      !> Forces: (3, n_joint) [N/m]
      real(wp), allocatable :: force(:, :)
      !> Distance of the forces from each bound: (4, n_joint) [N/m]
      real(wp), allocatable :: slack(:, :)
      !> Opening or slip at each bound: (4, n_joint) [m]
      real(wp), allocatable :: flow(:, :)
   end type interior_t

   !> Joints and blocks of the problem, and what an iterate leaves of its equations
   type :: problem_t
      !> Numbers of the joints: (n_joint)
      integer, allocatable :: joint(:)
      !> Equations of the blocks: (n_block)
      integer, allocatable :: equation(:)
      !> Rows and bounds of the joints; their equations are the blocks as they are numbered here
      type(joint_springs_t) :: springs
      !> Matrix of the blocks without springs: (n_dof, n_dof, n_block)
      real(wp), allocatable :: base(:, :, :)
      !> Loads: (n_dof, n_block) [N/m]
      real(wp), allocatable :: load(:, :)
      !> Gaps before the motion: (3, n_joint) [m]
      real(wp), allocatable :: gap(:, :)
      !> Coupling of each joint in the matrix, or 0: (n_joint)
      integer, allocatable :: entry(:)
      !> Which forces there are: (3, n_joint)
      logical, allocatable :: given(:, :)
      !> Which bounds the forces of each joint have: (4, n_joint)
      logical, allocatable :: bounded(:, :)
      !> What the blocks give to each force, which measures openings: (3, n_joint) [m/(N/m)]
      real(wp), allocatable :: unit(:, :)
      !> Compliance of the springs: (3, n_joint) [m/(N/m)]
      real(wp), allocatable :: soft(:, :)
      !> Which openings follow their forces for good: (3, n_joint)
      logical, allocatable :: follows(:, :)
      !> Forces of the step before, or those without opening: (3, n_joint) [N/m]
      real(wp), allocatable :: force_before(:, :)
      !> Size of a force [N/m]
      real(wp) :: size = 0.0_wp
      !> How much smaller than usual forces must be that faces leave
      real(wp) :: fineness = 1.0_wp
      !> Gap that springs may leave [m]
      real(wp) :: left = 0.0_wp
      !> Compliance that each bound adds to its spring: (4, n_joint) [m/(N/m)]
      real(wp), allocatable :: yield(:, :)
      !> Compliances that matrix and factor were made for, of springs and bounds: (7, n_joint)
      !> [m/(N/m)]
      real(wp), allocatable :: held(:, :)
      !> What the springs answer as their bounds yield: to each opening, to slip [N/m per m], and
      !> what slip takes of the forces of the openings: (4, n_joint)
      real(wp), allocatable :: stiff(:, :)
      !> Matrix with the springs
      type(block_matrix_t) :: matrix
      !> Its factor
      type(block_factor_t) :: factor
      !> What is left of the balance of the blocks: (n_dof, n_block) [N/m]
      real(wp), allocatable :: balance(:, :)
      !> Of the openings: (3, n_joint) [m]
      real(wp), allocatable :: opening(:, :)
      !> Change of slack times flow that a step is to bring: (4, n_joint)
      real(wp), allocatable :: product(:, :)
   end type problem_t

   !> Groups of more joints than this are swept for long before interior springs are tried
   integer, parameter :: many = 300

   !> Compliance of the springs over that of the blocks, and at the most over that of typical ones:
   !> slivers give too easily to be a measure
   real(wp), parameter :: compliance = 1.0e-4_wp

contains

   !> The problem of some joints, with their blocks numbered anew, and the pattern of its matrix
   pure subroutine pose(equations, springs, view, joint, force, p)
      type(equations_t), intent(in) :: equations
      type(joint_springs_t), intent(in) :: springs
      type(contact_view_t), intent(in) :: view
      integer, intent(in) :: joint(:)  !! Numbers of the joints: (n)
      !> Forces of all joints in the step before: (3, n_joint) [N/m]
      real(wp), intent(in) :: force(:, :)
      type(problem_t), intent(out) :: p
      integer :: i, k, n, n_dof, pair(2, size(joint))

      n = size(joint)
      n_dof = size(springs%row, 1)
      ! strain that follows its load has no part in impulses
      if (.not. any(abs(springs%row(4:, :, :, joint)) > 0.0_wp)) n_dof = 3
      allocate (p%joint, source=joint)
      allocate (p%springs%equation(2, n), p%entry(n), p%bounded(4, n), p%unit(3, n))
      allocate (p%opening(3, n), p%product(4, n), p%given(3, n), p%yield(4, n), p%stiff(4, n))
      ! no compliance is negative: the first matrix is made for every joint
      allocate (p%held(7, n), source=-1.0_wp)
      call number_blocks(springs, size(equations%load, 2), p)
      p%base = equations%base(:n_dof, :n_dof, p%equation)
      p%load = equations%load(:n_dof, p%equation)
      p%springs%row = springs%row(:n_dof, :, :, joint)
      p%springs%shift = springs%shift(:, joint)
      p%springs%cone = springs%cone(joint)
      p%gap = view%gap(:, joint)
      p%entry = 0
      k = 0
      do i = 1, n
         if (any(p%springs%equation(:, i) == 0)) cycle
         k = k + 1
         p%entry(i) = k
         pair(:, k) = p%springs%equation(:, i)
      end do
      call set_pattern(p%matrix, n_dof, size(p%equation), pair(:, :k), symmetric=.false.)
      call plan_factor(p%matrix, p%factor)
      allocate (p%balance, mold=p%load)
      call pose_springs(view, force, p)
   end subroutine pose

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
               p%springs%equation(side, i) = number(global)
            end associate
         end do
      end do
      p%equation = equation(:e)
   end subroutine number_blocks

   !> What the forces of the joints may be, and how they are measured
   pure subroutine pose_springs(view, force, p)
      type(contact_view_t), intent(in) :: view
      real(wp), intent(in) :: force(:, :)
      type(problem_t), intent(inout) :: p
      integer :: i, k

      do i = 1, size(p%joint)
         associate (given => p%given(:, i))
            p%unit(:, i) = [(view%give(k, k, p%joint(i)), k=1, 3)]
            given = p%unit(:, i) > 0.0_wp
            where (.not. given) p%unit(:, i) = 1.0_wp
            p%bounded(1:2, i) = given(1:2) .and. p%springs%shift(1:2, i) < unbounded
            p%bounded(3:4, i) = given(3) .and. p%springs%cone(i)%kind /= cone_kind%no_slip
         end associate
      end do
      p%force_before = force(:, p%joint)
      p%follows = view%soft(:, p%joint) > 0.0_wp
      where (p%follows) p%force_before = view%rest(:, p%joint)
      p%soft = compliance*min(p%unit, count(p%given)/sum(1.0_wp/p%unit, p%given))
      where (p%follows) p%soft = view%soft(:, p%joint)
   end subroutine pose_springs

   !> Openings and slips after a motion, from the gaps before it
   pure function openings(p, motion)
      type(problem_t), intent(in) :: p
      real(wp), intent(in) :: motion(:, :)     !! The motion: (n_dof, n_block) [m]
      real(wp) :: openings(3, size(p%joint))  !! The openings: (3, n_joint) [m]

      openings = merge(relative_displacement(p%springs, motion) + p%gap, 0.0_wp, p%given)
   end function openings

   !> What forces and motion lack of balance, and of openings that are closed
   pure subroutine see_lack(x, p)
      type(interior_t), intent(in) :: x
      type(problem_t), intent(inout) :: p  !! The problem; balance and openings are set
      integer :: b

      do b = 1, size(p%equation)
         p%balance(:, b) = p%load(:, b) - matmul(p%base(:, :, b), x%motion(:, b))
      end do
      call add_forces(p%springs, x%force, p%balance)
      p%opening = merge(-openings(p, x%motion) - p%soft*(x%force - p%force_before), 0.0_wp, p%given)
   end subroutine see_lack

   !> Forces and motion that give what is lacking
   pure subroutine respond(p, drive, force, motion)
      type(problem_t), intent(in) :: p  !! The problem, factored, with what it lacks of balance
      !> By how much the springs are pressed together: (3, n_joint) [m]
      real(wp), intent(in) :: drive(:, :)
      real(wp), intent(out) :: force(:, :)   !! The forces: (3, n_joint) [N/m]
      real(wp), intent(out) :: motion(:, :)  !! The motion: (n_dof, n_block) [m]
      real(wp) :: moved(3, size(p%joint))
      integer :: i

      do i = 1, size(p%joint)
         force(:, i) = answer(p%stiff(:, i), drive(:, i))
      end do
      motion = p%balance
      call add_forces(p%springs, force, motion)
      call substitute(p%factor, motion)
      moved = relative_displacement(p%springs, motion)
      do i = 1, size(p%joint)
         force(:, i) = answer(p%stiff(:, i), drive(:, i) - moved(:, i))
      end do
   end subroutine respond

   !> Distance of the forces from their bounds
   pure function distances(p, force) result(slack)
      type(problem_t), intent(in) :: p
      real(wp), intent(in) :: force(:, :)   !! The forces: (3, n_joint) [N/m]
      real(wp) :: slack(4, size(p%joint))  !! The distances: (4, n_joint) [N/m]

      slack(:2, :) = force(:2, :) + p%springs%shift(:2, :)
      associate (cone => p%springs%cone)
         slack(4, :) = cone%limit + cone%friction*(slack(1, :) + slack(2, :))
      end associate
      slack(3, :) = slack(4, :) + force(3, :)
      slack(4, :) = slack(4, :) - force(3, :)
   end function distances

   !> The matrix with the springs as their bounds yield, and its factor, of which stays what they
   !> do not change
   pure subroutine factor_springs(p)
      type(problem_t), intent(inout) :: p  !! The problem; matrix and factor are made anew
      real(wp) :: wanted(7)
      logical :: changed(0:size(p%equation))
      integer :: i

      changed = .not. p%factor%usable
      do i = 1, size(p%joint)
         wanted = [p%soft(:, i), p%yield(:, i)]
         if (all(abs(wanted - p%held(:, i)) <= 0.0_wp)) cycle
         p%held(:, i) = wanted
         p%stiff(:, i) = stiffness(p%springs%cone(i)%friction, p%given(:, i), wanted)
         changed(p%springs%equation(:, i)) = .true.
      end do
      if (.not. any(changed(1:))) return
      p%matrix%diagonal = p%base
      p%matrix%coupling = 0.0_wp
      p%matrix%upper = 0.0_wp
      do i = 1, size(p%joint)
         call add_springs(i, p)
      end do
      call factorise(p%matrix, p%factor, changed(1:))
   end subroutine factor_springs

   !> Add the springs of one joint to the matrix
   pure subroutine add_springs(i, p)
      integer, intent(in) :: i             !! Place of the joint in the problem
      type(problem_t), intent(inout) :: p  !! The problem; the matrix receives the stiffness
      real(wp) :: steep(size(p%load, 1), 3, 2)
      integer :: b, first, k, side

      associate (m => p%matrix, e => p%entry(i), block => p%springs%equation(:, i), &
         & row => p%springs%row(:, :, :, i))
         ! R S, of columns opening 1, opening 2, slip
         do k = 1, 2
            steep(:, k, :) = p%stiff(k, i)*(row(:, k, :) - p%stiff(4, i)*row(:, 3, :))
         end do
         steep(:, 3, :) = p%stiff(3, i)*row(:, 3, :)
         do side = 1, 2
            b = block(side)
            if (b > 0) call add_product(steep(:, :, side), row(:, :, side), m%diagonal(:, :, b))
         end do
         if (e == 0) return
         first = merge(1, 2, m%pair(1, e) == block(1))
         call add_product(steep(:, :, first), row(:, :, 3 - first), m%coupling(:, :, e))
         call add_product(steep(:, :, 3 - first), row(:, :, first), m%upper(:, :, e))
      end associate
   end subroutine add_springs

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
end module dda_interior_problem
