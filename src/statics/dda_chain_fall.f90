!> First motion of a chain that collapses
!>
!> Of all accelerations that the joints allow, the true ones are nearest to those of free fall in
!> the measure of the masses (principle of Gauss). Unknown are the openings a of bounds of joints.
!> Each moves all blocks behind its joint as one body, and together they leave the right springing
!> at rest:
!>
!>    least a'K a/2 - p'a  with  W'a = 0,  a >= 0
!>
!> K are the masses, p the powers of the loads, W the motions, and the multipliers of W'a = 0 are
!> the reaction of the right springing. The active-set method begins with the mechanism of the
!> deficit: the bound that is broken most enters, the one whose opening vanishes first leaves.
module dda_chain_fall
   use dda_chain, only : chain_t
   use dda_chain_balance, only : influence
   use dda_chain_programme, only : bound_arms, deficit_t
   use dda_kinds, only : wp
   use dda_small_systems, only : eliminate_full, substitute_full
   implicit none
   private

   public :: chain_fall_t, find_chain_fall

   !> Largest number of bounds that open, and of changes of these
   integer, parameter :: max_open = 40, max_changes = 400
   !> Rounding error of forces over the largest
   real(wp), parameter :: rounding = 1.0e-11_wp

   !> The first motion
   type :: chain_fall_t
      integer :: n_open = 0                 !! Number of bounds that open
      integer :: joint(max_open) = 0        !! Their joints
      integer :: bound(max_open) = 0        !! Their numbers, as of a deficit
      real(wp) :: share(max_open) = 0.0_wp  !! Their openings, up to a common factor [m]
      real(wp), allocatable :: force(:, :)  !! Forces N1, N2, T of all joints: (3, n + 1) [N/m]
   end type chain_fall_t

   !> Loads and masses as multiples of the largest, moments about the origin and motions of it in
   !> units of the length
   type :: bodies_t
      real(wp) :: length = 1.0_wp              !! Unit of length [m]
      real(wp), allocatable :: load(:, :)      !! Load behind each joint: (3, n + 1)
      real(wp), allocatable :: mass(:, :, :)   !! Mass matrix behind each joint: (3, 3, n + 1)
      integer, allocatable :: held(:)          !! Motions that the right springing prevents
      real(wp) :: reaction(3) = 0.0_wp         !! Force of the right springing: (3)
      real(wp) :: twist(3, max_open) = 0.0_wp  !! Motions by the bounds that open: (3, max_open)
   end type bodies_t

