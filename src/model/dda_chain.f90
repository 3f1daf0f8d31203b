!> Rigid blocks in a row between two fixed ones, each touching its two neighbours alone, as flat
!> arrays: the form in which a scene that needs no more is decided
module dda_chain
   use dda_kinds, only : wp
   implicit none
   private

   public :: chain_t, new_chain, weigh

   !> Blocks from left to right; joint j is the one before block j, the last joint is behind the
   !> last block. A joint's force is N1 at its first corner, N2 at its second, and T along it
   type :: chain_t
      !> Whether these are the left blocks of a row that is its own mirror image. The last joint is
      !> then the plane of symmetry: smooth, and twice as stiff, as it opens half as wide
      logical :: halved = .false.
      !> Whether this plane runs through a block, whose left half is the last one and does not
      !> leave it
      logical :: keystone = .false.
      !> Centres of gravity: (2, n) [m]
      real(wp), allocatable :: centroid(:, :)
      !> Masses: (n) [kg/m]
      real(wp), allocatable :: mass(:)
      !> Moments of inertia about the centre: (n) [kg m]
      real(wp), allocatable :: inertia(:)
      !> Loads at the centre: (2, n) [N/m]
      real(wp), allocatable :: weight(:, :)
      !> Middles of the joints: (2, n + 1) [m]
      real(wp), allocatable :: middle(:, :)
      !> Unit vectors from their first corners to their second ones: (2, n + 1)
      real(wp), allocatable :: tangent(:, :)
      !> Half their lengths: (n + 1) [m]
      real(wp), allocatable :: half(:)
      !> Stiffness of each of the three springs of a joint: (n + 1) [N/m per metre depth]
      real(wp), allocatable :: stiffness(:)
      !> Compliance l/(E t) of the halves of the blocks on either side of a joint, l across it and t
      !> along it, or of one half on a plane of symmetry: (n + 1) [m2/N]
      real(wp), allocatable :: compliance(:)
      !> Coefficients of friction: (n + 1)
      real(wp), allocatable :: friction(:)
      !> Shear force that a joint carries without normal force; huge if it cannot slide:
      !> (n + 1) [N/m]
      real(wp), allocatable :: limit(:)
      !> Moments of unit forces along normal and tangent at a joint's middle about the centre of the
      !> block before it and of the block behind it: (2, 2, n + 1) [m]
      real(wp), allocatable :: arm(:, :, :)
      !> Mean mass of its blocks [kg/m]
      real(wp) :: mean_mass = 0.0_wp
      !> Sum of the sizes of the loads' components [N/m]
      real(wp) :: whole_load = 0.0_wp
      !> Largest acceleration of a block that falls freely [m/s2]
      real(wp) :: free_acceleration = 0.0_wp
      !> Largest stiffness of a spring [N/m per metre depth]
      real(wp) :: stiffest = 0.0_wp
   end type chain_t

contains

   !> A chain of n blocks without numbers
   pure subroutine new_chain(n, chain)
      !> Number of blocks
      integer, intent(in) :: n
      !> Any chain in; where it has as many blocks its arrays stay
      type(chain_t), intent(inout) :: chain

      chain%halved = .false.
      chain%keystone = .false.
      if (allocated(chain%mass)) then
         chain%stiffness = 0.0_wp
         chain%compliance = 0.0_wp
         if (size(chain%mass) == n) return
         chain = chain_t()
      end if
      allocate (chain%centroid(2, n), chain%mass(n), chain%inertia(n), chain%weight(2, n))
      allocate (chain%middle(2, n + 1), chain%tangent(2, n + 1), chain%half(n + 1))
      allocate (chain%stiffness(n + 1), chain%compliance(n + 1), source=0.0_wp)
      allocate (chain%friction(n + 1), chain%limit(n + 1))
      allocate (chain%arm(2, 2, n + 1))
   end subroutine new_chain

   !> Set the sums and bounds that depend on all blocks and joints, from these
   pure subroutine weigh(chain)
      type(chain_t), intent(inout) :: chain
      real(wp) :: mass, load, fastest, stiffest
      integer :: b, n

      n = size(chain%mass)
      mass = 0.0_wp
      load = 0.0_wp
      fastest = 0.0_wp
      stiffest = chain%stiffness(n + 1)
      do b = 1, n
         mass = mass + chain%mass(b)
         load = load + abs(chain%weight(1, b)) + abs(chain%weight(2, b))
         fastest = max(fastest, (chain%weight(1, b)**2 + chain%weight(2, b)**2)/chain%mass(b)**2)
         stiffest = max(stiffest, chain%stiffness(b))
      end do
      chain%mean_mass = mass/real(n, wp)
      chain%whole_load = load
      chain%free_acceleration = sqrt(fastest)
      chain%stiffest = stiffest
   end subroutine weigh
end module dda_chain
