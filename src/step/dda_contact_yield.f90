!> Yielding of joints at their bounds in an interior-point iteration, as springs of the joints
!>
!> Equations and bounds are those of dda_contact_interior.
module dda_contact_yield
   use dda_contact_problem, only : contact_problem_t
   use dda_contact_springs, only : contact_springs_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: force_of_flows, iterate_t, interior_search_t, set_yielding_springs, set_joint_step

   !> One iterate, or a step from it
   type :: iterate_t
      !> Motion of the blocks: (n_dof, n_block) [m]
      real(wp), allocatable :: motion(:, :)
      !> Forces: (3, n_joint) [N/m]
      real(wp), allocatable :: force(:, :)
      !> Distance of the forces from each bound: (4, n_joint) [N/m]
      real(wp), allocatable :: slack(:, :)
      !> Opening or slip at each bound: (4, n_joint) [m]
      real(wp), allocatable :: flow(:, :)
   end type iterate_t

   !> What the search works on
   type :: interior_search_t
      !> Whether what slides opens, less the offset
      logical :: convex = .false.
      !> The offset: (n_joint) [m]
      real(wp), allocatable :: offset(:)
      !> Springs of the joints with their matrix
      type(contact_springs_t) :: springs
      !> Which forces there are: (3, n_joint)
      logical, allocatable :: given(:, :)
      !> Which bounds they have: (4, n_joint)
      logical, allocatable :: bounded(:, :)
      !> What the blocks give to each force, which measures openings: (3, n_joint) [m/(N/m)]
      real(wp), allocatable :: unit(:, :)
      !> Compliance beside that of bars: (3, n_joint) [m/(N/m)]
      real(wp), allocatable :: soft(:, :)
      !> Forces before: (3, n_joint) [N/m]
      real(wp), allocatable :: before(:, :)
      !> What is left of the balance of the blocks: (n_dof, n_block) [N/m]
      real(wp), allocatable :: balance(:, :)
      !> Of the openings: (3, n_joint) [m]
      real(wp), allocatable :: opening(:, :)
      !> Of the distances: (4, n_joint) [N/m]
      real(wp), allocatable :: distance(:, :)
      !> Change of distance times flow that a step is to bring: (4, n_joint) [J/m]
      real(wp), allocatable :: product(:, :)
   end type interior_search_t

   !> Stiffness of one joint at its bounds
   type :: joint_yield_t
      real(wp) :: friction  !! Coefficient of friction
      !> Stiffness of each force without the bounds of friction, of Coulomb's law with them: (3)
      !> [N/m per m]
      real(wp) :: own(3)
      !> Stiffness at the bounds of friction: (2) [N/m per m]
      real(wp) :: stiff(2) = 0.0_wp
      !> The first two, by friction in both directions: (2) [N/m per m]
      real(wp) :: wide(2)
      !> Parts of the determinant of the yield, over the product of all stiffness, and the
      !> determinant [(N/m2)2]
      real(wp) :: both, thin, det
   end type joint_yield_t