contains

   !> Find the first motion
   pure subroutine find_chain_fall(chain, deficit, fall, found)
      type(chain_t), intent(in) :: chain
      type(deficit_t), intent(in) :: deficit  !! Its deficit, which is positive
      type(chain_fall_t), intent(out) :: fall
      logical, intent(out) :: found           !! True if the motion was found
      type(bodies_t) :: bodies
      real(wp) :: aim(max_open), step
      integer :: bound, change, first, joint, r

      call add_bodies(chain, bodies)
      allocate (fall%force(3, size(chain%joint)))
      do r = 1, 4
         if (deficit%joint(r) > 0 .and. deficit%share(r) > 0.0_wp) &
            & call open_bound(chain, deficit%joint(r), deficit%bound(r), bodies, fall)
      end do
      fall%share(:fall%n_open) = pack(deficit%share, deficit%joint > 0 &
         & .and. deficit%share > 0.0_wp)/chain%joint(fall%joint(:fall%n_open))%half
      do change = 1, max_changes
         call solve_openings(fall, bodies, aim, found)
         if (.not. found) return
         associate (n => fall%n_open)
            if (all(aim(:n) > 0.0_wp)) then
               fall%share(:n) = aim(:n)
               call find_broken(chain, bodies, fall, joint, bound)
               if (joint == 0) exit
               found = n < max_open
               if (.not. found) return
               call open_bound(chain, joint, bound, bodies, fall)
            else
               first = minloc(fall%share(:n)/max(fall%share(:n) - aim(:n), tiny(1.0_wp)), dim=1, &
                  & mask=.not. aim(:n) > 0.0_wp)
               step = fall%share(first)/max(fall%share(first) - aim(first), tiny(1.0_wp))
               fall%share(:n) = max(0.0_wp, fall%share(:n) + step*(aim(:n) - fall%share(:n)))
               call close_bound(first, bodies, fall)
            end if
         end associate
         found = change < max_changes
      end do
      if (.not. found) return
      do r = 1, fall%n_open
         fall%share(r) = fall%share(r)*chain%joint(fall%joint(r))%half
      end do
   end subroutine find_chain_fall

   !> Sum the loads and masses behind each joint
   pure subroutine add_bodies(chain, bodies)
      type(chain_t), intent(in) :: chain
      type(bodies_t), intent(out) :: bodies
      real(wp) :: place(2), whole
      integer :: b, n

      n = size(chain%block)
      bodies%length = chain%reach + chain%joint(1)%half
      bodies%held = [1, 2, 3]
      ! the plane of symmetry is smooth
      if (chain%halved) bodies%held = [1, 3]
      whole = sum(chain%block%mass)
      allocate (bodies%load(3, n + 1), bodies%mass(3, 3, n + 1), source=0.0_wp)
      do b = n, 1, -1
         associate (block => chain%block(b))
            place = block%centroid/bodies%length
            bodies%load(:, b) = bodies%load(:, b + 1) + [block%weight, place(1)*block%weight(2) &
               & - place(2)*block%weight(1)]/chain%whole_load
            bodies%mass(:, :, b) = bodies%mass(:, :, b + 1) + reshape([1.0_wp, 0.0_wp, -place(2), &
               & 0.0_wp, 1.0_wp, place(1), -place(2), place(1), dot_product(place, place) &
               & + block%inertia/(block%mass*bodies%length**2)], [3, 3])*(block%mass/whole)
         end associate
      end do
   end subroutine add_bodies

   !> Add a bound to those that open
   pure subroutine open_bound(chain, joint, bound, bodies, fall)
      type(chain_t), intent(in) :: chain
      integer, intent(in) :: joint, bound  !! The joint and the number of the bound
      type(bodies_t), intent(inout) :: bodies
      type(chain_fall_t), intent(inout) :: fall
      real(wp) :: arms(3)

      fall%n_open = fall%n_open + 1
      fall%joint(fall%n_open) = joint
      fall%bound(fall%n_open) = bound
      fall%share(fall%n_open) = 0.0_wp
      arms = bound_arms(chain, joint, bound)*chain%joint(joint)%half
      bodies%twist(:, fall%n_open) = [arms(:2)/bodies%length, arms(3)]
   end subroutine open_bound

   !> Remove a bound from those that open
   pure subroutine close_bound(r, bodies, fall)
      integer, intent(in) :: r  !! Its number among them
      type(bodies_t), intent(inout) :: bodies
      type(chain_fall_t), intent(inout) :: fall

      associate (n => fall%n_open)
         fall%joint(r:n - 1) = fall%joint(r + 1:n)
         fall%bound(r:n - 1) = fall%bound(r + 1:n)
         fall%share(r:n - 1) = fall%share(r + 1:n)
         bodies%twist(:, r:n - 1) = bodies%twist(:, r + 1:n)
         n = n - 1
      end associate
   end subroutine close_bound

   !> Openings and reaction while the bounds open or close freely
   pure subroutine solve_openings(fall, bodies, opening, found)
      type(chain_fall_t), intent(in) :: fall
      type(bodies_t), intent(inout) :: bodies          !! Receives the reaction
      real(wp), intent(out) :: opening(max_open)       !! Their openings: (max_open)
      logical, intent(out) :: found                    !! True if the equations have a solution
      real(wp), dimension(fall%n_open + size(bodies%held), &
         & fall%n_open + size(bodies%held)) :: matrix
      real(wp) :: x(fall%n_open + size(bodies%held))
      integer :: b, c, exchange(size(x)), n

      n = fall%n_open
      matrix = 0.0_wp
      x = 0.0_wp
      do b = 1, n
         associate (own => bodies%twist(:, b))
            do c = 1, n
               matrix(b, c) = dot_product(own, matmul(bodies%mass(:, :, max(fall%joint(b), &
                  & fall%joint(c))), bodies%twist(:, c)))
            end do
            matrix(b, n + 1:) = own(bodies%held)
            matrix(n + 1:, b) = own(bodies%held)
            x(b) = dot_product(own, bodies%load(:, fall%joint(b)))
         end associate
      end do
      call eliminate_full(matrix, exchange, found)
      if (.not. found) return
      call substitute_full(matrix, exchange, x)
      opening(:n) = x(:n)
      bodies%reaction = 0.0_wp
      bodies%reaction(bodies%held) = x(n + 1:)
   end subroutine solve_openings

   !> Set the forces of all joints, and find the bound that is broken most; joint 0 if none is
   pure subroutine find_broken(chain, bodies, fall, worst, bound)
      type(chain_t), intent(in) :: chain
      type(bodies_t), intent(in) :: bodies
      type(chain_fall_t), intent(inout) :: fall
      integer, intent(out) :: worst, bound  !! The joint and the number of the bound
      real(wp) :: least, room, sum(3)
      integer :: b, j, n

      n = size(chain%joint)
      do j = 1, n
         sum = bodies%reaction - bodies%load(:, j)
         do b = 1, fall%n_open
            sum = sum + matmul(bodies%mass(:, :, max(j, fall%joint(b))), &
               & bodies%twist(:, b)*fall%share(b))
         end do
         fall%force(:, j) = chain%whole_load*matmul(influence(chain, j), &
            & [sum(:2), sum(3)*bodies%length])
      end do
      worst = 0
      bound = 0
      least = -rounding*maxval(abs(fall%force))
      do j = 1, n - merge(1, 0, chain%keystone)
         do b = 1, 4
            if (b > 2 .and. (chain%joint(j)%no_slip .or. chain%halved .and. j == n)) exit
            if (any(fall%joint(:fall%n_open) == j .and. fall%bound(:fall%n_open) == b)) cycle
            associate (force => fall%force(:, j))
               room = force(min(b, 2))
               if (b > 2) room = chain%joint(j)%friction*(force(1) + force(2)) &
                  & + merge(-1, 1, b == 3)*force(3)
            end associate
            if (.not. room < least) cycle
            least = room
            worst = j
            bound = b
         end do
      end do
   end subroutine find_broken
end module dda_chain_fall
