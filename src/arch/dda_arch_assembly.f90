!> Arches as blocks: rings of voussoirs, spans, piers, buttresses and fixed springings
module dda_arch_assembly
   use dda_arch, only : springing
   use dda_arch_form, only : arch_form_t, form_problem_t
   use dda_block_input, only : block_plan_t, law_plan_t, material_plan_t, new_plan
   use dda_growth, only : make_room
   use dda_kinds, only : wp
   use dda_vector, only : cross
   implicit none
   private

   public :: arch_assembly_t, arch_sections, arch_sections_t, assemble_arch, n_movable, top_chord_t

   !> Sections of one span, from left to right
   type :: arch_sections_t
      real(wp), allocatable :: intrados(:, :)  !! Intrados: (2, n) [m]
      real(wp), allocatable :: extrados(:, :)  !! Extrados: (2, n) [m]
      logical, allocatable :: is_joint(:)      !! True for sections at joints: (n)
      real(wp) :: crown_x = 0.0_wp             !! Where the crown is along x [m]
   end type arch_sections_t

   !> A chord of an upper face, which fill may lie on
   type :: top_chord_t
      integer :: block = 0           !! Number of the block
      real(wp) :: left(2) = 0.0_wp   !! Its left end: (2) [m]
      real(wp) :: right(2) = 0.0_wp  !! Its right end: (2) [m]
      integer :: span = 0            !! Number of its span; 0 on a pier
   end type top_chord_t

   !> The blocks of an arch
   type :: arch_assembly_t
      !> Blocks: the voussoirs of each span, ring by ring, from left to right; then piers and
      !> buttresses from the ground up; then what is fixed
      type(block_plan_t) :: plan
      !> Chords of the upper faces of blocks that move: (n)
      type(top_chord_t), allocatable :: top(:)
      real(wp), allocatable :: crown_x(:)  !! Where the crown of each span is along x: (n_span) [m]
      integer :: n_voussoir = 0            !! Number of voussoirs
      real(wp) :: springing_y = 0.0_wp     !! Height of the left springing of the intrados [m]
      !> Numbers of blocks, corners and chords as they are added
      integer :: n_block = 0, n_vertex = 0, n_top = 0
   end type arch_assembly_t

   !> Material number of supports
   integer, parameter :: of_supports = 2
   !> Friction angle of joints without slip [deg]
   real(wp), parameter :: no_slip_deg = 90.0_wp
   !> Distance below which corners coincide, over the pier width
   real(wp), parameter :: same = 1.0e-9_wp
   !> Deviation of corners on a line, over their coordinates
   real(wp), parameter :: rounding = 16.0_wp*epsilon(1.0_wp)

   interface

      !> The sections of a form
      pure module subroutine arch_sections(form, sections, problem)
         type(arch_form_t), intent(in) :: form
         type(arch_sections_t), intent(out) :: sections
         type(form_problem_t), intent(out) :: problem
      end subroutine arch_sections

   end interface

