!> The model of the original program that a file of blocks describes
module dda_limerick_blocks
   use dda_block_input, only : block_plan_t
   use dda_boundary, only : boundary_t, held_point_t
   use dda_error, only : error_t, fatal_error
   use dda_kinds, only : wp
   use dda_limerick_model, only : limerick_model_t
   use dda_scene, only : scene_t
   use dda_text, only : to_text
   implicit none
   private

   public :: blocks_model, check_limerick_blocks, inner_points

   !> Where the points are that hold a block: this share of the way from its corners to their middle
   real(wp), parameter :: inset = 0.3_wp

contains

   !> The model of a plan's blocks, without its constants. Every block has a material of its own,
   !> for its stress and velocity are its own; the first material, which the first step looks at,
   !> is that of a block that moves
   pure subroutine blocks_model(plan, scene, model)
      type(block_plan_t), intent(in) :: plan
      type(scene_t), intent(in) :: scene
      !> The model; its parts but for the direction of the weight are set
      type(limerick_model_t), intent(inout) :: model
      integer :: b, n

      n = size(plan%fixed)
      allocate (model%first_vertex, source=plan%first_vertex)
      allocate (model%vertex, source=plan%vertex)
      allocate (model%law, source=scene%contacts%search%law)
      allocate (model%kind, source=plan%material)
      allocate (model%edge_law(size(plan%vertex, 2)))
      allocate (model%material(n + 1), model%block_material(n))
      do b = 1, n
         model%edge_law(plan%first_vertex(b):plan%first_vertex(b + 1) - 1) = plan%material(b)
         model%block_material(b) = b + 1
         associate (material => model%material(b + 1))
            material%material_t = scene%system%materials(plan%material(b))
            material%unit_weight = scene%system%unit_weight(b)
         end associate
      end do
      do b = 1, size(plan%starts)
         associate (block => plan%starts(b), material => model%material(plan%starts(b) + 1))
            material%stress = plan%start(4:, b)
            if (.not. plan%fixed(block)) material%velocity = plan%start(:3, b)
         end associate
      end do
      model%material(1) = model%material(1 + max(1, findloc(plan%fixed, .false., dim=1)))
      model%loads_go_on = .false.
      model%boundary = scene%settings%boundary
      call take_points(plan, scene%settings%load_factor, model%boundary)
   end subroutine blocks_model

   !> The plan's points, and those that hold its fixed blocks
   pure subroutine take_points(plan, load_factor, boundary)
      type(block_plan_t), intent(in) :: plan
      !> What live loads are multiplied by
      real(wp), intent(in) :: load_factor
      !> The points of the scene, which may be more than the plan's
      type(boundary_t), intent(inout) :: boundary
      type(held_point_t), allocatable :: held(:)
      integer :: b, i, n, v

      if (.not. allocated(boundary%held)) allocate (boundary%held(0))
      if (.not. allocated(boundary%loaded)) allocate (boundary%loaded(0))
      if (.not. allocated(boundary%measured)) allocate (boundary%measured(0))
      do i = 1, size(boundary%loaded)
         if (boundary%loaded(i)%live) &
            & boundary%loaded(i)%force%value = load_factor*boundary%loaded(i)%force%value
      end do
      n = size(boundary%held)
      allocate (held(n + size(plan%vertex, 2)))
      held(:n) = boundary%held
      do b = 1, size(plan%fixed)
         if (.not. plan%fixed(b)) cycle
         associate (first => plan%first_vertex(b), last => plan%first_vertex(b + 1) - 1)
            held(n + 1:n + 1 + last - first)%block = b
            do v = 1, 2
               held(n + 1:n + 1 + last - first)%point(v) = inner_points(plan%vertex(v, first:last))
            end do
            n = n + 1 + last - first
         end associate
      end do
      boundary%held = held(:n)
   end subroutine take_points

   !> Coordinates of the points that hold a block: its corners, moved towards their middle
   pure function inner_points(corner) result(point)
      real(wp), intent(in) :: corner(:)  !! A coordinate of all corners: (n) [m]
      real(wp) :: point(size(corner))    !! That of the points: (n) [m]

      point = (1.0_wp - inset)*corner + inset*sum(corner)/real(size(corner), wp)
   end function inner_points

   !> Whether Shi's scheme can run a plan: it holds points where they are, in both
   !> directions, knows no motion of the ground, and begins every static step at rest
   pure subroutine check_limerick_blocks(plan, file, dynamic, error)
      type(block_plan_t), intent(in) :: plan
      character(len=*), intent(in) :: file              !! Name of its file
      logical, intent(in) :: dynamic                    !! Whether velocities are kept
      type(error_t), allocatable, intent(out) :: error  !! What it cannot do
      integer :: b, i

      if (allocated(plan%boundary%base_acceleration%time)) then
         call fatal_error(error, "mode = 'limerick' knows no motion of the ground; remove it or " &
            & //"choose mode = 'dynamic'", file, plan%ground_line)
         return
      end if
      if (allocated(plan%boundary%absorbing)) then
         call fatal_error(error, "mode = 'limerick' knows no absorbing faces; remove this line " &
            & //"or choose mode = 'dynamic'", file, plan%boundary%absorbing(1)%line)
         return
      end if
      do i = 1, size(plan%starts)
         if (dynamic .or. .not. any(abs(plan%start(:3, i)) > 0.0_wp)) cycle
         b = plan%starts(i)
         call fatal_error(error, "mode = 'limerick' begins every static step at rest, but block " &
            & //to_text(b)//" has a velocity; remove it or set limerick%dynamic = .true.", file, &
            & plan%line(b))
         return
      end do
      if (.not. allocated(plan%boundary%held)) return
      do i = 1, size(plan%boundary%held)
         associate (held => plan%boundary%held(i))
            if (allocated(held%path%time)) then
               call fatal_error(error, "mode = 'limerick' holds points where they are and moves " &
                  & //"none; remove the displacement or choose another mode", file, held%line)
            else if (.not. all(held%along)) then
               call fatal_error(error, "mode = 'limerick' holds points along x and y; hold this " &
                  & //"one so or choose another mode", file, held%line)
            end if
         end associate
         if (allocated(error)) return
      end do
   end subroutine check_limerick_blocks
end module dda_limerick_blocks
