!> dda help and dda --version
module dda_help
   use, intrinsic :: iso_fortran_env, only : error_unit
   use dda_block_help, only : on_blocks
   use dda_command_line, only : command_t
   use dda_deck_token, only : shown
   use dda_deck_keys, only : deck_group, deck_key
   use dda_deck_key, only : near_one
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
   !> What there is help on
   character(len=*), parameter :: topics(*) = [character(len=6) :: "run", "check", "cut", &
      & "lines", "export", "keys", "models", "blocks", "help"]

   !> dda help
   character(len=*), parameter :: general(*) = [character(len=96) :: &
      & "dda: discontinuous deformation analysis of masonry arches", &
      & "", &
      & "   dda run DECK [DECK ...]     compute every case of every deck", &
      & "   dda check DECK [DECK ...]   read and check decks, compute nothing", &
      & "   dda cut LINES.geo           cut lines into blocks, say what was dropped", &
      & "   dda lines MAP.nml [...]     joint sets, slopes, openings to lines for dda cut", &
      & "   dda export DECK [DECK ...]  write arches and cut blocks as files for other programs", &
      & "   dda help run | check | cut | lines | export", &
      & "                               options of a subcommand (dda run --help does the same)", &
      & "   dda help keys               every group and key of a deck: unit, range, default", &
      & "   dda help keys --json        the same for programs", &
      & "   dda help GROUP | KEY        a group of a deck, or a key: &arch, radius, arch%radius", &
      & "   dda help blocks             the form of a file of blocks", &
      & "   dda help models             what is run with which mode, and what can be searched", &
      & "   dda --help | -h             this page", &
      & "   dda --version               the version", &
      & "", &
      & "A deck is a text file in Fortran's namelist form. A short one that asks a question:", &
      & "", &
      & "   &arch half_angle_deg = 90.0, voussoirs = 36 /", &
      & "   &search parameter = 'thickness_ratio' /", &
      & "", &
      & "Written into arch.nml, 'dda run arch.nml' finds the thickness at which this arch", &
      & "collapses and writes it to arch/results.csv. Units are SI per metre of depth, angles", &
      & "degrees.", &
      & "", &
      & "Exit status: 0 every case reached a verdict; 2 bad input, with a line on standard", &
      & "error, FILE:LINE: error: what is expected, what it got; what to do; 3 a case is", &
      & "undecided or was not finished; 4 results could not be written. Of several, the first", &
      & "of 4, 2, 3."]

   !> dda help run
   character(len=*), parameter :: on_run(*) = [character(len=96) :: &
      & "dda run DECK [DECK ...] [--out DIR] [--jobs N] [--set group%key=value ...]", &
      & "        [--cases LIST] [--resume] [--force] [--tight] [--quiet]", &
      & "", &
      & "   --out DIR   where results go; several decks each have a folder inside it", &
      & "               (without it: a folder named as the deck without its ending)", &
      & "   --jobs N    cases computed at the same time (default 1)", &
      & "   --set group%key=value   overrides the deck; commas for lists; may be repeated", &
      & "               (without it: the deck as it is)", &
      & "   --cases LIST   compute only these cases, such as 1-500,812 (without it: all)", &
      & "   --resume    skip the cases that an earlier run of the same deck with the same", &
      & "               --set has finished; if the deck has changed, compute all again", &
      & "               (without it: compute all again)", &
      & "   --force     overwrite a results.csv, or another table, that dda has not written", &
      & "               (without it: such a file is left alone, and the run ends with 4)", &
      & "   --tight     bounds of searches to 1e-12, as search%tolerance=1e-11 asks for them", &
      & "               (without it: to the tolerance of the deck)", &
      & "   --quiet     print nothing but errors (without it: a line a case of up to 100,", &
      & "               the undecided ones of more, and progress where a terminal shows it)", &
      & "   --          what follows are names of decks, even if they begin with -", &
      & "   --help, -h  this page", &
      & "", &
      & "Writes results.csv (a row a case), joints.csv (a row a joint), blocks.csv (a row a", &
      & "corner), log.txt, and what --resume needs: deck.record (used to verify the deck),", &
      & "sizes.record (the bytes of each case) and disk.record (rows known to be on disk);", &
      & "and run.lock, which is empty and locked while a run writes there: a second one ends", &
      & "with 4.", &
      & "'dda help' lists the exit statuses, 'dda help keys' what a deck may say."]

   !> dda help check
   character(len=*), parameter :: on_check(*) = [character(len=96) :: &
      & "dda check DECK [DECK ...] [--set group%key=value ...] [--record] [--quiet]", &
      & "", &
      & "   --set group%key=value   overrides the deck; commas for lists; may be repeated", &
      & "               (without it: the deck as it is)", &
      & "   --record    print the tables of a run with their columns, and its deck.record", &
      & "               (without it: neither)", &
      & "   --quiet     print nothing but errors (without it: the plan of each deck)", &
      & "   --          what follows are names of decks, even if they begin with -", &
      & "   --help, -h  this page", &
      & "", &
      & "Reads and checks the decks and prints what would be computed, and why. Writes nothing.", &
      & "Exit status: 0 all decks are good; 2 one is not."]

   !> dda help cut
   character(len=*), parameter :: on_cut(*) = [character(len=96) :: &
      & "dda cut LINES.geo [LINES.geo ...] [--out FILE] [--quiet]", &
      & "", &
      & "   --out FILE  where the blocks of one LINES.geo go; ends in .vtu or .csv", &
      & "               (without it: nothing is written)", &
      & "   --quiet     print nothing but errors (without it: counts, areas, what was dropped)", &
      & "   --          what follows are names of files, even if they begin with -", &
      & "   --help, -h  this page", &
      & "", &
      & "Reads geometry files of the Limerick line, plain or DDAML, cuts the lines into blocks,", &
      & "and prints counts, areas, and which parts of lines were dropped, and why.", &
      & "Exit status: 0 all files were cut; 2 one could not be; 4 FILE could not be written."]

   !> dda help lines
   character(len=*), parameter :: on_lines(*) = [character(len=96) :: &
      & "dda lines MAP.nml [MAP.nml ...] [--out FILE.geo] [--quiet]", &
      & "", &
      & "   --out FILE.geo   where the lines of one MAP.nml go", &
      & "               (without it: MAP.geo in the current folder)", &
      & "   --quiet     print nothing but errors (without it: what was drawn)", &
      & "   --          what follows are names of files, even if they begin with -", &
      & "   --help, -h  this page", &
      & "", &
      & "Draws the joints of a rock mass from sets of them, with slopes, openings, bolts and", &
      & "points, clips them to the outline, and writes them for dda cut in the form of the", &
      & "Limerick line; FILE_lines.csv says what each line is for. The same seed gives the", &
      & "same bytes. Groups and keys of a map:", &
      & ""]

   !> dda help export
   character(len=*), parameter :: on_export(*) = [character(len=96) :: &
      & "dda export DECK [DECK ...] [--out DIR] [--set group%key=value ...] [--quiet]", &
      & "", &
      & "   --out DIR   where the files go (without it: the current folder)", &
      & "   --set group%key=value   overrides the deck; commas for lists; may be repeated", &
      & "               (without it: the deck as it is)", &
      & "   --quiet     print nothing but errors (without it: names, and what is lost)", &
      & "   --          what follows are names of decks, even if they begin with -", &
      & "   --help, -h  this page", &
      & "", &
      & "Of a ring of voussoirs, in the conventions of the Limerick line: NAME.geo and", &
      & "NAME_ddaml.geo, NAME.ana (DDAML) and NAME_plain.ana; says what they cannot carry.", &
      & "arch%abutment_size sets the abutments' size.", &
      & "Of an arch of any shape, with fill, a vehicle or ties, and of blocks cut from lines:", &
      & "NAME.blocks, a file for scene%kind = 'blocks', where blocks may then come and go.", &
      & "Exit status: 0 all cases were written; 2 bad input; 4 files could not be written."]

   !> dda help help
   character(len=*), parameter :: on_help(*) = [character(len=96) :: &
      & "dda help [run | check | cut | lines | export | keys [--json] | models | blocks | help |", &
      & "          GROUP | KEY | GROUP%KEY]", &
      & "", &
      & "Prints help on a subcommand, on the keys of a deck, on one group or key of a deck or a", &
      & "joint map, on the models that there are, or on the form of a file of blocks", &
      & "(without a topic: the first page).", &
      & "", &
      & "   --json      groups and keys as JSON: kind, unit, default, range, words, meaning", &
      & "               (without it: as text)"]

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
         write (error_unit, "(a)") "dda:2: error: expected help on run, check, cut, lines, " &
            & //"export, keys, models, blocks, help, a group or a key, got '"//shown(topic)//"'" &
            & //near_one(topic, [character(len=32) :: topics, deck_group%name, map_group%name, &
            & deck_key%name, map_key%name])//"; write one of them"
         status = exit_status%bad_input
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
