!> Distribution of the reactions of one block to its supports
submodule (dda_force_rows) dda_reaction_shares
   use dda_deformation, only : moved_point
   use dda_outer_loads, only : outer_loads
   use dda_reactions, only : force_on
   use dda_settings, only : load_direction
   use dda_small_systems, only : least_squares
   use dda_submatrices, only : body_load
   use dda_vector, only : cross
   implicit none

   !> Remainder below which a column is dependent, over the largest
   real(wp), parameter :: negligible = 1.0e-10_wp

contains

   !> Reactions of the points of a block
   module procedure share_among_points
      real(wp) :: wanted(3), place(2), size_of
      real(wp), allocatable :: column(:, :), force(:)
      integer, allocatable :: owner(:)
      integer :: axis, i, n, side

      wanted = -outer_force(settings, system, time, block)
      do i = 1, size(contacts%joint)
         associate (joint => contacts%joint(i))
            do side = 1, 2
               if (joint%block(side) == block) wanted = wanted &
                  & - force_on(joint_place(system, contacts, i), contacts%force(:, i), side)
            end do
         end associate
      end do
      allocate (column(3, 2*size(support, 2)), owner(2*size(support, 2)))
      n = 0
      do i = 1, size(support, 2)
         if (support(1, i) /= block .or. support(2, i) == 0) cycle
         associate (held => settings%boundary%held(support(2, i)))
            place = held%point
            if (settings%current) place = moved_point(held%point, system%centroid(:, block), &
               & system%motion(:, block))
            do axis = 1, 2
               if (.not. held%along(axis)) cycle
               n = n + 1
               owner(n) = i
               column(:, n) = merge([1.0_wp, 0.0_wp, -place(2)], [0.0_wp, 1.0_wp, place(1)], &
                  & axis == 1)
            end do
         end associate
      end do
      ! moments are about the block, in units of its size: the least forces do not depend on the
      ! origin
      place = system%centroid(:, block)
      size_of = sqrt(system%area(block))
      do i = 1, n
         column(:, i) = moved(column(:, i), place, size_of)
      end do
      force = least_forces(column(:, :n), moved(wanted, place, size_of))
      do i = 1, n
         column(3, i) = size_of*column(3, i) + place(1)*column(2, i) - place(2)*column(1, i)
         reaction(:, owner(i)) = reaction(:, owner(i)) + force(i)*column(:, i)
      end do
   end procedure share_among_points

   !> A force with its moment about another point, in units of a length
   pure function moved(wrench, place, length) result(seen)
      real(wp), intent(in) :: wrench(3)  !! Force, and moment about the origin: (3)
      real(wp), intent(in) :: place(2)   !! The point: (2) [m]
      real(wp), intent(in) :: length     !! The length [m]
      real(wp) :: seen(3)                !! The same with the other moment: (3)

      seen = [wrench(1:2), (wrench(3) - cross(place, wrench(1:2)))/length]
   end function moved

   !> The least forces with a given sum: x = A' y with A A' y = b
   pure function least_forces(a, b) result(x)
      real(wp), intent(in) :: a(:, :)  !! Force and moment of each on the block: (3, n)
      real(wp), intent(in) :: b(3)     !! The sum: (3)
      real(wp) :: x(size(a, 2))        !! The forces: (n)

      x = matmul(least_squares(matmul(a, transpose(a)), b, negligible), a)
      ! once more, for what rounding has left
      x = x + matmul(least_squares(matmul(a, transpose(a)), b - matmul(a, x), negligible), a)
   end function least_forces

   !> Sum of all loads on a block, and their moment about the origin of coordinates
   pure function outer_force(settings, system, time, block) result(wrench)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system
      real(wp), intent(in) :: time
      integer, intent(in) :: block  !! The block, which can move
      real(wp) :: wrench(3)         !! Force and moment: (3) [N/m, N/m, N]
      real(wp) :: weight(3, maxval(system%equation)), of_block(6)
      real(wp), dimension(3, maxval(system%equation)) :: load, felt
      real(wp) :: place(2)
      integer :: b

      do b = 1, size(system%equation)
         if (system%equation(b) == 0) cycle
         of_block = body_load(system%unit_weight(b)*load_direction(settings), system%area(b))
         weight(:, system%equation(b)) = of_block(:3)
      end do
      call outer_loads(system, settings, time, 1.0_wp, weight, load, felt)
      wrench = load(:, system%equation(block))
      place = system%centroid(:, block)
      if (settings%current) place = place + system%motion(1:2, block)
      wrench(3) = wrench(3) + cross(place, wrench(1:2))
   end function outer_force
end submodule dda_reaction_shares
