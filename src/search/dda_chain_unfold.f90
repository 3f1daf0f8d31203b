!> Expand the result of a half model by symmetry
module dda_chain_unfold
   use dda_chain, only : chain_t
   use dda_friction_cone, only : joint_face_t
   use dda_kinds, only : wp
   use dda_search, only : decision_t
   implicit none
   private

   public :: fold, unfold

contains

   !> Make the decision of a halved chain that of the whole one; any other stays as it is. A smooth
   !> plane of symmetry is the joint there, which does not slide and opens on both sides
   elemental subroutine unfold(decision)
      type(decision_t), intent(inout) :: decision
      type(joint_face_t), allocatable :: face(:)
      integer :: m, n

      if (.not. decision%halved) return
      n = whole_joints(decision)
      decision%halved = .false.
      associate (contacts => decision%contacts, outcome => decision%outcome)
         m = size(contacts%face)
         if (decision%keystone) then
            m = m - 1
         else
            contacts%face(m)%slip = 0
            if (allocated(contacts%increment)) contacts%increment(1:2, m) = &
               & 2.0_wp*contacts%increment(1:2, m)
            contacts%gap(1:2, m) = 2.0_wp*contacts%gap(1:2, m)
            if (allocated(contacts%increment)) contacts%increment(3, m) = 0.0_wp
            contacts%gap(3, m) = 0.0_wp
         end if
         allocate (face(n))
         face(:m) = contacts%face(:m)
         face(n:n - m + 1:-1)%open(1) = contacts%face(:m)%open(1)
         face(n:n - m + 1:-1)%open(2) = contacts%face(:m)%open(2)
         face(n:n - m + 1:-1)%slip = -contacts%face(:m)%slip
         call move_alloc(face, contacts%face)
         call mirror(m, n, [1.0_wp, 1.0_wp, -1.0_wp], contacts%gap)
         call mirror(m, n, [1.0_wp, 1.0_wp, -1.0_wp], contacts%increment)
         call mirror(m, n, [1.0_wp, 1.0_wp, -1.0_wp], contacts%force)
         if (.not. allocated(outcome%motion)) return
         ! a keystone moves up or down alone
         if (decision%keystone) outcome%motion(:, m) = outcome%motion(:, m)*[0.0_wp, 1.0_wp, 0.0_wp]
         call mirror(size(outcome%motion, 2), n - 1, [-1.0_wp, 1.0_wp, -1.0_wp], outcome%motion)
      end associate
   end subroutine unfold

   !> Faces of the left half of a collapse that was decided as a whole
   pure subroutine fold(chain, decision, face)
      type(chain_t), intent(in) :: chain                       !! Half the chain
      type(decision_t), intent(in) :: decision
      type(joint_face_t), allocatable, intent(out) :: face(:)  !! Faces of its joints: (m)
      integer :: m

      m = size(chain%joint)
      allocate (face(m), source=decision%contacts%face(:m))
      if (chain%keystone) face(m) = joint_face_t()
   end subroutine fold

   !> Number of joints that a decision is of, folded or not
   elemental integer function whole_joints(decision)
      type(decision_t), intent(in) :: decision

      whole_joints = size(decision%contacts%face)
      if (.not. decision%halved) return
      whole_joints = 2*whole_joints - merge(2, 1, decision%keystone)
   end function whole_joints

   !> Mirror the columns of the left half
   pure subroutine mirror(m, n, sign, value)
      !> Columns of the left half that count, with that on the plane of symmetry if there is one
      integer, intent(in) :: m
      !> Columns of the whole
      integer, intent(in) :: n
      !> Signs of the mirror image: (3)
      real(wp), intent(in) :: sign(3)
      !> The columns of the left half in, of the whole out, if there are any:
      !> (3, at least m), (3, n)
      real(wp), allocatable, intent(inout) :: value(:, :)
      real(wp), allocatable :: whole(:, :)
      integer :: j

      if (.not. allocated(value)) return
      allocate (whole(3, n))
      do j = 1, m
         whole(:, n + 1 - j) = sign*value(:, j)
         whole(:, j) = value(:, j)
      end do
      call move_alloc(whole, value)
   end subroutine mirror
end module dda_chain_unfold
