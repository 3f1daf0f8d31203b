!> dda check: read and check decks, and report the computation
submodule (dda_verbs) dda_check
   use dda_boundary, only : boundary_t
   use dda_deck, only : deck_t, geometry_of, has_group, keeps_velocities, source_of
   use dda_deck_scene, only : deck_scene
   use dda_deck_sweep, only : n_cases, turn_to_case
   use dda_error, only : error_line
   use dda_key_names, only : analysis_mode, output_condition, output_energy, output_frames, &
      & output_joints, output_restart, output_vtu, scene_kind, scene_title, search_group, &
      & search_parameter
   use dda_limerick_model, only : half_size, limerick_model_t
   use dda_limerick_scene, only : limerick_scene
   use dda_model_table, only : models_of, searches_of
   use dda_process, only : deck_stem, error_is_terminal, exit_status
   use dda_read_deck, only : read_deck
   use dda_result_tables, only : left_out, name_tables, result_tables_t
   use dda_run_record, only : run_record
   use dda_scene, only : scene_t
   use dda_scene_check, only : check_lines, check_scene
   use dda_scene_plan, only : plan_scene, scene_plan_t, strain_reason
   use dda_screen, only : end_watch, print_line, print_warnings, screen_t, terminal_watch_t
   use dda_text, only : counted, place_text, short_text, to_text
   use dda_vehicle_list, only : vehicle_words
   implicit none

