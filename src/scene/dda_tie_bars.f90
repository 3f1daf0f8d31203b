!> Ties of an arch: bars of a deck between two points of its blocks
module dda_tie_bars
   use dda_arch_assembly, only : arch_assembly_t
   use dda_arch_form, only : form_problem_t
   use dda_bar, only : bar_t
   use dda_block_input, only : block_plan_t
   use dda_block_sites, only : block_at, site_t, survey
   use dda_deck, only : deck_error, deck_t, key_error
   use dda_deck_keys, only : deck_key
   use dda_deck_key, only : full_name
   use dda_error, only : error_t
   use dda_key_names, only : search_parameter, tie_ea, tie_group, tie_prestress, tie_strength, &
      & tie_x1, tie_x2, tie_y1
   use dda_kinds, only : wp
   use dda_shape_scene, only : shape_assembly
   use dda_text, only : to_text
   implicit none
   private

   public :: add_ties, check_ties

contains

   !> Put the bars of &tie between the blocks that hold their ends
   pure subroutine add_ties(deck, plan)
      type(deck_t), intent(in) :: deck           !! The deck of the case, with &tie, checked
      type(block_plan_t), intent(inout) :: plan  !! The blocks; receives the bars
      type(bar_t), allocatable :: bar(:)
      type(site_t) :: site
      real(wp), allocatable :: ends(:, :)
      integer :: i, side

      call tie_ends(deck, ends)
      allocate (bar(size(ends, 2)))
      call survey(plan, site)
      do i = 1, size(bar)
         bar(i)%point = reshape(ends(:, i), [2, 2]) - spread(plan%origin, 2, 2)
         do side = 1, 2
            bar(i)%block(side) = block_at(plan, site, bar(i)%point(:, side))
         end do
         bar(i)%pushes = .false.
         bar(i)%stiffness = deck%value(tie_ea)%numbers(i)/norm2(ends(3:4, i) - ends(1:2, i))
         if (deck%value(tie_strength)%given) bar(i)%strength = deck%value(tie_strength)%numbers(i)
         if (deck%value(tie_prestress)%given) bar(i)%prestress = &
            & deck%value(tie_prestress)%numbers(i)
      end do
      call move_alloc(bar, plan%boundary%bar)
   end subroutine add_ties

   !> Ends of all ties
   pure subroutine tie_ends(deck, ends)
      type(deck_t), intent(in) :: deck
      !> x and y of the one end, then of the other: (4, n) [m]
      real(wp), allocatable, intent(out) :: ends(:, :)

      integer :: i

      allocate (ends(4, size(deck%value(tie_x1)%numbers)))
      do i = 1, 4
         ends(i, :) = deck%value(tie_x1 + i - 1)%numbers
      end do
   end subroutine tie_ends

   !> Check the ties of a case
   pure subroutine check_ties(deck, error)
      type(deck_t), intent(in) :: deck
      !> Lists that do not go together, or an end in no block
      type(error_t), allocatable, intent(out) :: error
      integer :: key, n

      n = size(deck%value(tie_x1)%numbers)
      if (n == 0) then
         call deck_error(error, "&tie needs x1, y1, x2 and y2, the ends of each tie, got none; "// &
            & "give them", deck, deck%group(tie_group))
         return
      end if
      do key = tie_y1, tie_prestress
         if (key > tie_ea .and. .not. deck%value(key)%given) cycle
         if (size(deck%value(key)%numbers) == n) cycle
         call key_error(error, full_name(deck_key(key))//" needs as many numbers as tie%x1, " &
            & //to_text(n)//", got "//to_text(size(deck%value(key)%numbers)) &
            & //"; give one per tie", deck, key)
         return
      end do
      if (deck_key(max(1, deck%searched%key))%group == "arch" .and. deck%searched%key > 0) then
         call key_error(error, "&tie needs an arch that keeps its shape, but the search "// &
            & "changes it, and its ends stay; sweep the shape, with the ends linked", deck, &
            & search_parameter)
         return
      end if
      call check_ends(deck, error)
   end subroutine check_ties

   !> Check that ties lie between blocks
   pure subroutine check_ends(deck, error)
      type(deck_t), intent(in) :: deck
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: problem
      type(arch_assembly_t) :: assembly
      type(form_problem_t) :: no_form
      real(wp), allocatable :: ends(:, :)
      integer :: i, side

      call tie_ends(deck, ends)
      call shape_assembly(deck, assembly, no_form)
      if (len_trim(no_form%text) > 0) return
      do i = 1, size(ends, 2)
         if (norm2(ends(3:4, i) - ends(1:2, i)) > 0.0_wp) cycle
         call key_error(error, "&tie needs ends that are apart, got tie "//to_text(i)// &
            & " between equal points; move one", deck, tie_x1)
         return
      end do
      call add_ties(deck, assembly%plan)
      problem = ""
      do i = 1, size(ends, 2)
         associate (bar => assembly%plan%boundary%bar(i))
            side = findloc(bar%block, 0, dim=1)
            if (side > 0) then
               problem = "&tie needs ends in blocks, got ("//to_text(ends(2*side - 1, i))//", " &
                  & //to_text(ends(2*side, i))//") of tie "//to_text(i)//", which lies in none; " &
                  & //"move it"
            else if (bar%block(1) == bar%block(2)) then
               side = 1
               problem = "&tie needs ends in two blocks, got both of tie "//to_text(i) &
                  & //" in block "//to_text(bar%block(1))//"; move one"
            else if (all(assembly%plan%fixed(bar%block))) then
               side = 1
               problem = "&tie needs a block that moves, got tie "//to_text(i) &
                  & //" between two that are fixed; move one end, or remove the tie"
            else if (bar%prestress > bar%strength) then
               call key_error(error, "tie%prestress must be at most tie%strength, got " &
                  & //to_text(bar%prestress)//" for tie "//to_text(i)//"; lower it", deck, &
                  & tie_prestress)
               return
            end if
         end associate
         if (len(problem) == 0) cycle
         call key_error(error, problem, deck, merge(tie_x1, tie_x2, side == 1))
         return
      end do
   end subroutine check_ends
end module dda_tie_bars