contains

   !> Make the blocks of a form
   pure subroutine assemble_arch(form, assembly, problem)
      type(arch_form_t), intent(in) :: form
      type(arch_assembly_t), intent(out) :: assembly
      type(form_problem_t), intent(out) :: problem
      type(arch_sections_t) :: sections
      real(wp) :: shift(2)
      integer :: s, n

      call new_plan(assembly%plan)
      allocate (assembly%top(0), assembly%crown_x(form%spans))
      call arch_sections(form, sections, problem)
      if (len_trim(problem%text) > 0) return
      n = size(sections%is_joint)
      assembly%springing_y = sections%intrados(2, 1)
      do s = 1, form%spans
         shift = real(s - 1, wp)*(sections%intrados(:, n) - sections%intrados(:, 1) &
            & + [form%pier(1), 0.0_wp])
         assembly%crown_x(s) = sections%crown_x + shift(1)
         call add_voussoirs(form, sections, shift, s, assembly)
      end do
      assembly%n_voussoir = assembly%n_block
      call add_supports(form, sections, assembly, problem)
      if (len_trim(problem%text) > 0) return
      call trim_room(assembly)
      if (has_flat_block(assembly%plan)) then
         problem = form_problem_t("expected voussoirs with an area, got one whose corners lie "// &
            & "on a line; raise voussoirs or thickness", "voussoirs")
         return
      end if
      assembly%plan%materials = [material_plan_t(number=of_supports)]
      if (form%no_slip) assembly%plan%laws = [law_plan_t(material=[1, of_supports], &
         & value=[no_slip_deg, spread(0.0_wp, 1, 4)], &
         & given=[.true., spread(.false., 1, 4)])]
   end subroutine assemble_arch

   !> Number of blocks that can move
   pure integer function n_movable(form)
      type(arch_form_t), intent(in) :: form

      n_movable = form%spans*form%rings*form%voussoirs + form%courses*(form%spans - 1)
      if (form%buttress(1) > 0.0_wp) n_movable = n_movable + 2*form%courses
   end function n_movable

   !> The voussoirs of one span
   pure subroutine add_voussoirs(form, sections, shift, span, assembly)
      type(arch_form_t), intent(in) :: form
      type(arch_sections_t), intent(in) :: sections
      real(wp), intent(in) :: shift(2)  !! Where the span is, from the first: (2) [m]
      integer, intent(in) :: span       !! Number of the span
      type(arch_assembly_t), intent(inout) :: assembly
      real(wp), allocatable :: inner(:, :), outer(:, :)
      integer, allocatable :: joint(:)
      integer :: i, k, n, ring

      n = size(sections%is_joint)
      joint = pack([(i, i=1, n)], sections%is_joint)
      allocate (inner(2, n), outer(2, n))
      do ring = 1, form%rings
         inner = between(real(ring - 1, wp)/real(form%rings, wp))
         outer = between(real(ring, wp)/real(form%rings, wp))
         do i = 1, size(joint) - 1
            associate (a => joint(i), b => joint(i + 1))
               call add_block(assembly, reshape([inner(:, a:b), outer(:, b:a:-1)], &
                  & [2, 2*(b - a + 1)]), .false., 1)
               if (ring < form%rings) cycle
               do k = a, b - 1
                  call add_top(assembly, outer(:, k), outer(:, k + 1), span)
               end do
            end associate
         end do
      end do

   contains

      !> The line at a share of the thickness
      pure function between(share) result(line)
         real(wp), intent(in) :: share  !! 0 at the intrados, 1 at the extrados
         real(wp) :: line(2, n)         !! The line: (2, n) [m]

         line = sections%intrados + share*(sections%extrados - sections%intrados) &
            & + spread(shift, 2, n)
         if (share >= 1.0_wp) line = sections%extrados + spread(shift, 2, n)
      end function between
   end subroutine add_voussoirs

   !> Piers, buttresses and what is fixed
   pure subroutine add_supports(form, sections, assembly, problem)
      type(arch_form_t), intent(in) :: form
      type(arch_sections_t), intent(in) :: sections
      type(arch_assembly_t), intent(inout) :: assembly
      type(form_problem_t), intent(inout) :: problem  !! A pier too narrow for its springings
      real(wp) :: left(2, 2, 0:form%spans), right(2, 2, 0:form%spans), step(2)
      integer :: n, s

      n = size(sections%is_joint)
      step = sections%intrados(:, n) - sections%intrados(:, 1) + [form%pier(1), 0.0_wp]
      do s = 0, form%spans
         ! the end of the span on the left, the beginning of that on the right
         left(:, 1, s) = sections%intrados(:, n) + real(s - 1, wp)*step
         left(:, 2, s) = sections%extrados(:, n) + real(s - 1, wp)*step
         right(:, 1, s) = sections%intrados(:, 1) + real(s, wp)*step
         right(:, 2, s) = sections%extrados(:, 1) + real(s, wp)*step
      end do
      if (form%buttress(1) > 0.0_wp) then
         ! the face of a buttress that no arch stands on is upright
         left(1, :, 0) = right(1, 1, 0) - form%buttress(1)
         left(2, :, 0) = right(2, 2, 0)
         right(1, :, form%spans) = left(1, 1, form%spans) + form%buttress(1)
         right(2, :, form%spans) = left(2, 2, form%spans)
      end if
      do s = 0, form%spans
         if (.not. stands_free(s)) cycle
         call add_pier(form, left(:, :, s), right(:, :, s), height(s), assembly, problem)
         if (len_trim(problem%text) > 0) return
      end do
      do s = 0, form%spans
         if (stands_free(s)) then
            call add_block(assembly, ground(left(1, 1, s), right(1, 1, s), &
               & min(left(2, 1, s), right(2, 1, s)) - height(s)), .true., of_supports)
         else if (s == 0) then
            call add_block(assembly, springing(right(:, 2, s), right(:, 1, s)), .true., &
               & of_supports)
         else
            call add_block(assembly, springing(left(:, 1, s), left(:, 2, s)), .true., &
               & of_supports)
         end if
      end do

   contains

      !> True if a support is a pier or a buttress
      pure logical function stands_free(s)
         integer, intent(in) :: s  !! Its number, from 0

         stands_free = s > 0 .and. s < form%spans .or. form%buttress(1) > 0.0_wp
      end function stands_free

      !> Height of a pier or a buttress [m]
      pure real(wp) function height(s)
         integer, intent(in) :: s

         height = merge(form%pier(2), form%buttress(2), s > 0 .and. s < form%spans)
      end function height
   end subroutine add_supports

   !> A pier from the ground up, in courses; the uppermost carries the springings
   pure subroutine add_pier(form, left, right, height, assembly, problem)
      type(arch_form_t), intent(in) :: form
      !> Intrados and extrados of the springing of the arch on its left, or its upper left corner
      !> twice: (2, 2) [m]
      real(wp), intent(in) :: left(2, 2)
      real(wp), intent(in) :: right(2, 2)  !! Likewise on its right: (2, 2) [m]
      real(wp), intent(in) :: height       !! Its height up to the lower springing [m]
      type(arch_assembly_t), intent(inout) :: assembly
      type(form_problem_t), intent(inout) :: problem
      real(wp) :: base, course, gap, low, width
      real(wp), allocatable :: corner(:, :)
      integer :: i

      width = right(1, 1) - left(1, 1)
      gap = right(1, 2) - left(1, 2)
      if (gap < -same*width .or. .not. width > 0.0_wp) then
         problem = form_problem_t("expected supports as wide as the springings on them, got "// &
            & "narrower ones; widen pier_width and buttress_width", "pier_width")
         return
      end if
      base = min(left(2, 1), right(2, 1)) - height
      if (.not. minval([left(2, :), right(2, :)]) > base) then
         problem = form_problem_t("expected supports higher than the springings slope, got "// &
            & "lower ones; raise pier_height and buttress_height", "pier_height")
         return
      end if
      course = height/real(form%courses, wp)
      do i = 1, form%courses
         low = base + real(i - 1, wp)*course
         allocate (corner, source=reshape([left(1, 1), low, right(1, 1), low, right(1, 1), &
            & low + course, left(1, 1), low + course], [2, 4]))
         if (i == form%courses) corner = reshape([left(1, 1), low, right(1, 1), low, right, &
            & left(:, 2), left(:, 1)], [2, 6])
         call add_block(assembly, distinct(corner, same*width), .false., of_supports)
         deallocate (corner)
      end do
      if (gap > same*width) call add_top(assembly, left(:, 2), right(:, 2), 0)
   end subroutine add_pier

   !> Corners without those that repeat the one before
   pure function distinct(corner, near) result(kept)
      real(wp), intent(in) :: corner(:, :)  !! The corners: (2, n) [m]
      real(wp), intent(in) :: near          !! Largest distance of equal corners [m]
      real(wp), allocatable :: kept(:, :)   !! Those kept: (2, m) [m]
      integer :: i, n

      n = size(corner, 2)
      kept = corner(:, pack([(i, i=1, n)], [(norm2(corner(:, i) &
         & - corner(:, 1 + modulo(i - 2, n))) > near, i=1, n)]))
   end function distinct

   !> The ground below a pier, as deep as half its width
   pure function ground(left, right, top) result(corner)
      real(wp), intent(in) :: left   !! Left end [m]
      real(wp), intent(in) :: right  !! Right end [m]
      real(wp), intent(in) :: top    !! Its height [m]
      real(wp) :: corner(2, 4)       !! Corners, counter-clockwise: (2, 4) [m]

      associate (low => top - 0.5_wp*(right - left))
         corner = reshape([left, low, right, low, right, top, left, top], [2, 4])
      end associate
   end function ground

   !> Add a block
   pure subroutine add_block(assembly, corner, fixed, material)
      type(arch_assembly_t), intent(inout) :: assembly
      real(wp), intent(in) :: corner(:, :)  !! Its corners, counter-clockwise: (2, n) [m]
      logical, intent(in) :: fixed          !! True if it cannot move
      integer, intent(in) :: material       !! Number of its material

      associate (plan => assembly%plan, n => assembly%n_block, v => assembly%n_vertex)
         call make_room(plan%first_vertex, n + 2)
         call make_room(plan%vertex, v + size(corner, 2))
         call make_room(plan%fixed, n + 1)
         call make_room(plan%material, n + 1)
         plan%vertex(:, v + 1:v + size(corner, 2)) = corner
         v = v + size(corner, 2)
         n = n + 1
         plan%first_vertex(n + 1) = v + 1
         plan%fixed(n) = fixed
         plan%material(n) = material
      end associate
   end subroutine add_block

   !> Add a chord of the upper face of the last block; what leans over carries nothing
   pure subroutine add_top(assembly, left, right, span)
      type(arch_assembly_t), intent(inout) :: assembly
      real(wp), intent(in) :: left(2)   !! Its left end: (2) [m]
      real(wp), intent(in) :: right(2)  !! Its right end: (2) [m]
      integer, intent(in) :: span       !! Number of its span; 0 on a pier
      type(top_chord_t), allocatable :: room(:)

      if (.not. right(1) > left(1)) return
      associate (n => assembly%n_top)
         if (n == size(assembly%top)) then
            allocate (room(2*n + 1))
            room(:n) = assembly%top
            call move_alloc(room, assembly%top)
         end if
         n = n + 1
         assembly%top(n) = top_chord_t(assembly%n_block, left, right, span)
      end associate
   end subroutine add_top

   !> Give back the room that blocks and chords do not take
   pure subroutine trim_room(assembly)
      type(arch_assembly_t), intent(inout) :: assembly

      associate (plan => assembly%plan, n => assembly%n_block)
         plan%first_vertex = plan%first_vertex(:n + 1)
         plan%vertex = plan%vertex(:, :assembly%n_vertex)
         plan%fixed = plan%fixed(:n)
         plan%material = plan%material(:n)
         plan%line = spread(1, 1, n)
         assembly%top = assembly%top(:assembly%n_top)
      end associate
   end subroutine trim_room

   !> Return whether the area of a block is zero within the rounding of its corners
   pure logical function has_flat_block(plan)
      type(block_plan_t), intent(in) :: plan
      real(wp) :: area, size_of_all
      integer :: b, first, k

      has_flat_block = .true.
      size_of_all = maxval(abs(plan%vertex))
      do b = 1, size(plan%fixed)
         first = plan%first_vertex(b)
         area = 0.0_wp
         do k = first + 1, plan%first_vertex(b + 1) - 2
            area = area + 0.5_wp*cross(plan%vertex(:, k) - plan%vertex(:, first), &
               & plan%vertex(:, k + 1) - plan%vertex(:, first))
         end do
         associate (corner => plan%vertex(:, first:plan%first_vertex(b + 1) - 1))
            if (.not. area > rounding*size_of_all &
               & *norm2(maxval(corner, dim=2) - minval(corner, dim=2))) return
         end associate
      end do
      has_flat_block = .false.
   end function has_flat_block
end module dda_arch_assembly
