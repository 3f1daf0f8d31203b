!> Models of Shi's scheme built block by block
module scene_limerick
   use dda_boundary, only : held_point_t
   use dda_kinds, only : wp
   use dda_limerick_model, only : limerick_material_t, limerick_model_t
   use dda_material, only : joint_law_t
   implicit none
   private

   public :: empty_model, add_block, hold, box, rotated

contains

   !> A model without blocks: one material of 2000 kg/m3 in gravity of 10 m/s2, one law
   pure function empty_model(friction) result(model)
      real(wp), intent(in) :: friction  !! Coefficient of friction
      type(limerick_model_t) :: model
      type(limerick_material_t) :: material
      type(joint_law_t) :: law

      material%density = 2000.0_wp
      material%unit_weight = 20000.0_wp
      material%young = 1.0e9_wp
      law%friction = friction
      allocate (model%material(1), source=material)
      allocate (model%law(1, 1), source=law)
      allocate (model%first_vertex(1), source=1)
      allocate (model%vertex(2, 0), model%edge_law(0), model%block_material(0), model%kind(0))
      allocate (model%boundary%held(0), model%boundary%loaded(0), model%boundary%measured(0))
   end function empty_model

   !> Add a block
   pure subroutine add_block(model, vertex)
      type(limerick_model_t), intent(inout) :: model
      real(wp), intent(in) :: vertex(:, :)  !! Its corners, counter-clockwise: (2, n) [m]
      real(wp), allocatable :: all_vertices(:, :)
      integer :: n

      n = size(model%vertex, 2)
      allocate (all_vertices(2, n + size(vertex, 2)))
      all_vertices(:, :n) = model%vertex
      all_vertices(:, n + 1:) = vertex
      call move_alloc(all_vertices, model%vertex)
      n = size(model%vertex, 2)
      model%first_vertex = [model%first_vertex, n + 1]
      model%block_material = [model%block_material, 1]
      model%kind = [model%kind, 1]
      deallocate (model%edge_law)
      allocate (model%edge_law(n), source=1)
   end subroutine add_block

   !> Hold the last block at all its corners
   pure subroutine hold(model)
      type(limerick_model_t), intent(inout) :: model
      type(held_point_t), allocatable :: held(:)
      integer :: block, n, first, i

      block = size(model%block_material)
      first = model%first_vertex(block)
      n = size(model%boundary%held)
      allocate (held(n + size(model%vertex, 2) - first + 1))
      held(:n) = model%boundary%held
      held(n + 1:)%block = block
      do i = 1, 2
         held(n + 1:)%point(i) = model%vertex(i, first:)
      end do
      call move_alloc(held, model%boundary%held)
   end subroutine hold

   !> A rectangle
   pure function box(low, high) result(vertex)
      real(wp), intent(in) :: low(2)   !! Lower left corner: (2) [m]
      real(wp), intent(in) :: high(2)  !! Upper right corner: (2) [m]
      real(wp) :: vertex(2, 4)         !! Corners, counter-clockwise: (2, 4) [m]

      vertex = reshape([low, high(1), low(2), high, low(1), high(2)], [2, 4])
   end function box

   !> Points turned about the origin
   pure function rotated(vertex, angle) result(now)
      real(wp), intent(in) :: vertex(:, :)  !! The points: (2, n) [m]
      real(wp), intent(in) :: angle         !! Anticlockwise angle [rad]
      real(wp) :: now(2, size(vertex, 2))   !! The points: (2, n) [m]

      now(1, :) = cos(angle)*vertex(1, :) - sin(angle)*vertex(2, :)
      now(2, :) = sin(angle)*vertex(1, :) + cos(angle)*vertex(2, :)
   end function rotated
end module scene_limerick
