!> dda export: arches as Limerick files or files of blocks, and cut blocks as files of blocks
submodule (dda_verbs) dda_export
   use dda_arch_lines, only : arch_analysis, arch_lines, lost_keys
   use dda_binary_file, only : write_file
   use dda_deck, only : deck_t, has_group, key_error, source_of
   use dda_deck_sweep, only : n_cases, turn_to_case
   use dda_key_names, only : scene_geometry, scene_kind, search_group
   use dda_limerick_analysis, only : limerick_analysis_t
   use dda_line_model, only : line_model_t
   use dda_line_scene, only : cut_lines
   use dda_block_text, only : has_one_law, line_losses, line_text, shape_losses, shape_text
   use dda_process, only : deck_stem, exit_status, make_folder
   use dda_read_deck, only : read_deck
   use dda_screen, only : print_line, screen_t
   use dda_shape_check, only : check_form
   use dda_text, only : to_text
   use dda_write_limerick, only : ddaml_analysis, ddaml_geometry, plain_analysis, plain_geometry
   implicit none

   character(len=1), parameter :: lf = achar(10)

contains

   !> Export a deck
   module procedure export_deck
      type(deck_t) :: deck

      status = exit_status%bad_input
      call read_deck(name, command%setting, deck, error)
      if (.not. allocated(error)) call cut_lines(deck, error)
      if (.not. allocated(error) .and. deck%value(scene_kind)%text == "blocks") &
         & call key_error(error, "dda export needs scene%kind 'arch' or 'lines', got " &
         & //"'blocks'; copy the file that it names", deck, scene_kind)
      if (.not. allocated(error)) call export_cases(command, deck, status, error)
   end procedure export_deck

   !> Export all cases of a deck
   subroutine export_cases(command, deck, status, error)
      type(command_t), intent(in) :: command
      type(deck_t), intent(in) :: deck
      integer, intent(out) :: status
      type(error_t), allocatable, intent(out) :: error
      type(deck_t) :: case_of_deck
      type(line_model_t) :: model
      character(len=:), allocatable :: folder, stem
      integer :: number

      folder = "."
      if (allocated(command%out)) folder = command%out
      if (allocated(command%out)) call make_folder(folder)
      do number = 1, n_cases(deck)
         status = exit_status%bad_input
         stem = folder//"/"//deck_stem(deck%file)
         if (n_cases(deck) > 1) stem = stem//"_"//to_text(number)
         call turn_to_case(deck, number, case_of_deck, error)
         if (allocated(error)) return
         if (source_of(case_of_deck) /= "arch") then
            call export_blocks(command, stem, case_of_deck, status, error)
            if (allocated(error)) return
            cycle
         end if
         call arch_lines(case_of_deck, model, error)
         if (allocated(error)) return
         status = exit_status%not_written
         call write_pair(stem, model, arch_analysis(case_of_deck), error)
         if (allocated(error)) return
         if (.not. command%quiet) call report_files(command%screen, stem, case_of_deck)
         status = exit_status%success
      end do
   end subroutine export_cases

   !> Export a shaped arch, or blocks cut from lines, as a file of blocks
   subroutine export_blocks(command, stem, deck, status, error)
      type(command_t), intent(in) :: command
      character(len=*), intent(in) :: stem  !! Name of the file without its extension
      type(deck_t), intent(in) :: deck
      integer, intent(out) :: status        !! Exit status of the deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: text, losses

      status = exit_status%bad_input
      text = ""
      if (source_of(deck) == "shape") then
         call check_form(deck, error)
         if (.not. allocated(error)) text = shape_text(deck)
         losses = shape_losses(deck)
      else
         if (.not. has_one_law(deck)) call key_error(error, "expected joints of one law, got " &
            & //"several: a file of blocks has laws of pairs of block materials; give the law by " &
            & //"the keys of &joint, and join islands to the blocks around them by " &
            & //"lines", deck, scene_geometry)
         if (.not. allocated(error)) text = line_text(deck)
         losses = line_losses(deck)
      end if
      if (allocated(error)) return
      status = exit_status%not_written
      call write_file(stem//".blocks", text//lf, error)
      if (allocated(error)) return
      status = exit_status%success
      if (.not. command%quiet) then
         call print_line(command%screen, stem//".blocks, for scene%kind = 'blocks'")
         if (losses /= "") call print_line(command%screen, &
            & "   a file of blocks has no place for "//losses)
         if (has_group(deck, search_group)) call print_line(command%screen, &
            & "   the search is not written: the file holds the deck's own value of its parameter")
      end if
   end subroutine export_blocks

   !> Write geometry and analysis in both formats
   subroutine write_pair(stem, model, analysis, error)
      character(len=*), intent(in) :: stem
      type(line_model_t), intent(in) :: model
      type(limerick_analysis_t), intent(in) :: analysis
      type(error_t), allocatable, intent(out) :: error

      call write_file(stem//".geo", plain_geometry(model)//lf, error)
      if (.not. allocated(error)) &
         & call write_file(stem//"_ddaml.geo", ddaml_geometry(model)//lf, error)
      if (.not. allocated(error)) call write_file(stem//".ana", ddaml_analysis(analysis)//lf, error)
      if (.not. allocated(error)) &
         & call write_file(stem//"_plain.ana", plain_analysis(analysis)//lf, error)
   end subroutine write_pair

   !> Print the names of the written files, and the keys that were lost
   subroutine report_files(screen, stem, deck)
      type(screen_t), intent(in) :: screen
      character(len=*), intent(in) :: stem
      type(deck_t), intent(in) :: deck

      call print_line(screen, stem//".geo, "//stem//"_ddaml.geo, "//stem//".ana (DDAML), " &
         & //stem//"_plain.ana")
      call print_line(screen, "   the plain .ana has no place for contact constants, automatic "// &
         & "step and penalty, plane strain and gravity (only as unit weight over unit mass)")
      if (lost_keys(deck) /= "") call print_line(screen, &
         & "   neither form has a place for "//lost_keys(deck))
      if (has_group(deck, search_group)) call print_line(screen, &
         & "   the search is not written: the files hold the deck's own value of its parameter")
   end subroutine report_files
end submodule dda_export
