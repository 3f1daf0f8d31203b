!> Groups of joints whose blocks hang together: each is a problem of its own
module dda_contact_groups
   use dda_contact_types, only : joint_springs_t
   use dda_sort, only : list_by_owner
   implicit none
   private

   public :: group_joints

contains

   !> Groups of joints whose blocks hang together
   pure subroutine group_joints(springs, n_equation, n, first, joint)
      type(joint_springs_t), intent(in) :: springs
      !> Number of movable blocks
      integer, intent(in) :: n_equation
      !> Number of groups
      integer, intent(out) :: n
      !> First joint of each group in the list, and one beyond the last: (n_joint + 1)
      integer, intent(out) :: first(:)
      !> The joints, group by group, rising in each: (n_joint)
      integer, allocatable, intent(out) :: joint(:)
      integer :: group(size(springs%equation, 2))

      call number_groups(springs, n_equation, n, group)
      first = size(group) + 1
      call list_by_owner(group, first(:n + 1), joint)
   end subroutine group_joints

   !> Which group each joint is of
   pure subroutine number_groups(springs, n_equation, n, group)
      type(joint_springs_t), intent(in) :: springs
      integer, intent(in) :: n_equation
      integer, intent(out) :: n
      integer, intent(out) :: group(:)  !! Number of each joint's group: (n_joint)
      integer :: root(n_equation), number(n_equation), pair(2), i, j

      root = [(i, i=1, n_equation)]
      do j = 1, size(group)
         pair = springs%equation(:, j)
         if (any(pair == 0)) cycle
         pair = [root_of(pair(1)), root_of(pair(2))]
         root(maxval(pair)) = minval(pair)
         root(springs%equation(:, j)) = minval(pair)
      end do
      n = 0
      number = 0
      do j = 1, size(group)
         i = root_of(maxval(springs%equation(:, j)))
         if (number(i) == 0) then
            n = n + 1
            number(i) = n
         end if
         group(j) = number(i)
      end do

   contains

      !> The block that stands for the group of a block
      pure integer function root_of(block)
         integer, intent(in) :: block  !! The block

         root_of = block
         do while (root(root_of) /= root_of)
            root_of = root(root_of)
         end do
      end function root_of
   end subroutine number_groups

end module dda_contact_groups