contains

   !> Check a deck
   module procedure check_file
      type(deck_t) :: deck
      type(scene_t) :: scene
      type(terminal_watch_t) :: watch
      character(len=:), allocatable :: record

      watch%shown = error_is_terminal() .and. .not. command%quiet
      call read_deck(name, command%setting, deck, error, watch)
      if (.not. allocated(error)) call check_scene(deck, scene, error, watch)
      call end_watch(watch)
      status = merge(exit_status%bad_input, exit_status%success, allocated(error))
      if (allocated(error)) return
      record = record_text(deck, deck_stem(name))
      if (.not. command%quiet) then
         call print_warnings(deck%warnings)
         call print_plan(command%screen, name, deck, scene)
      end if
      if (command%record) call print_line(command%screen, record)
   end procedure check_file

   !> Names and headers of the tables of a run, and its deck.record
   function record_text(deck, stem) result(text)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: stem   !! Name of the deck without folder and extension
      character(len=:), allocatable :: text  !! Lines separated by line ends
      type(result_tables_t) :: tables
      integer :: i

      call name_tables(deck, "", tables)
      text = "tables:"//new_line("a")
      do i = 1, size(tables%at)
         if (tables%at(i)%wanted) text = text//"   "//tables%at(i)%file(2:)//" " &
            & //tables%at(i)%header//new_line("a")
      end do
      text = text//"deck.record:"//new_line("a")//run_record(deck, stem)
   end function record_text

   !> Print the plan of a deck
   subroutine print_plan(screen, name, deck, scene)
      type(screen_t), intent(in) :: screen
      character(len=*), intent(in) :: name  !! Name of the deck
      type(deck_t), intent(inout) :: deck
      !> Scene of the first case, if the blocks are from a file
      type(scene_t), intent(inout) :: scene
      type(deck_t) :: first
      type(scene_plan_t) :: plan
      type(error_t), allocatable :: error
      character(len=:), allocatable :: swept
      integer :: s, blocks
      logical :: arch

      arch = source_of(deck) == "arch"
      call turn_to_case(deck, 1, first, error)
      plan = plan_scene(first)
      if (.not. allocated(scene%contacts%joint)) call deck_scene(first, scene)
      blocks = maxval(scene%system%equation)
      swept = ""
      do s = 1, size(deck%sweeps)
         swept = swept//" "//trim(deck%sweeps(s)%name)
      end do
      call print_line(screen, name//": "//deck%value(scene_title)%text)
      call tell(screen, "cases", to_text(n_cases(deck)))
      if (swept /= "") call tell(screen, "swept", swept(2:))
      if (has_group(deck, search_group)) then
         call tell(screen, "search", deck%value(search_parameter)%text)
      else
         call tell(screen, "search", "none")
      end if
      if (left_out(deck) /= "") call tell(screen, "tables", left_out(deck))
      call check_lines(deck, error)
      if (allocated(error)) call tell(screen, "not to run", error_line(error))
      call print_line(screen, "   the first case:")
      call print_model(screen, first)
      if (first%value(analysis_mode)%text == "limerick") then
         call print_limerick_plan(screen, first, scene)
         return
      end if
      call tell(screen, "blocks", &
         & to_text(blocks)//" free, "//to_text(size(scene%system%equation) &
         & - blocks)//trim(merge(" fixed springings", " fixed           ", arch)))
      call tell(screen, "joints", joints_text(scene))
      call tell(screen, "strength", merge("cohesion or tension, until a joint breaks", &
         & "none: friction only                      ", has_strength(scene)))
      call tell(screen, "points", points_text(scene%settings%boundary))
      if (vehicle_words(deck) /= "") call tell(screen, "vehicle", vehicle_words(deck))
      call print_parts(screen, first, plan, blocks)
      call tell(screen, "other output", tables_text(first))
      if (.not. arch) call print_blocks(screen, scene)
   end subroutine print_plan

   !> True if a joint has strength other than friction; tensile strength needs cohesion if there is
   !> friction
   pure logical function has_strength(scene)
      type(scene_t), intent(in) :: scene

      associate (law => scene%contacts%law(scene%contacts%joint%law))
         has_strength = any(law%cohesion > 0.0 .or. law%tension > 0.0 &
            & .and. (law%no_slip .or. .not. law%friction > 0.0))
      end associate
   end function has_strength

   !> Print number, area and centre of each block
   subroutine print_blocks(screen, scene)
      type(screen_t), intent(in) :: screen
      type(scene_t), intent(in) :: scene
      integer, parameter :: most_rows = 50
      integer :: b

      call print_line(screen, "   block  area  centre")
      associate (system => scene%system, n => size(scene%system%area))
         do b = 1, min(n, most_rows)
            call print_line(screen, "   "//to_text(b)//"  "//short_text(system%area(b))//"  " &
               & //place_text(system%centroid(:, b) + scene%origin) &
               & //trim(merge("  fixed", "       ", system%equation(b) == 0)))
         end do
         if (n > most_rows) call print_line(screen, "   and "//to_text(n - most_rows)//" more")
      end associate
   end subroutine print_blocks

   !> Print the model, the other models, and the parameters that can be searched
   subroutine print_model(screen, deck)
      type(screen_t), intent(in) :: screen
      type(deck_t), intent(in) :: deck
      character(len=:), allocatable :: kind, mode

      kind = trim(source_of(deck))
      mode = deck%value(analysis_mode)%text
      call tell(screen, "model", kind//", "//mode//" "//trim(geometry_of(deck)) &
         & //"; available for "//kind//": "//models_of(kind))
      if (keeps_velocities(deck)) mode = "dynamic"
      call tell(screen, "searchable", searches_of(kind, mode))
   end subroutine print_model

   !> Numbers of restrained, loaded and monitoring points
   pure function points_text(boundary) result(text)
      type(boundary_t), intent(in) :: boundary
      character(len=:), allocatable :: text
      integer :: n(3)

      n = 0
      if (allocated(boundary%held)) n(1) = size(boundary%held)
      if (allocated(boundary%loaded)) n(2) = size(boundary%loaded)
      if (allocated(boundary%measured)) n(3) = size(boundary%measured)
      text = "none"
      if (any(n > 0)) text = to_text(n(1))//" fixed or prescribed, "//to_text(n(2)) &
         & //" loaded, "//to_text(n(3))//" monitoring"
   end function points_text

   !> Names of tables in addition to results.csv and joints.csv
   pure function tables_text(deck) result(text)
      type(deck_t), intent(in) :: deck
      character(len=:), allocatable :: text

      text = ""
      if (deck%value(output_vtu)%flag) text = text//", vtu"
      if (deck%value(output_energy)%flag) text = text//", energy"
      if (deck%value(output_condition)%flag) text = text//", condition"
      if (deck%value(output_restart)%flag) text = text//", restart"
      if (text == "") then
         text = "none"
      else
         text = text(3:)
      end if
   end function tables_text

   !> Print the plan of a case of Shi's scheme
   subroutine print_limerick_plan(screen, deck, scene)
      type(screen_t), intent(in) :: screen
      type(deck_t), intent(in) :: deck
      type(scene_t), intent(in) :: scene
      type(limerick_model_t) :: model
      integer :: n

      call limerick_scene(deck, scene, model)
      n = size(model%block_material)
      if (deck%value(scene_kind)%text == "arch") then
         call tell(screen, "blocks", to_text(n - 2)//" and 2 abutments, each fixed at 4 points")
      else
         call tell(screen, "blocks", to_text(n)//", fixed at " &
            & //counted(size(model%boundary%held), "point"))
      end if
      call tell(screen, "half size", &
         & short_text(half_size(model))//" m: the scale of penetration, opening and motion")
      call tell(screen, "contacts", "vertex to edge or vertex to vertex; detected in each step")
      call tell(screen, "unknowns", "6 per block, "//to_text(6*n)//" in all")
      call tell(screen, "penalty", merge("follows the penetration, up or down", &
         & "fixed                              ", model%constants%auto_penalty))
      call tell(screen, "velocities", merge("kept                            ", &
         & "none: every step starts at rest ", model%constants%dynamic))
   end subroutine print_limerick_plan

   !> Number of joints, and their lifetime
   pure function joints_text(scene) result(text)
      type(scene_t), intent(in) :: scene
      character(len=:), allocatable :: text
      integer :: singles

      singles = count(scene%contacts%joint%n_contact == 1)
      text = to_text(size(scene%contacts%joint) - singles)//" of two normal springs and one "// &
         & "shear spring"
      if (singles > 0) text = text//", "//to_text(singles)//" of one corner against an edge"
      if (.not. scene%settings%current) then
         text = text//"; fixed contact pairs (small displacements)"
      else if (scene%contacts%searched) then
         text = text//"; contacts detected in every step"
      else
         text = text//"; fixed contact pairs that follow the blocks"
      end if
   end function joints_text

   !> Print the parts of the method for a case, with reasons
   subroutine print_parts(screen, deck, plan, blocks)
      type(screen_t), intent(in) :: screen
      type(deck_t), intent(in) :: deck
      type(scene_plan_t), intent(in) :: plan
      integer, intent(in) :: blocks  !! Number of movable blocks

      call tell(screen, "unknowns", &
         & to_text(plan%unknowns)//" per block, "//to_text(plan%unknowns*blocks) &
         & //" in all: "//trim(why(plan%reason)))
      if (plan%chain) then
         call tell(screen, "equations", "chain: each block touches only its two neighbours")
            if (plan%halved) call tell(screen, "", "half model (vertical loads)")
      else
         call tell(screen, "equations", "general sparse system")
      end if
      call tell(screen, "velocities", &
         & trim(merge("kept: mode is dynamic                          ", &
         & "none: every step starts at rest, mode is static", plan%velocities)))
      if (deck%value(output_joints)%flag) then
         call tell(screen, "joints.csv", "joint forces of the run itself")
      else
         call tell(screen, "joints.csv", "none: output%joints is "//trim(merge( &
            & ".false.  ", "not given", deck%value(output_joints)%given)))
      end if
      if (nint(deck%value(output_frames)%number) > 0) then
         call tell(screen, "frames", "the case is run once more for its frames")
      else
         call tell(screen, "frames", "none: output%frames is 0")
      end if
   end subroutine print_parts

   !> Reason for the number of unknowns of a block
   pure function why(reason) result(words)
      integer, intent(in) :: reason  !! One of strain_reason
      character(len=100) :: words

      words = "set by analysis%unknowns"
      if (reason == strain_reason%none) words = "rigid: only equilibrium matters here"
      if (reason == strain_reason%moving) words = "deformable: strain moves the corners"
      if (reason == strain_reason%dynamic) words = "deformable: moving blocks vibrate"
      if (reason == strain_reason%strength) words = "deformable: strain decides which joint "// &
         & "breaks first"
      if (reason == strain_reason%forces) words = "deformable: strain distributes joint forces"
      if (reason == strain_reason%files) words = "deformable: blocks of a file may have "// &
         & "materials and stress of their own"
      if (reason == strain_reason%displacement) words = "deformable: strain is part of the "// &
         & "displacement that means collapse"
   end function why

   !> Print one line of the plan
   subroutine tell(screen, label, value)
      type(screen_t), intent(in) :: screen
      character(len=*), intent(in) :: label  !! Label of the line
      character(len=*), intent(in) :: value  !! Value and reason
      character(len=14) :: padded

      padded = label
      call print_line(screen, "   "//padded//trim(value))
   end subroutine tell
end submodule dda_check
