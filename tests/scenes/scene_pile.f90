!> Bricks dropped into a box or on a floor, and how deep they lie in one another
module scene_pile
   use dda_forward, only : run_to_verdict
   use dda_frames, only : album_t
   use dda_kinds, only : wp
   use dda_material, only : joint_law_t
   use dda_scene, only : scene_t
   use dda_settings, only : flow_rule, verdict
   use dda_step_context, only : march_t
   use dda_verdict, only : outcome_t
   use random_numbers, only : draw, random_t
   use scene_model, only : add_block, model_t, rectangle, searched_scene, turned
   implicit none
   private

   public :: pile_t, record_t, pile_scene, watch_step, deepest_entry

   !> What is dropped
   type :: pile_t
      integer :: columns = 5                    !! Bricks in a row
      integer :: rows = 5                       !! Rows
      integer :: seed = 20080301                !! Number that the places and turns are drawn with
      integer :: n_dof = 3                      !! Unknowns of a block
      real(wp) :: brick(2) = [0.25_wp, 0.1_wp]  !! Length and height of a brick: (2) [m]
      real(wp) :: spread = 0.0_wp               !! Share by which sizes differ
      real(wp) :: friction = 0.6_wp             !! Coefficient of friction
      real(wp) :: restitution = 0.0_wp          !! Restitution
      real(wp) :: time_step = 2.0e-3_wp         !! Length of a step [s]
      real(wp) :: duration = 1.8_wp             !! End of the run [s]
      logical :: walls = .true.                 !! True if walls stand beside the floor
   end type pile_t

   !> What has been seen of a run
   type :: record_t
      type(march_t) :: march                   !! Where it is
      integer :: verdict = 0                   !! One of verdict
      character(len=:), allocatable :: reason  !! Why it cannot go on
      !> Energy of the blocks without motion, if all fell to the level of the floor [J/m]
      real(wp) :: fall = 0.0_wp
      real(wp) :: total = 0.0_wp  !! Energy after the last step: kinetic, elastic and gravity [J/m]
      real(wp) :: rise = -huge(1.0_wp)  !! Largest rise of it in a step [J/m]
      real(wp) :: peak = 0.0_wp  !! Largest energy of motion [J/m]
      real(wp) :: entry = 0.0_wp  !! Deepest that a block has been in another after a step [m]
      !> Farthest that a joint's force has been outside its cone, over the weight of all blocks
      real(wp) :: outside = 0.0_wp
      integer :: factorisations = 0  !! Factorisations
   end type record_t

