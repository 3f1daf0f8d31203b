!> Where a step takes the blocks, and what it leaves behind (Shi: df24, df25)
submodule (dda_limerick_step) dda_limerick_update
   use dda_limerick_assembly, only : bolt_elongation, n_bolts
   use dda_limerick_model, only : measure_blocks
   use dda_material, only : elasticity_matrix
   implicit none

contains

   !> Corners at the end of the step, and how far the one that moves most goes (Shi
   module procedure move_vertices
      real(wp) :: farthest, step(2), turn(2)
      integer :: b, v

      farthest = 0.0_wp
      do b = 1, size(blocks%area)
         turn = turning(model, motion(3, b))
         do v = blocks%first_vertex(b), blocks%first_vertex(b + 1) - 1
            step = displacement(motion(:, b), turn, &
               & blocks%vertex(1, v) - blocks%centroid(1, b), &
               & blocks%vertex(2, v) - blocks%centroid(2, b))
            moved(:, v) = blocks%vertex(:, v) + step
            farthest = max(farthest, step(1)**2 + step(2)**2)
         end do
      end do
      march%displacement_ratio = sqrt(farthest) &
         & /(march%half_size*model%constants%max_displacement_ratio)
   end procedure move_vertices

   !> What a rotation does to an arm: along it and across it
   pure function turning(model, angle) result(turn)
      type(limerick_model_t), intent(in) :: model
      real(wp), intent(in) :: angle  !! The rotation [rad]
      real(wp) :: turn(2)            !! Parts of the arm's change along it and across it: (2)

      turn = [0.0_wp, angle]
      if (model%constants%exact_rotation) turn = [cos(angle) - 1.0_wp, sin(angle)]
   end function turning

   !> Displacement of a point of a block
   pure function displacement(motion, turn, x, y) result(step)
      !> Unknowns of the block: (6)
      real(wp), intent(in) :: motion(6)
      !> What its rotation does to an arm along it and across it: (2)
      real(wp), intent(in) :: turn(2)
      !> Arm of the point along x [m]
      real(wp), intent(in) :: x
      !> Arm of the point along y [m]
      real(wp), intent(in) :: y
      !> The displacement: (2) [m]
      real(wp) :: step(2)

      step(1) = motion(1) + turn(1)*x - turn(2)*y + motion(4)*x + motion(6)*y/2.0_wp
      step(2) = motion(2) + turn(2)*x + turn(1)*y + motion(5)*y + motion(6)*x/2.0_wp
   end function displacement

   !> What an accepted step leaves behind (Shi
   module procedure update
      real(wp), allocatable :: before(:, :)
      real(wp) :: step(2)
      integer :: b, i

      do i = 1, size(model%boundary%held)
         step = point_step(blocks%fixed_point(:, i), model%boundary%held(i)%block)
         blocks%fixed_point(:, i) = blocks%fixed_point(:, i) + step
         blocks%fixed_drift(:, i) = blocks%fixed_drift(:, i) + step
      end do
      do i = 1, size(model%boundary%loaded)
         blocks%load_point(:, i) = blocks%load_point(:, i) &
            & + point_step(blocks%load_point(:, i), model%boundary%loaded(i)%block)
      end do
      do i = 1, size(model%boundary%measured)
         blocks%measured_point(:, i) = blocks%measured_point(:, i) &
            & + point_step(blocks%measured_point(:, i), model%boundary%measured(i)%block)
      end do
      do i = 1, n_bolts(model)
         associate (bolt => model%boundary%bar(i))
            blocks%bolt_force(i) = blocks%bolt_force(i) &
               & + bolt%stiffness*bolt_elongation(model, blocks, i, motion)
            do b = 1, 2
               if (bolt%block(b) > 0) blocks%bolt_point(:, b, i) = blocks%bolt_point(:, b, i) &
                  & + point_step(blocks%bolt_point(:, b, i), bolt%block(b))
            end do
         end associate
      end do
      do b = 1, size(blocks%area)
         blocks%stress(:, b) = blocks%stress(:, b) + matmul(elasticity_matrix( &
            & model%material(model%block_material(b))%material_t), motion(4:6, b))
         blocks%velocity(:, b) = 2.0_wp/march%time_step*motion(:, b) - blocks%velocity(:, b)
      end do
      blocks%rotation = blocks%rotation + motion(3, :)
      call move_alloc(blocks%vertex, before)
      call move_alloc(moved, blocks%vertex)
      call move_alloc(before, moved)
      call measure_blocks(blocks)
      march%time = march%time + march%time_step
      march%steps = march%steps + 1

   contains

      !> Displacement of a point in the step
      pure function point_step(point, block) result(step)
         real(wp), intent(in) :: point(2)  !! The point at the beginning of the step: (2) [m]
         integer, intent(in) :: block      !! Its block
         real(wp) :: step(2)

         step = displacement(motion(:, block), &
            & turning(model, motion(3, block)), &
            & point(1) - blocks%centroid(1, block), point(2) - blocks%centroid(2, block))
      end function point_step
   end procedure update

end submodule dda_limerick_update
