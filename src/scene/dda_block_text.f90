!> Write the blocks of a deck as a file of blocks, with the actions on their points
module dda_block_text
   use dda_arch_assembly, only : arch_assembly_t
   use dda_arch_form, only : form_problem_t
   use dda_block_system, only : block_system_t
   use dda_cut_model, only : cut_model_t
   use dda_deck, only : deck_t, has_group
   use dda_deck_scene, only : deck_scene
   use dda_key_names, only : arch_lune_deg, fill_group, live_group, vehicle_group
   use dda_kinds, only : degree, wp
   use dda_limerick_analysis, only : load_history_t
   use dda_line_model, only : entity_role
   use dda_line_scene, only : held_blocks, law_of_joint, line_system
   use dda_material, only : joint_law_t
   use dda_scene, only : scene_t
   use dda_shape_scene, only : shape_assembly
   use dda_text, only : add_line, fields, growing_text_t, lines_of, to_text
   implicit none
   private

   public :: has_one_law, line_losses, line_text, shape_losses, shape_text

contains

   !> True if all joints of a deck's lines have one law: a file of blocks has laws per pair of block
   !> materials, not per line
   pure logical function has_one_law(deck)
      type(deck_t), intent(in) :: deck  !! The deck of the case, with its blocks
      type(joint_law_t) :: first, law
      integer :: j

      has_one_law = .true.
      do j = 1, size(deck%cut%pair)
         law = law_of_joint(deck, deck%cut%pair(j)%joint)
         if (j == 1) first = law
         has_one_law = has_one_law .and. (law%no_slip .eqv. first%no_slip) &
            & .and. .not. any(abs(numbers_of(law) - numbers_of(first)) > 0.0_wp)
      end do
   end function has_one_law

   !> Text of the blocks of a deck's lines
   pure function line_text(deck) result(text)
      !> The deck of the case, with its blocks; its joints have one law
      type(deck_t), intent(in) :: deck
      character(len=:), allocatable :: text  !! Lines, each ended by a line feed
      type(block_system_t) :: system
      type(growing_text_t) :: lines
      type(scene_t) :: scene

      call line_system(deck, deck%cut, system)
      call deck_scene(deck, scene)
      call add_line(lines, "! the blocks of "//deck%file//", written by dda export")
      call add_cut_blocks(deck%cut, system, lines)
      call add_materials(system, lines)
      if (size(deck%cut%pair) > 0) call add_laws(law_of_joint(deck, deck%cut%pair(1)%joint), &
         & maxval(system%material), lines)
      call add_points(deck, lines)
      call add_bar_lines(scene, lines)
      text = lines_of(lines)
   end function line_text

   !> Numbers of a law in a file of blocks
   pure function numbers_of(law) result(number)
      type(joint_law_t), intent(in) :: law
      real(wp) :: number(5)  !! Friction, cohesion, tension, residual friction, slip length: (5)

      number = [law%friction, law%cohesion, law%tension, law%residual, law%slip_length]
   end function numbers_of

   !> Add the blocks. Material 1 is that of the deck, so those of the lines start at 2
   pure subroutine add_cut_blocks(cut, system, lines)
      type(cut_model_t), intent(in) :: cut
      type(block_system_t), intent(in) :: system  !! Their materials and initial state
      type(growing_text_t), intent(inout) :: lines
      character(len=:), allocatable :: line
      logical :: held(size(cut%area))
      integer :: b

      held = held_blocks(cut)
      do b = 1, size(cut%area)
         line = "block"
         if (held(b)) line = line//" fixed"
         line = line//" material "//to_text(system%material(b) + 1)
         if (any(abs(system%velocity(1:3, b)) > 0.0_wp)) line = line//" velocity " &
            & //fields(system%velocity(1:3, b), " ")
         if (any(abs(system%stress(:, b)) > 0.0_wp)) line = line//" stress " &
            & //fields(system%stress(:, b), " ")
         associate (first => cut%first_vertex(b), last => cut%first_vertex(b + 1) - 1)
            call add_block(line, cut%vertex(:, first:last), cut%scale%origin, lines)
         end associate
      end do
   end subroutine add_cut_blocks

   !> Add a block with its corners
   pure subroutine add_block(line, vertex, origin, lines)
      character(len=*), intent(in) :: line  !! First line of the block
      real(wp), intent(in) :: vertex(:, :)  !! Corners: (2, n) [m]
      real(wp), intent(in) :: origin(2)     !! Origin of the coordinates: (2) [m]
      type(growing_text_t), intent(inout) :: lines
      integer :: v

      call add_line(lines, line)
      do v = 1, size(vertex, 2)
         call add_line(lines, "   "//fields(vertex(:, v) + origin, " "))
      end do
   end subroutine add_block

   !> Add the materials of the blocks
   pure subroutine add_materials(system, lines)
      type(block_system_t), intent(in) :: system
      type(growing_text_t), intent(inout) :: lines
      integer :: b, m

      do m = 1, maxval(system%material)
         b = findloc(system%material, m, dim=1)
         if (b == 0) cycle
         associate (material => system%materials(m))
            call add_line(lines, "material "//to_text(m + 1)//" density " &
               & //to_text(system%density(b))//" unit_weight "//to_text(system%unit_weight(b)) &
               & //" young "//to_text(material%young)//" poisson "//to_text(material%poisson))
         end associate
      end do
   end subroutine add_materials

   !> Add one law for the joints of all materials
   pure subroutine add_laws(law, n, lines)
      type(joint_law_t), intent(in) :: law
      integer, intent(in) :: n  !! Number of materials
      type(growing_text_t), intent(inout) :: lines
      character(len=:), allocatable :: friction, residual
      integer :: i, j

      friction = to_text(atan(law%friction)/degree)
      if (law%no_slip) friction = "90"
      residual = ""
      if (law%residual < huge(law%residual)) residual = " residual_deg " &
         & //to_text(atan(law%residual)/degree)//" slip_length "//to_text(law%slip_length)
      do j = 1, n
         do i = 1, j
            call add_line(lines, "joint "//to_text(i + 1)//" "//to_text(j + 1)//" friction_deg " &
               & //friction//" cohesion "//to_text(law%cohesion)//" tension " &
               & //to_text(law%tension)//residual)
         end do
      end do
   end subroutine add_laws

   !> Add restraints, loads and monitoring points; blocks with two restrained points become fixed
   pure subroutine add_points(deck, lines)
      type(deck_t), intent(in) :: deck
      type(growing_text_t), intent(inout) :: lines
      character(len=:), allocatable :: at
      logical :: held(size(deck%cut%area))
      integer :: i

      held = held_blocks(deck%cut)
      do i = 1, size(deck%cut%point)
         associate (point => deck%cut%point(i))
            if (held(point%block) .and. point%kind /= entity_role%measure) cycle
            at = " block "//to_text(point%block)//" " &
               & //fields(point%place + deck%cut%scale%origin, " ")
            if (point%kind == entity_role%fix) call add_line(lines, "fix"//at)
            if (point%kind == entity_role%measure) call add_line(lines, "measure"//at)
            if (point%kind /= entity_role%load .or. .not. allocated(deck%file_analysis)) cycle
            if (point%source <= size(deck%file_analysis%load)) &
               & call add_load(deck%file_analysis%load(point%source), at, lines)
         end associate
      end do
   end subroutine add_points

   !> Add a force with its time history
   pure subroutine add_load(load, at, lines)
      type(load_history_t), intent(in) :: load
      character(len=*), intent(in) :: at  !! Words for the point of application
      type(growing_text_t), intent(inout) :: lines
      integer :: i

      if (.not. any(abs(load%record(2:3, :)) > 0.0_wp)) return
      call add_line(lines, "load"//at)
      do i = 1, size(load%record, 2)
         call add_line(lines, "   "//to_text(load%record(1, i))//" " &
            & //fields(load%record(2:3, i), " "))
      end do
   end subroutine add_load

   !> Items that a file of blocks cannot represent
   pure function line_losses(deck) result(text)
      type(deck_t), intent(in) :: deck
      !> The items, separated by commas; empty if there are none
      character(len=:), allocatable :: text

      text = ""
      if (allocated(deck%file_analysis)) then
         if (deck%file_analysis%plane_strain) text = ", plane strain (material%plane)"
      end if
      if (has_group(deck, live_group) .or. has_group(deck, vehicle_group)) text = text &
         & //", &live, &vehicle"
      if (len(text) > 0) text = text(3:)
   end function line_losses

   !> Text of the blocks of a deck's arch, with the actions on their points
   pure function shape_text(deck) result(text)
      type(deck_t), intent(in) :: deck
      character(len=:), allocatable :: text  !! Lines, each ended by a line feed
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: problem
      type(growing_text_t) :: lines
      type(scene_t) :: scene
      integer :: b, i

      call shape_assembly(deck, assembly, problem)
      call deck_scene(deck, scene)
      call add_line(lines, "! the arch of "//deck%file//", written by dda export")
      associate (plan => assembly%plan)
         do b = 1, size(plan%fixed)
            call add_block(trim(merge("block      ", "block fixed", scene%system%equation(b) > 0)) &
               & //trim(merge(" material 2", "           ", plan%material(b) == 2)), &
               & plan%vertex(:, plan%first_vertex(b):plan%first_vertex(b + 1) - 1), &
               & plan%origin, lines)
         end do
      end associate
      call add_line(lines, "material 2")
      do i = 1, size(assembly%plan%laws)
         call add_line(lines, "joint 1 2 friction_deg "//to_text(assembly%plan%laws(i)%value(1)))
      end do
      if (allocated(scene%settings%boundary%loaded)) then
         do i = 1, size(scene%settings%boundary%loaded)
            associate (loaded => scene%settings%boundary%loaded(i))
               call add_line(lines, trim(merge("live", "load", loaded%live))//" block " &
                  & //to_text(loaded%block)//" "//fields(loaded%point + scene%origin, " ")//" " &
                  & //fields(loaded%force%value(:, 1), " "))
            end associate
         end do
      end if
      if (allocated(scene%settings%boundary%held)) then
         do i = 1, size(scene%settings%boundary%held)
            associate (held => scene%settings%boundary%held(i))
               call add_line(lines, "displacement block "//to_text(held%block)//" " &
                  & //fields([held%point + scene%origin, held%path%value(:, 1)], " "))
            end associate
         end do
      end if
      call add_bar_lines(scene, lines)
      text = lines_of(lines)
   end function shape_text

   !> Add the bars of a scene
   pure subroutine add_bar_lines(scene, lines)
      type(scene_t), intent(in) :: scene
      type(growing_text_t), intent(inout) :: lines
      character(len=:), allocatable :: text
      integer :: i

      if (.not. allocated(scene%settings%boundary%bar)) return
      do i = 1, size(scene%settings%boundary%bar)
         associate (bar => scene%settings%boundary%bar(i), origin => scene%origin)
            text = "bar "//fields([bar%point(:, 1) + origin, bar%point(:, 2) + origin], " ") &
               & //" stiffness "//to_text(bar%stiffness)//" prestress "//to_text(bar%prestress)
            if (.not. bar%pushes) text = text//" slack"
            if (bar%strength < huge(bar%strength)) text = text//" strength "//to_text(bar%strength)
         end associate
         call add_line(lines, text)
      end do
   end subroutine add_bar_lines

   !> Items that a file of blocks cannot represent
   pure function shape_losses(deck) result(text)
      type(deck_t), intent(in) :: deck
      character(len=:), allocatable :: text  !! Keys separated by commas; empty if there are none

      text = ""
      if (deck%value(arch_lune_deg)%given) text = ", arch%lune_deg"
      if (has_group(deck, fill_group)) text = text//", pressure of the fill"
      if (len(text) > 0) text = text(3:)
   end function shape_losses
end module dda_block_text
