!> An arch of any shape as a file of blocks
module dda_shape_text
   use dda_arch_assembly, only : arch_assembly_t
   use dda_arch_form, only : form_problem_t
   use dda_block_input, only : block_plan_t
   use dda_boundary, only : loaded_point_t
   use dda_deck, only : deck_t, has_group
   use dda_deck_scene, only : deck_scene
   use dda_key_names, only : arch_lune_deg, fill_group
   use dda_kinds, only : wp
   use dda_scene, only : scene_t
   use dda_shape_scene, only : shape_assembly
   use dda_text, only : add_line, fields, growing_text_t, lines_of, to_text
   implicit none
   private

   public :: add_bar_lines, shape_losses, shape_text

contains

   !> The blocks of a deck's arch, with what acts on points of them
   pure function shape_text(deck) result(text)
      type(deck_t), intent(in) :: deck
      character(len=:), allocatable :: text  !! Lines, each ended by a line feed
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: problem
      type(growing_text_t) :: lines
      type(scene_t) :: scene
      integer :: i

      call shape_assembly(deck, assembly, problem)
      call deck_scene(deck, scene)
      call add_line(lines, "! the arch of "//deck%file//", written by dda export")
      call add_blocks(assembly%plan, lines)
      call add_line(lines, "material 2")
      do i = 1, size(assembly%plan%laws)
         call add_line(lines, "joint 1 2 friction_deg "//to_text(assembly%plan%laws(i)%value(1)))
      end do
      if (allocated(scene%settings%boundary%loaded)) then
         do i = 1, size(scene%settings%boundary%loaded)
            call add_load(scene%settings%boundary%loaded(i), scene%origin, lines)
         end do
      end if
      call add_bar_lines(scene, lines)
      text = lines_of(lines)
   end function shape_text

   !> Add the blocks, each with its corners
   pure subroutine add_blocks(plan, lines)
      type(block_plan_t), intent(in) :: plan
      type(growing_text_t), intent(inout) :: lines
      integer :: b, v

      do b = 1, size(plan%fixed)
         call add_line(lines, trim(merge("block fixed", "block      ", plan%fixed(b)))// &
            & trim(merge(" material 2", "           ", plan%material(b) == 2)))
         do v = plan%first_vertex(b), plan%first_vertex(b + 1) - 1
            call add_line(lines, "   "//fields(plan%vertex(:, v), " "))
         end do
      end do
   end subroutine add_blocks

   !> Add a force on a point
   pure subroutine add_load(loaded, origin, lines)
      type(loaded_point_t), intent(in) :: loaded
      real(wp), intent(in) :: origin(2)  !! Where the origin of its coordinates is: (2) [m]
      type(growing_text_t), intent(inout) :: lines

      call add_line(lines, trim(merge("live", "load", loaded%live))//" block " &
         & //to_text(loaded%block)//" "//fields(loaded%point + origin, " ")//" " &
         & //fields(loaded%force%value(:, 1), " "))
   end subroutine add_load

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

   !> What a file of blocks has no place for
   pure function shape_losses(deck) result(text)
      type(deck_t), intent(in) :: deck
      character(len=:), allocatable :: text  !! Keys, parted by commas; empty if nothing is lost

      text = ""
      if (deck%value(arch_lune_deg)%given) text = ", arch%lune_deg"
      if (has_group(deck, fill_group)) text = text//", pressure of the fill"
      if (len(text) > 0) text = text(3:)
   end function shape_losses
end module dda_shape_text