contains

   !> Set the springs of the joints: the inverse of C + F_flow' (z/b) F, or of C + F' (z/b) F in the
   !> convex problem. Closed form, because elimination of the nearly singular 3x3 matrix loses all
   !> digits
   pure subroutine set_yielding_springs(p, z, search)
      type(contact_problem_t), intent(in) :: p
      type(iterate_t), intent(in) :: z
      type(interior_search_t), intent(inout) :: search
      type(joint_yield_t) :: y
      integer :: i, k

      do i = 1, size(p%joint)
         y = yield_of(p, z, search, i)
         associate (stiff => search%springs%stiff(:, :, i))
            stiff = 0.0_wp
            do k = 1, 3
               stiff(k, k) = y%own(k)
            end do
            if (.not. search%bounded(3, i)) cycle
            if (search%convex) then
               stiff(1, 1) = y%own(1)*(y%both + y%wide(2)*y%thin)/y%det
               stiff(2, 2) = y%own(2)*(y%both + y%wide(1)*y%thin)/y%det
               stiff(3, 3) = y%own(3)*(product(y%stiff) + sum(y%wide)*sum(y%stiff))/y%det
               stiff(1, 2) = -y%own(1)*y%wide(2)*y%thin/y%det
               stiff(2, 1) = stiff(1, 2)
               stiff(3, 1:2) = y%friction*y%own(1:2)*y%own(3)*(y%stiff(1) - y%stiff(2))/y%det
               stiff(1:2, 3) = stiff(3, 1:2)
            else
               stiff(3, 1:2) = -y%friction*(1.0_wp/y%stiff(1) - 1.0_wp/y%stiff(2))*y%own(3) &
                  & *y%own(1:2)
            end if
         end associate
      end do
   end subroutine set_yielding_springs

   !> Return the stiffness of one joint at its bounds
   pure type(joint_yield_t) function yield_of(p, z, search, i) result(y)
      type(contact_problem_t), intent(in) :: p
      type(iterate_t), intent(in) :: z
      type(interior_search_t), intent(in) :: search
      integer, intent(in) :: i  !! The joint

      y%friction = p%springs%cone(i)%friction
      y%own = search%soft(:, i) + p%soft(:, i)
      where (search%bounded(1:2, i)) y%own(1:2) = y%own(1:2) + z%flow(1:2, i)/z%slack(1:2, i)
      if (search%bounded(3, i)) then
         y%stiff = z%slack(3:4, i)/z%flow(3:4, i)
         if (.not. search%convex) y%own(3) = y%own(3) + sum(1.0_wp/y%stiff)
      end if
      y%own = merge(1.0_wp/y%own, 0.0_wp, search%given(:, i))
      y%wide = y%friction**2*y%own(1:2)
      y%both = product(y%stiff) + sum(y%stiff)*y%own(3)
      y%thin = sum(y%stiff) + 4.0_wp*y%own(3)
      y%det = y%both + sum(y%wide)*y%thin
   end function yield_of

   !> Return the forces of one joint due to flows at its bounds, with its blocks held
   pure function force_of_flows(p, z, search, i, flow) result(force)
      type(contact_problem_t), intent(in) :: p
      type(iterate_t), intent(in) :: z
      type(interior_search_t), intent(in) :: search
      integer, intent(in) :: i         !! The joint
      real(wp), intent(in) :: flow(4)  !! The flows: (4) [m]
      real(wp) :: force(3)             !! The forces: (3) [N/m]
      type(joint_yield_t) :: y
      real(wp) :: given(2)

      associate (stiff => search%springs%stiff(:, :, i))
         if (.not. (search%convex .and. search%bounded(3, i))) then
            force = matmul(stiff, [flow(1:2), flow(3) - flow(4)])
            return
         end if
         y = yield_of(p, z, search, i)
         given = y%stiff*flow(3:4)/y%det
         force = matmul(stiff(:, 1:2), flow(1:2))
      end associate
      force(1:2) = force(1:2) + y%friction*y%own(1:2) &
         & *sum(given*(y%stiff(2:1:-1) + 2.0_wp*y%own(3)))
      given = given*(y%stiff(2:1:-1) + 2.0_wp*sum(y%wide))
      force(3) = force(3) + y%own(3)*(given(1) - given(2))
   end function force_of_flows

   !> Set the distances and flows of one joint for a step of its forces
   pure subroutine set_joint_step(p, z, search, i, source, opening, step)
      type(contact_problem_t), intent(in) :: p
      type(iterate_t), intent(in) :: z
      type(interior_search_t), intent(in) :: search
      integer, intent(in) :: i               !! The joint
      real(wp), intent(in) :: source(4)      !! Flows at constant forces: (4) [m]
      real(wp), intent(in) :: opening(3)     !! Openings and slip to be closed: (3) [m]
      type(iterate_t), intent(inout) :: step !! The step; distances and flows of the joint are set
      type(joint_yield_t) :: y
      real(wp) :: both, n, pressed, sheared, soft

      associate (force => step%force(:, i), slack => step%slack(:, i), flow => step%flow(:, i))
         slack(1:2) = force(1:2)
         flow(1:2) = source(1:2) - z%flow(1:2, i)/z%slack(1:2, i)*slack(1:2)
         if (search%bounded(3, i)) then
            ! sums of the forces, which are large, would leave no digits of the distances
            y = yield_of(p, z, search, i)
            associate (e => y%stiff, other => y%stiff(2:1:-1))
               if (search%convex) then
                  n = sum(y%wide)
                  pressed = y%friction*dot_product(y%own(1:2), opening(1:2) + source(1:2))
                  sheared = y%own(3)*opening(3)
                  flow(3:4) = (e*(other + n + y%own(3))*source(3:4) &
                     & - other*(n - y%own(3))*source(4:3:-1) &
                     & - (other + 2.0_wp*y%own(3))*pressed &
                     & - [sheared, -sheared]*(other + 2.0_wp*n))/y%det
               else
                  soft = search%soft(3, i) + p%soft(3, i)
                  both = soft*product(e) + sum(e)
                  pressed = y%friction*sum(force(1:2))
                  flow(3:4) = (e*(soft*other + 1.0_wp)*source(3:4) + other*source(4:3:-1) &
                     & - (soft*other + 2.0_wp)*pressed &
                     & - [opening(3), -opening(3)]*other)/both
               end if
               slack(3:4) = e*(source(3:4) - flow(3:4))
            end associate
         end if
         where (.not. search%bounded(:, i))
            slack = 0.0_wp
            flow = 0.0_wp
         end where
      end associate
   end subroutine set_joint_step

end module dda_contact_yield
