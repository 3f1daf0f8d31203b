!> dda help and dda --version
module dda_help
   use, intrinsic :: iso_fortran_env, only : error_unit
   use dda_command_line, only : command_t, is_of_voussoir
   use dda_deck_key, only : near_one
   use dda_deck_keys, only : deck_group, deck_key
   use dda_deck_token, only : shown
   use dda_key_help, only : registry_help, registry_json, topic_help
   use dda_map_keys, only : map_group, map_key
   use dda_model_table, only : models_help
   use dda_process, only : exit_status
   use dda_screen, only : print_line, print_text, screen_t
   implicit none
   private

   public :: print_help, version

   !> Version of the program
   character(len=*), parameter :: version = "0.2.0"
   !> Topics of the help
   character(len=*), parameter :: topics(*) = [character(len=6) :: "run", "check", "cut", &
      & "lines", "export", "keys", "models", "blocks", "help"]

   !> dda help
   character(len=*), parameter :: general(*) = [character(len=96) :: &
      & "dda: discontinuous deformation analysis of masonry arches and blocks", &
      & "", &
      & "   dda run DECK [DECK ...]     compute all cases", &
      & "   dda check DECK [DECK ...]   check decks without computing", &
      & "   dda cut LINES.geo           cut lines into blocks", &
      & "   dda lines MAP.nml [...]     write the lines of joint sets, slopes and openings", &
      & "   dda export DECK [DECK ...]  write arches and cut blocks in other formats", &
      & "   dda help VERB               options of run, check, cut, lines, export", &
      & "   dda help keys               all groups and keys of a deck", &
      & "   dda help keys --json        all groups and keys as JSON", &
      & "   dda help GROUP | KEY        one group or key: &arch, radius, arch%radius", &
      & "   dda help blocks             format of a file of blocks", &
      & "   dda help models             models, and keys that can be searched", &
      & "   dda --help | -h             this page", &
      & "   dda --version               version", &
      & "", &
      & "'voussoir help' lists the commands of the second program, which draws, animates,", &
      & "verifies and exports results, imports drawings, and runs campaigns.", &
      & "", &
      & "A deck is a text file in Fortran's namelist format, such as arch.nml:", &
      & "", &
      & "   &arch half_angle_deg = 90.0, voussoirs = 36 /", &
      & "   &search parameter = 'thickness_ratio' /", &
      & "", &
      & "'dda run arch.nml' finds the critical thickness of this arch and writes it to", &
      & "arch/results.csv. Units are SI per metre of depth, angles are in degrees.", &
      & "", &
      & "Exit status: 0 all cases have a verdict; 2 bad input, with a message FILE:LINE: error;", &
      & "3 a case is undecided or not finished; 4 results could not be written. If several", &
      & "apply: 4 before 2 before 3."]

   !> dda help run
   character(len=*), parameter :: on_run(*) = [character(len=96) :: &
      & "dda run DECK [DECK ...] [--out DIR] [--jobs N] [--set group%key=value ...]", &
      & "        [--cases LIST] [--resume] [--force] [--tight] [--quiet]", &
      & "", &
      & "   --out DIR   folder of the results; with several decks, one folder per deck in it", &
      & "               (without it: a folder with the name of the deck)", &
      & "   --jobs N    number of cases computed at the same time (default 1)", &
      & "   --set group%key=value   override the deck; commas separate lists; repeatable", &
      & "               (without it: the deck as written)", &
      & "   --cases LIST   compute only these cases, such as 1-500,812 (without it: all)", &
      & "   --resume    skip cases that the same deck with the same --set has finished; if the", &
      & "               deck has changed, compute all (without it: compute all)", &
      & "   --force     overwrite tables that dda has not written", &
      & "               (without it: such tables stay, and the exit status is 4)", &
      & "   --tight     close the bounds of searches to 1e-12, as search%tolerance = 1e-11", &
      & "               (without it: to the tolerance of the deck)", &
      & "   --quiet     print errors only (without it: one line per case for up to 100 cases,", &
      & "               beyond that only undecided cases, and progress on a terminal)", &
      & "   --          the next words are names of decks, even if they start with -", &
      & "   --help, -h  this page", &
      & "", &
      & "Writes results.csv (one row per case), joints.csv (one row per joint), blocks.csv (one", &
      & "row per corner) and log.txt. Files for --resume: deck.record (the deck), sizes.record", &
      & "(bytes and checksum per case). run.lock is empty and locked during a run; a second run", &
      & "into the folder ends with status 4.", &
      & "'dda help' lists the exit statuses, 'dda help keys' the keys of a deck.", &
      & "'voussoir plot DIR' draws the results, 'voussoir verify DIR' checks their proofs."]

   !> dda help check
   character(len=*), parameter :: on_check(*) = [character(len=96) :: &
      & "dda check DECK [DECK ...] [--set group%key=value ...] [--record] [--quiet]", &
      & "", &
      & "   --set group%key=value   override the deck; commas separate lists; repeatable", &
      & "               (without it: the deck as written)", &
      & "   --record    print the tables of a run with their columns, and deck.record", &
      & "               (without it: neither)", &
      & "   --quiet     print errors only (without it: the plan of each deck)", &
      & "   --          the next words are names of decks, even if they start with -", &
      & "   --help, -h  this page", &
      & "", &
      & "Checks decks and prints the plan of the computation. Writes nothing.", &
      & "Exit status: 0 all decks are good; 2 at least one is not."]

   !> dda help cut
   character(len=*), parameter :: on_cut(*) = [character(len=96) :: &
      & "dda cut LINES.geo [LINES.geo ...] [--out FILE] [--quiet]", &
      & "", &
      & "   --out FILE  file of the blocks of one LINES.geo, .vtu or .csv", &
      & "               (without it: nothing is written)", &
      & "   --quiet     print errors only (without it: counts, areas, dropped lines)", &
      & "   --          the next words are names of files, even if they start with -", &
      & "   --help, -h  this page", &
      & "", &
      & "Reads geometry files of the Limerick line, plain or DDAML, cuts the lines into blocks,", &
      & "and prints counts, areas, and the dropped parts of lines with reasons.", &
      & "'voussoir plot LINES.geo' draws the blocks.", &
      & "Exit status: 0 all files were cut; 2 one could not be cut; 4 FILE could not be written."]

   !> dda help lines
   character(len=*), parameter :: on_lines(*) = [character(len=96) :: &
      & "dda lines MAP.nml [MAP.nml ...] [--out FILE.geo] [--quiet]", &
      & "", &
      & "   --out FILE.geo   file of the lines of one MAP.nml", &
      & "               (without it: MAP.geo in the current folder)", &
      & "   --quiet     print errors only (without it: numbers of lines)", &
      & "   --          the next words are names of files, even if they start with -", &
      & "   --help, -h  this page", &
      & "", &
      & "Writes lines of joint sets, slopes, openings, bolts and points for dda cut, clipped to", &
      & "an outline, in the format of the Limerick line. FILE_lines.csv lists the purpose of", &
      & "each line; 'voussoir lines FILE_lines.csv' draws it. Equal seeds give equal files.", &
      & "Groups and keys of a map:", &
      & ""]

   !> dda help export
   character(len=*), parameter :: on_export(*) = [character(len=96) :: &
      & "dda export DECK [DECK ...] [--out DIR] [--set group%key=value ...] [--quiet]", &
      & "", &
      & "   --out DIR   folder of the files (without it: the current folder)", &
      & "   --set group%key=value   override the deck; commas separate lists; repeatable", &
      & "               (without it: the deck as written)", &
      & "   --quiet     print errors only (without it: names, and data that are lost)", &
      & "   --          the next words are names of decks, even if they start with -", &
      & "   --help, -h  this page", &
      & "", &
      & "A ring of voussoirs becomes files of the Limerick line: NAME.geo and NAME_ddaml.geo,", &
      & "NAME.ana (DDAML) and NAME_plain.ana. arch%abutment_size is the size of the abutments.", &
      & "Arches of other shapes, with fill, a vehicle or ties, and blocks cut from lines become", &
      & "NAME.blocks, a file for scene%kind = 'blocks'.", &
      & "'voussoir export DIR FILE' writes the blocks of a result as a drawing or mesh.", &
      & "Exit status: 0 all cases were written; 2 bad input; 4 files could not be written."]

   !> dda help help
   character(len=*), parameter :: on_help(*) = [character(len=96) :: &
      & "dda help [run | check | cut | lines | export | keys [--json] | models | blocks | help |", &
      & "          GROUP | KEY | GROUP%KEY]", &
      & "", &
      & "Prints help on a subcommand, the keys of a deck, a group or key of a deck or joint map,", &
      & "the models, or the format of a file of blocks (without a topic: the first page).", &
      & "", &
      & "   --json      groups and keys as JSON: kind, unit, default, range, words, meaning", &
      & "               (without it: as text)"]

   !> The page, line by line
   character(len=*), parameter :: on_blocks(*) = [character(len=96) :: &
      & "A file of blocks (scene%kind = 'blocks', scene%geometry = 'FILE') is plain text in", &
      & "UTF-8: one entry per line, with rows of numbers below it. Blanks separate words, case", &
      & "is ignored, and ! starts a comment. Units are SI per metre of depth.", &
      & "", &
      & "   block fixed              ! never moves", &
      & "   -1 -1", &
      & "    2 -1", &
      & "    2  0", &
      & "   -1  0", &
      & "   block material 2", &
      & "    0  0", &
      & "    1  0", &
      & "    1  2", &
      & "    0  2", &
      & "   material 2 density 2500 young 1e10", &
      & "   joint 1 2 friction_deg 35", &
      & "", &
      & "block [fixed] [material N] [velocity vx vy w] [stress sx sy txy]", &
      & "   A polygon; rows x y of its corners [m] follow. Velocity [m/s], spin [rad/s], stress", &
      & "   [Pa].", &
      & "material N [density d] [unit_weight w] [young e] [poisson p] [compressive_strength s]", &
      & "   Material N from 2. Material 1 and omitted values are those of the deck.", &
      & "joint I J [friction_deg f] [cohesion c] [tension t] [residual_deg r] [slip_length d]", &
      & "   Law of the joints between materials I and J.", &
      & "fix x y [x or y]", &
      & "   Restraint of a point, in one direction if named.", &
      & "fix_line x1 y1 x2 y2 [x or y]", &
      & "   Restraints at both ends of the part of the line in each block.", &
      & "measure x y", &
      & "   Monitoring point, for points.csv.", &
      & "load x y fx fy", &
      & "   Dead load on a point [N/m]; instead of fx fy, rows time fx fy may follow.", &
      & "load block N x y fx fy", &
      & "   Dead load on block N. live, fix, measure and displacement accept block N as well.", &
      & "live x y fx fy", &
      & "   Live load, multiplied by load%load_factor.", &
      & "displacement x y ux uy", &
      & "   Prescribed displacement [m], or rows time ux uy; load%displacement_factor scales it.", &
      & "bar x1 y1 x2 y2 stiffness S [strength T] [prestress P] [slack] [breaks]", &
      & "   Bolt, anchor or tie [N/m, N]; `ea V` instead of stiffness is divided by the length.", &
      & "water x y x y ... [unit_weight W] [factor F]", &
      & "   Piezometric line from left to right; rows time rise may follow.", &
      & "absorb x1 y1 x2 y2 [x or y] [p_speed V] [s_speed V]", &
      & "   Absorbing boundary along the faces on a line (mode = 'dynamic').", &
      & "remove block N ... at T, add block N ... at T", &
      & "   Blocks removed or built at time T [s]; `polygon` and rows x y select them by their", &
      & "   centre of gravity.", &
      & "base_acceleration ax ay", &
      & "   Ground acceleration [m/s2], or rows time ax ay.", &
      & "base_velocity, base_displacement", &
      & "   Ground motion [m/s, m]: rows time x y.", &
      & "", &
      & "Instead of rows of times: file 'RECORD' [columns T X [Y]] [scale S]. Columns are", &
      & "numbers from 1 or names of the header, in quotes if they contain blanks.", &
      & "Draw the file: 'voussoir plot FILE.blocks'. The key: 'dda help output%blocks'."]

