!> Rigid blocks in a row between two fixed ones: the model of single-ring arches
module dda_chain
   use dda_kinds, only : wp
   implicit none
   private

   public :: chain_block_t, chain_joint_t, chain_t, new_chain

   !> A block of a chain
   type :: chain_block_t
      real(wp) :: centroid(2) = 0.0_wp  !! Centre of gravity: (2) [m]
      real(wp) :: mass = 0.0_wp         !! Mass [kg/m]
      real(wp) :: inertia = 0.0_wp      !! Moment of inertia about the centre [kg m]
      real(wp) :: weight(2) = 0.0_wp    !! Load at the centre: (2) [N/m]
   end type chain_block_t

   !> A joint of a chain; its force is N1 at its first corner, N2 at its second, and T along it
   type :: chain_joint_t
      real(wp) :: middle(2) = 0.0_wp   !! Its middle: (2) [m]
      real(wp) :: tangent(2) = 0.0_wp  !! Unit vector from its first corner to its second one: (2)
      real(wp) :: half = 0.0_wp        !! Half its length [m]
      !> Stiffness of each of its three springs [N/m per metre depth]
      real(wp) :: stiffness = 0.0_wp
      !> Compliance l/(E t) of the halves of the blocks on either side of it, l across it and t
      !> along it, or of one half on a plane of symmetry [m2/N]
      real(wp) :: compliance = 0.0_wp
      real(wp) :: friction = 0.0_wp  !! Coefficient of friction
      logical :: no_slip = .false.   !! Whether it cannot slide
      !> Moments of unit forces along normal and tangent at its middle about the centre of the block
      !> before it and of the block behind it: (2, 2) [m]
      real(wp) :: arm(2, 2) = 0.0_wp
   end type chain_joint_t

   !> Blocks from left to right; joint j is the one before block j, the last joint is behind the
   !> last block
   type :: chain_t
      !> Whether these are the left blocks of a row that is its own mirror image. The last joint is
      !> then the plane of symmetry: smooth, and twice as stiff, as it opens half as wide
      logical :: halved = .false.
      !> Whether this plane runs through a block, whose left half is the last one and does not
      !> leave it
      logical :: keystone = .false.
      !> Its blocks: (n)
      type(chain_block_t), allocatable :: block(:)
      !> Its joints: (n + 1)
      type(chain_joint_t), allocatable :: joint(:)
      !> Sum of the sizes of the loads' components [N/m]
      real(wp) :: whole_load = 0.0_wp
      !> Farthest that the middle of a joint is from the origin, along one axis [m]
      real(wp) :: reach = 0.0_wp
   end type chain_t

contains

   !> A chain of n blocks without numbers
   pure subroutine new_chain(n, chain)
      integer, intent(in) :: n  !! Number of blocks
      !> Any chain in; where it has as many blocks its arrays stay
      type(chain_t), intent(inout) :: chain

      chain%halved = .false.
      chain%keystone = .false.
      chain%whole_load = 0.0_wp
      chain%reach = 0.0_wp
      if (allocated(chain%block)) then
         if (size(chain%block) /= n) deallocate (chain%block, chain%joint)
      end if
      if (.not. allocated(chain%block)) allocate (chain%block(n), chain%joint(n + 1))
   end subroutine new_chain
end module dda_chain
