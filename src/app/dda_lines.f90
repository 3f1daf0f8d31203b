!> dda lines: joint map to file of lines (Shi: DL)
submodule (dda_verbs) dda_lines
   use dda_binary_file, only : write_file
   use dda_joint_map, only : joint_map_t
   use dda_kinds, only : wp
   use dda_line_model, only : entities_t, entity_role, line_model_t, role_name
   use dda_map_lines, only : map_lines
   use dda_process, only : deck_stem, exit_status
   use dda_read_joint_map, only : read_joint_map
   use dda_screen, only : print_line
   use dda_table_file, only : append_line, close_table, open_table, table_file_t
   use dda_text, only : counted, fields, short_text, to_text
   use dda_write_limerick, only : ddaml_geometry, plain_geometry
   implicit none

contains

   !> Draw the lines of one map
   module procedure draw_map
      type(joint_map_t) :: map
      type(line_model_t) :: model
      character(len=:), allocatable :: file
      real(wp) :: length
      logical :: is_ddaml

      status = exit_status%bad_input
      call read_joint_map(name, map, is_ddaml, error)
      if (.not. allocated(error)) call map_lines(map, model, error)
      if (allocated(error)) return
      status = exit_status%success
      file = deck_stem(name)//".geo"
      if (allocated(command%out)) file = command%out
      if (is_ddaml) then
         call write_file(file, ddaml_geometry(model)//new_line("a"), error)
      else
         call write_file(file, plain_geometry(model)//new_line("a"), error)
      end if
      if (.not. allocated(error)) call write_table(table_name(file), model, error)
      if (allocated(error)) status = exit_status%not_written
      if (allocated(error) .or. command%quiet) return
      associate (ends => model%line%place(:, model%n_boundary + 1:model%line%n))
         length = sum(norm2(ends(3:4, :) - ends(1:2, :), dim=1))
      end associate
      call print_line(command%screen, name//": "//counted(model%n_boundary, "boundary line")//", " &
         & //counted(model%line%n - model%n_boundary, "joint")//" of " &
         & //short_text(length)//" m in all, " &
         & //counted(size(map%opening), "opening")//", " &
         & //counted(model%of(entity_role%bolt)%n, "bolt"))
      call print_line(command%screen, "   "//file//" is for 'dda cut', "//table_name(file) &
         & //" for pictures")
   end procedure draw_map

   !> Name of the table for a file of lines
   pure function table_name(file) result(name)
      character(len=*), intent(in) :: file   !! Name of the file
      character(len=:), allocatable :: name  !! The same with the ending .csv

      name = file
      if (index(file, ".geo", back=.true.) == len(file) - 3) name = file(:len(file) - 4)
      name = name//"_lines.csv"
   end function table_name

   !> Write a table of lines and points with their roles
   subroutine write_table(file, model, error)
      character(len=*), intent(in) :: file
      type(line_model_t), intent(in) :: model
      type(error_t), allocatable, intent(out) :: error
      type(table_file_t) :: table
      integer :: k

      call open_table(file, "role,x1,y1,x2,y2,material,row", table, error)
      call write_rows(table, "boundary", model%line, 1, model%n_boundary, error)
      call write_rows(table, "joint", model%line, model%n_boundary + 1, model%line%n, error)
      do k = entity_role%material, entity_role%bolt
         call write_rows(table, trim(role_name(k)), model%of(k), 1, model%of(k)%n, error)
      end do
      call close_table(table, error)
   end subroutine write_table

   !> Write rows of one role
   subroutine write_rows(table, role, entities, first, last, error)
      type(table_file_t), intent(inout) :: table
      character(len=*), intent(in) :: role  !! Role of the entities
      type(entities_t), intent(in) :: entities
      integer, intent(in) :: first, last    !! First and last entity
      type(error_t), allocatable, intent(inout) :: error
      integer :: i

      do i = first, last
         if (allocated(error)) return
         call append_line(table, role//","//fields(entities%place(:, i))//"," &
            & //to_text(entities%material(i))//","//to_text(entities%row(i)), error)
      end do
   end subroutine write_rows
end submodule dda_lines