contains

   !> Print help on a topic
   subroutine print_help(command, status)
      type(command_t), intent(in) :: command
      integer, intent(out) :: status  !! Exit status of the program
      character(len=:), allocatable :: found, topic

      status = exit_status%success
      topic = ""
      if (size(command%name) > 0) topic = trim(command%name(1)%text)
      if (size(command%name) > 1) then
         if (topic == "keys" .and. command%name(2)%text == "--json" &
            & .and. size(command%name) == 2) then
            call print_text(command%screen, registry_json(deck_group, deck_key))
         else
            write (error_unit, "(a)") "dda:3: error: expected one topic, or keys --json, got '" &
               & //shown(command%name(size(command%name))%text)//"' too; remove it"
            status = exit_status%bad_input
         end if
         return
      end if
      select case (topic)
      case ("")
         call print_lines(command%screen, general)
      case ("run")
         call print_lines(command%screen, on_run)
      case ("check")
         call print_lines(command%screen, on_check)
      case ("cut")
         call print_lines(command%screen, on_cut)
      case ("lines")
         call print_lines(command%screen, on_lines)
         call print_text(command%screen, registry_help(map_group, map_key))
      case ("export")
         call print_lines(command%screen, on_export)
      case ("help", "--help", "-h")
         call print_lines(command%screen, on_help)
      case ("keys")
         call print_text(command%screen, registry_help(deck_group, deck_key))
      case ("blocks")
         call print_lines(command%screen, on_blocks)
      case ("models")
         call print_text(command%screen, models_help())
      case default
         found = topic_help(topic, [deck_group, map_group], [deck_key, map_key])
         call print_text(command%screen, found)
         if (found /= "") return
         status = exit_status%bad_input
         if (is_of_voussoir(topic)) then
            write (error_unit, "(a)") "dda:2: error: expected a topic of dda, got '"//topic &
               & //"', which voussoir has; write 'voussoir help "//topic//"'"
            return
         end if
         write (error_unit, "(a)") "dda:2: error: expected help on run, check, cut, lines, " &
            & //"export, keys, models, blocks, help, a group or a key, got '"//shown(topic)//"'" &
            & //near_one(topic, [character(len=32) :: topics, deck_group%name, map_group%name, &
            & deck_key%name, map_key%name])//"; write one of them"
      end select
   end subroutine print_help

   !> Print lines of text
   subroutine print_lines(screen, lines)
      type(screen_t), intent(in) :: screen
      character(len=*), intent(in) :: lines(:)  !! The lines: (n)
      integer :: i

      do i = 1, size(lines)
         call print_line(screen, trim(lines(i)))
      end do
   end subroutine print_lines

end module dda_help
