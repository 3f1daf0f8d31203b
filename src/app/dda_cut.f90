!> dda cut: lines to blocks
submodule (dda_verbs) dda_cut
   use dda_cut_model, only : block_vertices, bond_joint, cut_model_t, cut_reason, cut_remark_t
   use dda_cutting, only : cut_blocks
   use dda_kinds, only : wp
   use dda_line_model, only : entity_role, line_model_t
   use dda_process, only : exit_status
   use dda_read_limerick, only : read_geometry
   use dda_screen, only : print_line, print_warnings, screen_t
   use dda_text, only : counted, place_text, short_text, to_text
   use dda_vector, only : area_moments, area_moments_t
   use dda_error, only : warnings_t
   use dda_write_vtu, only : write_cut_table, write_cut_vtu
   implicit none

   !> Maximum number of rows of a list
   integer, parameter :: most_rows = 50

contains

   !> Cut one file
   module procedure cut_file
      type(line_model_t) :: model
      type(cut_model_t) :: cut
      type(warnings_t) :: warnings

      status = exit_status%success
      call read_geometry(name, model, warnings, error)
      if (.not. command%quiet) call print_warnings(warnings)
      if (.not. allocated(error)) call cut_blocks(model, cut, error)
      if (allocated(error)) then
         status = exit_status%bad_input
      else
         if (.not. command%quiet) call print_cut(command%screen, model, cut)
         if (allocated(command%out)) then
            if (index(command%out, ".vtu", back=.true.) == len(command%out) - 3) then
               call write_cut_vtu(command%out, cut, error)
            else
               call write_cut_table(command%out, cut, error)
            end if
         end if
         if (allocated(error)) status = exit_status%not_written
      end if
   end procedure cut_file

   !> Print counts, areas and dropped parts
   subroutine print_cut(screen, model, cut)
      type(screen_t), intent(in) :: screen
      type(line_model_t), intent(in) :: model
      type(cut_model_t), intent(in) :: cut
      integer :: smallest, largest, i

      smallest = minloc(cut%area, 1)
      largest = maxloc(cut%area, 1)
      call print_line(screen, model%file//": "//counted(model%line%n, "line")//", " &
         & //counted(size(cut%area), "block"))
      if (size(cut%area) > 0) then
         call report(screen, "area", short_text(sum(cut%area))//" in all")
         call report(screen, "smallest", short_text(cut%area(smallest)) &
            & //", block "//to_text(smallest))
         call report(screen, "largest", short_text(cut%area(largest))//", block "//to_text(largest))
      end if
      call report(screen, "joints", counted(size(cut%pair), "pair")//" of coincident edges")
      call report(screen, "points", to_text(count(cut%point%kind == entity_role%fix))//" fixed, " &
         & //to_text(count(cut%point%kind == entity_role%load))//" load, " &
         & //to_text(count(cut%point%kind == entity_role%measure))//" monitoring")
      call print_hinged(screen, cut)
      if (model%of(entity_role%bolt)%n > 0) call report(screen, "bolts", to_text(size(cut%bolt)) &
         & //" between blocks, "//to_text(cut%n_idle_bolts)//" within one block, left out")
      if (any(cut%pair%joint == bond_joint)) call report(screen, "islands", &
         & counted(count([(count(cut%whole == i) > 1, i=1, size(cut%whole))]), "block") &
         & //" around others, cut into pieces with " &
         & //counted(count(cut%pair%joint == bond_joint), "bond")//" between them")
      if (cut%n_removed > 0) call report(screen, "removed", counted(cut%n_removed, "block") &
         & //" with hole points")
      if (cut%n_merged > 0) call report(screen, "merged", &
         & counted(cut%n_merged, "crossing")//" with a node " &
         & //"nearer than "//short_text(cut%scale%merge)//" (1.25 e00 w0, w0 = " &
         & //short_text(cut%scale%size)//")")
      call print_blocks(screen, cut)
      call print_dropped(screen, model, cut)
   end subroutine print_cut

   !> Print the number of blocks that a single fixed point leaves free to rotate
   subroutine print_hinged(screen, cut)
      type(screen_t), intent(in) :: screen
      type(cut_model_t), intent(in) :: cut
      integer :: n_fixed(size(cut%area)), i

      n_fixed = 0
      do i = 1, size(cut%point)
         associate (point => cut%point(i))
            if (point%kind == entity_role%fix) n_fixed(point%block) = n_fixed(point%block) + 1
         end associate
      end do
      if (any(n_fixed == 1)) call report(screen, "hinged", counted(count(n_fixed == 1), "block") &
         & //" with a single fixed point can turn, such as block " &
         & //to_text(findloc(n_fixed, 1, 1))//"; a second point fixes a block")
   end subroutine print_hinged

   !> Print one row per block
   subroutine print_blocks(screen, cut)
      type(screen_t), intent(in) :: screen
      type(cut_model_t), intent(in) :: cut
      type(area_moments_t) :: moments
      character(len=24) :: columns
      integer :: b

      call print_line(screen, "   block  material  corners  area  centre")
      do b = 1, min(size(cut%area), most_rows)
         write (columns, "(i5, i10, i9)") b, cut%material(b), &
            & cut%first_vertex(b + 1) - cut%first_vertex(b)
         moments = area_moments(block_vertices(cut, b))
         call print_line(screen, "   "//columns//"  "//short_text(cut%area(b))//"  " &
            & //point_text(cut, moments%centroid))
      end do
      if (size(cut%area) > most_rows) call print_line(screen, "   and " &
         & //to_text(size(cut%area) - most_rows)//" more: --out FILE.csv lists all of them")
   end subroutine print_blocks

   !> Print the dropped parts with the reasons
   subroutine print_dropped(screen, model, cut)
      type(screen_t), intent(in) :: screen
      type(line_model_t), intent(in) :: model
      type(cut_model_t), intent(in) :: cut
      logical, allocatable :: unused(:)
      integer :: i

      associate (remarks => cut%remarks)
         if (remarks%n == 0) then
            call report(screen, "dropped", "nothing")
            return
         end if
         allocate (unused(model%line%n), source=.false.)
         unused(remarks%item(:remarks%n)%line) = remarks%item(:remarks%n)%reason &
            & <= cut_reason%loose_line
         call report(screen, "dropped", &
            & to_text(remarks%n)//" parts of lines; "//to_text(count(unused)) &
            & //" lines meet fewer than two others and are unused")
         do i = 1, min(remarks%n, most_rows)
            call print_line(screen, "      "//remark_text(model, cut, remarks%item(i)))
         end do
         if (remarks%n > most_rows) call print_line(screen, "      and " &
            & //to_text(remarks%n - most_rows)//" more")
      end associate
   end subroutine print_dropped

   !> A remark in words
   pure function remark_text(model, cut, remark) result(text)
      type(line_model_t), intent(in) :: model
      type(cut_model_t), intent(in) :: cut
      type(cut_remark_t), intent(in) :: remark
      character(len=:), allocatable :: text
      character(len=:), allocatable :: other

      text = model%file//":"//to_text(model%line%row(remark%line))//": line " &
         & //to_text(remark%line)//" from "//point_text(cut, remark%place(1:2))//" to " &
         & //point_text(cut, remark%place(3:4))
      other = ""
      if (remark%other > 0) other = "line "//to_text(remark%other)//" ("//model%file//":" &
         & //to_text(model%line%row(remark%other))//")"
      select case (remark%reason)
      case (cut_reason%point)
         text = text//": it has no length"
      case (cut_reason%loose_line)
         text = text//": it meets fewer than two other lines"
      case (cut_reason%loose_edge)
         text = text//": this part has a free end"
      case (cut_reason%doubled)
         text = text//": it lies on "//other
      case (cut_reason%crossing)
         text = text//": once nodes were merged it crosses "//other//" without a node"
      case (cut_reason%too_close)
         text = text//": it passes a node of "//other//" closer than " &
            & //short_text(cut%scale%clearance)//" (e00 w0)"
      case (cut_reason%flat)
         text = text//": it bounds a block without area"
      end select
   end function remark_text

   !> Text of a point in the file's coordinates
   pure function point_text(cut, point) result(text)
      type(cut_model_t), intent(in) :: cut
      real(wp), intent(in) :: point(2)       !! The point relative to the origin of the cut: (2) [m]
      character(len=:), allocatable :: text  !! Its coordinates in parentheses

      text = place_text(point + cut%scale%origin)
   end function point_text

   !> Print one line of the summary
   subroutine report(screen, label, value)
      type(screen_t), intent(in) :: screen
      character(len=*), intent(in) :: label  !! Label of the line
      character(len=*), intent(in) :: value  !! Value
      character(len=12) :: padded

      padded = label
      call print_line(screen, "   "//padded//value)
   end subroutine report
end submodule dda_cut
