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
      real(wp) :: tangent(2) = 0.0_wp  !! Unit vector from its first corner to its second: (2)
      real(wp) :: half = 0.0_wp        !! Half its length [m]
      !> Stiffness of each of its three springs [N/m per metre depth]
      real(wp) :: stiffness = 0.0_wp
      !> Compliance l/(E t) of the half blocks on either side, l across the joint and t along it; of
      !> one half block on a plane of symmetry [m2/N]
      real(wp) :: compliance = 0.0_wp
      real(wp) :: friction = 0.0_wp  !! Coefficient of friction
      logical :: no_slip = .false.   !! True if it cannot slide
      !> Moments about the centres of the blocks before and after the joint, of unit forces along
      !> its normal and tangent at its middle: (2, 2) [m]
      real(wp) :: arm(2, 2) = 0.0_wp
   end type chain_joint_t

   !> Blocks from left to right; joint j precedes block j, the last joint follows the last block
   type :: chain_t
      !> True for the left half of a symmetric row. The last joint is then the plane of symmetry:
      !> frictionless, and twice as stiff, because it opens half as wide
      logical :: halved = .false.
      !> True if this plane divides a block. Its left half is then the last block and cannot
      !> separate from the plane
      logical :: keystone = .false.
      type(chain_block_t), allocatable :: block(:)  !! Its blocks: (n)
      type(chain_joint_t), allocatable :: joint(:)  !! Its joints: (n + 1)
      real(wp) :: whole_load = 0.0_wp  !! Sum of the absolute components of the loads [N/m]
      real(wp) :: reach = 0.0_wp  !! Largest coordinate of the middle of a joint [m]
   end type chain_t

contains

   !> Prepare a chain of n blocks without values
   pure subroutine new_chain(n, chain)
      integer, intent(in) :: n               !! Number of blocks
      type(chain_t), intent(inout) :: chain  !! Arrays of the same size are reused

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
