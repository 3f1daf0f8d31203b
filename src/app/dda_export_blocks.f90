!> Arches of any shape and blocks cut from lines as files of blocks
submodule (dda_verbs:dda_export) dda_export_blocks
   use dda_key_names, only : scene_geometry
   use dda_line_text, only : has_one_law, line_losses, line_text
   use dda_shape_check, only : check_form
   use dda_shape_text, only : shape_losses, shape_text
   implicit none

contains

   !> Export an arch of any shape, or blocks that were cut from lines, as a file of blocks
   module procedure export_blocks
      character(len=:), allocatable :: text, losses

      status = exit_status%bad_input
      if (source_of(deck) == "shape") then
         call check_form(deck, error)
         if (.not. allocated(error)) text = shape_text(deck)
         losses = shape_losses(deck)
      else
         if (.not. has_one_law(deck)) call key_error(error, "expected joints of one law, got " &
            & //"several: a file of blocks has laws of pairs of block materials; give the law by " &
            & //"the keys of &joint", deck, scene_geometry)
         if (.not. allocated(error)) text = line_text(deck)
         losses = line_losses(deck)
      end if
      if (allocated(error)) return
      status = exit_status%not_written
      call write_text(stem//".blocks", text, error)
      if (allocated(error)) return
      status = exit_status%success
      if (.not. command%quiet) then
         call print_line(command%screen, stem//".blocks, for scene%kind = 'blocks'")
         if (losses /= "") call print_line(command%screen, &
            & "   a file of blocks has no place for "//losses)
         if (has_group(deck, search_group)) call print_line(command%screen, &
            & "   the search is not written: the file holds the deck's own value of its parameter")
      end if
   end procedure export_blocks

end submodule dda_export_blocks