contains

   !> Go on by one step and see what has changed
   subroutine watch_step(scene, record, ended)
      type(scene_t), intent(inout) :: scene
      type(record_t), intent(inout) :: record  !! What has been seen, new at the beginning
      logical, intent(out) :: ended            !! True if the run is at its end or cannot go on
      type(outcome_t) :: outcome
      type(album_t) :: album

      associate (system => scene%system)
         if (record%march%steps == 0) then
            record%fall = sum(system%unit_weight*system%area*system%centroid(2, :), &
               & mask=system%equation > 0)
            record%total = record%fall + sum(system%density*(system%area &
               & *sum(system%velocity(1:2, :)**2, dim=1) + sum(system%second(1:2, :), dim=1) &
               & *system%velocity(3, :)**2))/2.0_wp
         end if
         scene%settings%max_steps = record%march%steps + 1
         call run_to_verdict(scene%settings, system, scene%contacts, outcome, album, record%march)
         associate (e => record%march%energy)
            record%rise = max(record%rise, record%fall + e%kinetic + e%elastic + e%gravity &
               & - record%total)
            record%total = record%fall + e%kinetic + e%elastic + e%gravity
            record%peak = max(record%peak, e%kinetic)
         end associate
         record%entry = max(record%entry, deepest_entry(system%first_vertex, system%moved))
         record%outside = max(record%outside, farthest_outside(scene)/sum(system%unit_weight &
            & *system%area, mask=system%equation > 0))
      end associate
      record%verdict = outcome%verdict
      record%factorisations = record%factorisations + outcome%factorisations
      ended = record%verdict == verdict%completed
      if (ended) return
      record%reason = outcome%reason
      ended = index(outcome%reason, "step limit") == 0
   end subroutine watch_step

   !> Turned bricks in rows above a floor
   function pile_scene(pile) result(scene)
      type(pile_t), intent(in) :: pile  !! Pile that is dropped
      type(scene_t) :: scene            !! The scene; the first blocks are the floor and the walls
      type(model_t) :: model
      type(random_t) :: random
      real(wp) :: number(5), side(2), cell, width, height, beyond
      integer :: i, j

      random%state = pile%seed
      cell = 2.0_wp*maxval(pile%brick)*(1.0_wp + pile%spread)
      width = cell*real(pile%columns, wp)
      height = 0.75_wp*cell*real(pile%rows, wp)
      model%unit_weight = model%material%density*9.81_wp
      model%settings%n_dof = pile%n_dof
      model%settings%dynamic = .true.
      model%settings%current = .true.
      model%settings%flow = flow_rule%coulomb
      model%settings%time_step = pile%time_step
      model%settings%duration = pile%duration
      model%settings%restitution = pile%restitution
      model%settings%max_steps = 1000000
      beyond = merge(0.6_wp*cell, 0.6_wp*cell + height, pile%walls)
      call add_block(model, rectangle([-beyond, -0.4_wp*cell], width + 2.0_wp*beyond, &
         & 0.4_wp*cell), fixed=.true.)
      if (pile%walls) then
         call add_block(model, rectangle([-cell, -0.4_wp*cell], 0.4_wp*cell, &
            & 6.0_wp*cell + height), fixed=.true.)
         call add_block(model, rectangle([width + 0.6_wp*cell, -0.4_wp*cell], 0.4_wp*cell, &
            & 6.0_wp*cell + height), fixed=.true.)
      end if
      do j = 1, pile%rows
         do i = 1, pile%columns
            call draw(random, number)
            side = pile%brick*(1.0_wp + pile%spread*number(4:5))
            call add_block(model, turned(rectangle(-side/2.0_wp, side(1), side(2)), &
               & 3.14_wp*number(1)) + spread([cell*(real(i, wp) - 0.5_wp + 0.16_wp*number(2)), &
               & 0.7_wp*cell*(real(j, wp) + 0.1_wp*number(3))], 2, 4))
         end do
      end do
      scene = searched_scene(model, joint_law_t(friction=pile%friction))
      ! a corner may pass another by so much inside
      scene%contacts%search%tolerance = 1.0e-6_wp
   end function pile_scene

   !> Farthest that the force of a joint is outside its cone, in tension or in shear [N/m]
   pure real(wp) function farthest_outside(scene)
      type(scene_t), intent(in) :: scene  !! The scene after a step
      integer :: j

      farthest_outside = 0.0_wp
      associate (force => scene%contacts%force, cone => scene%contacts%springs%cone)
         do j = 1, size(cone)
            farthest_outside = max(farthest_outside, -force(1, j), -force(2, j), abs(force(3, j)) &
               & - cone(j)%limit - cone(j)%friction*(force(1, j) + force(2, j)))
         end do
      end associate
   end function farthest_outside

   !> How deep two convex blocks lie in one another at most: the shortest way out of the pair that
   !> has the longest; negative if all are apart [m]
   pure real(wp) function deepest_entry(first_vertex, vertex)
      !> First vertex of each block, and one beyond the last: (n_block + 1)
      integer, intent(in) :: first_vertex(:)
      real(wp), intent(in) :: vertex(:, :)  !! Corners, counter-clockwise: (2, n_vertex) [m]
      real(wp) :: low(2, size(first_vertex) - 1), high(2, size(first_vertex) - 1)
      integer :: a, b

      do a = 1, size(low, 2)
         low(:, a) = minval(vertex(:, first_vertex(a):first_vertex(a + 1) - 1), dim=2)
         high(:, a) = maxval(vertex(:, first_vertex(a):first_vertex(a + 1) - 1), dim=2)
      end do
      deepest_entry = -huge(deepest_entry)
      do a = 1, size(low, 2)
         do b = a + 1, size(low, 2)
            if (any(low(:, a) > high(:, b)) .or. any(low(:, b) > high(:, a))) cycle
            associate (one => vertex(:, first_vertex(a):first_vertex(a + 1) - 1), &
               & other => vertex(:, first_vertex(b):first_vertex(b + 1) - 1))
               deepest_entry = max(deepest_entry, -max(apart(one, other), apart(other, one)))
            end associate
         end do
      end do
   end function deepest_entry

   !> How far a polygon lies beyond an edge of another, at best [m]
   pure real(wp) function apart(one, other)
      !> Corners of the polygon with the edges, counter-clockwise: (2, n) [m]
      real(wp), intent(in) :: one(:, :)
      real(wp), intent(in) :: other(:, :)  !! Corners of the other: (2, m) [m]
      real(wp) :: edge(2), nearest
      integer :: i, k

      apart = -huge(apart)
      do i = 1, size(one, 2)
         edge = one(:, modulo(i, size(one, 2)) + 1) - one(:, i)
         nearest = huge(nearest)
         do k = 1, size(other, 2)
            nearest = min(nearest, edge(2)*(other(1, k) - one(1, i)) &
               & - edge(1)*(other(2, k) - one(2, i)))
         end do
         apart = max(apart, nearest/norm2(edge))
      end do
   end function apart
end module scene_pile
