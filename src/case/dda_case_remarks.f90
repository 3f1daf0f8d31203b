!> Remarks on a computed case, printed and written beside its row
module dda_case_remarks
   use dda_block_system, only : block_system_t
   use dda_case, only : searched_name
   use dda_deck, only : deck_t
   use dda_key_names, only : search_high
   use dda_kinds, only : degree, wp
   use dda_search, only : critical_t, search_t
   use dda_settings, only : overturned, settings_t, verdict
   use dda_step_context, only : contact_note_t
   use dda_text, only : counted, short_text, to_text
   use dda_verdict, only : largest_displacement, outcome_t
   implicit none
   private

   public :: change_remark, completed_remark, contact_remark, fall_remark, joined, jump_remark
   public :: has_bracket, path_remark, range_remark, undecided_remark

   !> Displacement of a moving block over the largest
   real(wp), parameter :: moves = 1.0e-3_wp
   !> Maximum number of named blocks
   integer, parameter :: most_named = 5

contains

   !> Remark on the blocks of a collapse that leaves most blocks at rest, such as one loose block
   pure function fall_remark(system, motion) result(remark)
      type(block_system_t), intent(in) :: system  !! The blocks at the beginning
      real(wp), intent(in) :: motion(:, :)        !! Their collapse: (n_dof, n_equation)
      character(len=:), allocatable :: remark
      real(wp) :: way(size(system%equation))
      integer :: b, e, i, n

      remark = ""
      way = 0.0_wp
      do b = 1, size(way)
         e = system%equation(b)
         if (e > 0 .and. e <= size(motion, 2)) way(b) = norm2(motion(1:2, e)) &
            & + abs(motion(3, e))*sqrt(system%area(b))
      end do
      n = count(way > moves*maxval(way))
      if (n == 0 .or. 3*n > count(system%equation > 0)) return
      remark = "of "//to_text(count(system%equation > 0))//" blocks "//to_text(n) &
         & //trim(merge(" moves", " move ", n == 1))//":"
      do i = 1, min(n, most_named)
         b = maxloc(way, dim=1)
         way(b) = -1.0_wp
         if (i > 1) remark = remark//","
         remark = remark//" "//to_text(b)
      end do
      if (n > most_named) remark = remark//" and others"
   end function fall_remark

   !> Remark on a dynamic run that ends without a collapse although it may hide one: it has no key
   !> that detects it, or a block has turned far without reaching the angle that counts as collapse
   pure function completed_remark(settings, system) result(remark)
      type(settings_t), intent(in) :: settings
      type(block_system_t), intent(in) :: system  !! The blocks at the end
      character(len=:), allocatable :: remark
      integer :: b

      remark = ""
      if (.not. settings%current) then
         remark = "geometry = 'reference' shows no collapse; the largest displacement is " &
            & //short_text(largest_displacement(system, .false.))//" m. " &
            & //"Set geometry = 'current' for large displacements."
      else
         b = maxloc(abs(system%motion(3, :)), dim=1)
         if (abs(system%motion(3, b)) < overturned) return
         remark = "block "//to_text(b)//" turned by " &
            & //short_text(abs(system%motion(3, b))/degree)//" degrees"
         if (settings%collapse_rotation > 0.0_wp) then
            ! a block that lies flat on its side has turned by 90 degrees, or a little less
            remark = remark//", less than collapse_rotation_deg = " &
               & //short_text(settings%collapse_rotation/degree)//": this may be a collapse; set 45"
         else if (settings%collapse_displacement <= 0.0_wp) then
            remark = remark &
               & //"; set collapse_rotation_deg or collapse_displacement to detect a collapse"
         end if
      end if
   end function completed_remark

   !> Remark on a search without a collapse: the range of the deck, or why there can be none
   pure function range_remark(deck, search, settings) result(remark)
      type(deck_t), intent(in) :: deck
      type(search_t), intent(in) :: search
      type(settings_t), intent(in) :: settings
      character(len=:), allocatable :: remark

      remark = ""
      if (searched_name(deck) == "displacement_factor" .and. .not. settings%current) then
         remark = "geometry = 'reference' keeps the shape, so displacements of supports cause " &
            & //"no collapse. Set geometry = 'current'."
      else if (.not. deck%value(search_high)%given) then
         ! a default range covers all values
      else if (search%low > 0.0_wp) then
         remark = "no collapse between search%low = "//short_text(search%low) &
            & //" and search%high = "//short_text(search%high)//"; set them farther apart"
      else
         remark = "no collapse up to search%high = "//short_text(search%high)//"; raise it"
      end if
   end function range_remark

   !> Remark on the path of a static run
   pure function path_remark(outcome) result(remark)
      type(outcome_t), intent(in) :: outcome
      character(len=:), allocatable :: remark
      character(len=:), allocatable :: place

      remark = ""
      if (outcome%verdict /= verdict%stable) then
         place = " time "//short_text(outcome%path_time)
         if (outcome%path_time < 0.0_wp) place = " "//short_text(1.0_wp + outcome%path_time) &
            & //" of the prescribed displacement"
         remark = trim(merge("the blocks collapse at     ", "equilibrium is proven up to", &
            & outcome%verdict == verdict%collapsed))//place
      end if
      ! why forces after stages are not those of the last shape built at once
      if (outcome%n_slid > 0) remark = joined(remark, "joints that slid between stages: " &
         & //to_text(outcome%n_slid)//numbered(outcome%slid))
      if (outcome%has_built) remark = joined(remark, "blocks were built between stages")
      if (outcome%slides_at_once) remark = joined(remark, "no joint slid between stages, " &
         & //"but the last shape slides or collapses if it is built at once")
      if (outcome%n_slid > 0 .or. outcome%has_built .or. outcome%slides_at_once) &
         & remark = joined(remark, "forces depend on the order of the stages")
   end function path_remark

   !> Join two remarks
   pure function joined(first, second) result(both)
      character(len=*), intent(in) :: first   !! First remark; may be empty
      character(len=*), intent(in) :: second  !! Second remark; may be empty
      character(len=:), allocatable :: both   !! Both, separated by a semicolon

      both = first//second
      if (min(len(first), len(second)) > 0) both = first//"; "//second
   end function joined

   !> List of joint numbers in parentheses, cut off after twelve; empty without joints
   pure function numbered(joint) result(text)
      integer, intent(in) :: joint(:)  !! The numbers: (n)
      character(len=:), allocatable :: text
      integer, parameter :: most = 12
      integer :: i

      text = ""
      do i = 1, min(size(joint), most)
         text = text//", "//to_text(joint(i))
      end do
      if (size(joint) > most) text = text//" and others"
      if (len(text) > 0) text = " ("//text(3:)//")"
   end function numbered

   !> Remark on the decisions outside the bracket of a search of dynamic runs
   pure function change_remark(critical) result(remark)
      type(critical_t), intent(in) :: critical
      character(len=:), allocatable :: remark
      character(len=:), allocatable :: agree
      integer :: i

      agree = trim(merge("agrees", "agree ", critical%others == 1))
      if (.not. allocated(critical%other_change)) then
         remark = counted(critical%others, "value")//" between the ends "//agree//" with them"
      else if (size(critical%other_change) == 0) then
         remark = counted(critical%others, "value")//" on both sides "//agree//" with it"
      else
         remark = "not monotone: the answer changes again"
         do i = 1, size(critical%other_change, 2)
            if (i > 1) remark = remark//","
            remark = remark//" between "//short_text(critical%other_change(1, i))//" and " &
               & //short_text(critical%other_change(2, i))
         end do
      end if
   end function change_remark

   !> True if a value that collapses and one that is stable are known
   pure logical function has_bracket(critical)
      type(critical_t), intent(in) :: critical

      has_bracket = allocated(critical%fallen) .and. allocated(critical%standing)
   end function has_bracket

   !> Value at which a search is undecided, and the reason; at the upper end of the range a remedy
   pure function undecided_remark(search, critical) result(remark)
      type(search_t), intent(in) :: search
      type(critical_t), intent(in) :: critical
      character(len=:), allocatable :: remark

      remark = "the bracket cannot be narrowed further"
      if (allocated(critical%reason)) then
         remark = "at "//short_text(critical%undecided_at)//": "//critical%reason
         if (critical%undecided_at >= search%high) remark = "at search%high = " &
            & //short_text(critical%undecided_at)//": "//critical%reason//"; lower search%high"
      end if
      if (has_bracket(critical)) remark = remark &
         & //"; collapsed at "//short_text(critical%falls)//", stable at " &
         & //short_text(critical%stands)
   end function undecided_remark

   !> Remark on contact residuals and on reduced restitution
   pure function contact_remark(rough, reduced) result(remark)
      type(contact_note_t), intent(in) :: rough    !! The worst contact [m/s]
      type(contact_note_t), intent(in) :: reduced  !! The impact that lacks the most
      character(len=:), allocatable :: remark

      remark = ""
      if (rough%value > 0.0_wp) remark = "contact forces leave openings or slips of up to " &
         & //short_text(rough%value)//" m/s against the law of contact, the largest " &
         & //place_of(rough)
      if (reduced%value > 0.0_wp) remark = joined(remark, "restitution was reduced by up to " &
         & //short_text(100.0_wp*reduced%value)//" % so that impacts add no energy, the most " &
         & //place_of(reduced))
   end function contact_remark

   !> Blocks and time of a contact note
   pure function place_of(note) result(place)
      type(contact_note_t), intent(in) :: note
      character(len=:), allocatable :: place

      place = "at a bar"
      if (all(note%block > 0)) place = "between blocks "//to_text(note%block(1))//" and " &
         & //to_text(note%block(2))
      place = place//" at "//short_text(note%time)//" s"
   end function place_of

   !> Remark on jumps on the loading path
   pure function jump_remark(jumps, largest) result(remark)
      integer, intent(in) :: jumps     !! Number of jumps
      real(wp), intent(in) :: largest  !! The largest displacement of one [m]
      character(len=:), allocatable :: remark

      remark = ""
      if (jumps > 0) remark = "jumps on the loading path: "//to_text(jumps) &
         & //", the largest "//short_text(largest)//" m"
   end function jump_remark
end module dda_case_remarks
