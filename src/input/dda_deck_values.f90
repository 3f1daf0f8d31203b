!> The values of a deck: the defaults of the registry, and each value under its name
module dda_deck_values
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use dda_block_input, only : new_plan
   use dda_deck, only : deck_t, deck_value_t
   use dda_deck_key, only : key_kind
   use dda_deck_keys, only : deck_group, deck_key
   use dda_input, only : input_list_t, input_text_t, input_value_t
   use dda_kinds, only : wp
   use dda_text, only : read_number
   implicit none
   private

   public :: name_values, new_deck

   !> Where a walk along the registry is
   type :: walk_t
      integer :: at = 0    !! Place of the last key that was passed
      integer :: only = 0  !! The only key whose value is taken; 0 for all
   end type walk_t

   interface take
      procedure :: take_values, take_texts, take_lists
   end interface take

contains

   !> A deck of defaults
   pure subroutine new_deck(deck, file)
      type(deck_t), intent(out) :: deck
      character(len=*), intent(in) :: file  !! Name that errors will show
      integer :: i

      deck%file = file
      call new_plan(deck%plan)
      allocate (deck%value(0:size(deck_key)), deck%group(size(deck_group)), deck%sweeps(0))
      deck%value(0)%number = ieee_value(1.0_wp, ieee_quiet_nan)
      do i = 0, size(deck_key)
         call put_default(deck%value(i), i)
      end do
      call name_values(deck)
   end subroutine new_deck

   !> Let the values that have names be those of the registry, key by key in its order
   pure subroutine name_values(deck, only)
      type(deck_t), intent(inout) :: deck
      !> The only key that has changed; any may have if it is not there
      integer, intent(in), optional :: only
      type(walk_t) :: k

      if (present(only)) k%only = only
      associate (g => deck%scene)
         g%given = deck%group(1)%line > 0
         call take(deck%value, k, g%title)
         call take(deck%value, k, g%kind)
         call take(deck%value, k, g%geometry, g%analysis)
      end associate
      associate (g => deck%arch)
         g%given = deck%group(2)%line > 0
         call take(deck%value, k, g%radius, g%thickness_ratio, g%half_angle_deg, g%voussoirs)
         call take(deck%value, k, g%joints_deg)
         call take(deck%value, k, g%facet_deg, g%springing, g%abutment_size, g%abutment_overhang, &
            & g%shape, g%span, g%rise)
         call take(deck%value, k, g%right_rise, g%thickness, g%crown_thickness, &
            & g%springing_thickness, g%joint_direction, g%rings, g%spans)
         call take(deck%value, k, g%pier_width, g%pier_height, g%pier_courses, g%buttress_width, &
            & g%buttress_height, g%lune_deg)
      end associate
      associate (g => deck%material)
         g%given = deck%group(3)%line > 0
         call take(deck%value, k, g%density, g%unit_weight, g%young, g%poisson, &
            & g%compressive_strength, g%plane)
      end associate
      associate (g => deck%joint)
         g%given = deck%group(4)%line > 0
         call take(deck%value, k, g%friction_deg, g%cohesion, g%tension, g%residual_deg, &
            & g%slip_length)
      end associate
      associate (g => deck%load)
         g%given = deck%group(5)%line > 0
         call take(deck%value, k, g%gravity, g%gravity_direction_deg, g%horizontal_coefficient, &
            & g%load_factor, g%live_horizontal, g%displacement_factor, g%water_rise)
      end associate
      associate (g => deck%live)
         g%given = deck%group(6)%line > 0
         call take(deck%value, k, g%x, g%y, g%fx, g%fy)
      end associate
      associate (g => deck%vehicle)
         g%given = deck%group(7)%line > 0
         call take(deck%value, k, g%axles, g%spacings)
         call take(deck%value, k, g%length, g%position, g%worst)
      end associate
      associate (g => deck%fill)
         g%given = deck%group(8)%line > 0
         call take(deck%value, k, g%height, g%unit_weight, g%friction_deg, g%spread, &
            & g%passive_coefficient, g%passive_share, g%passive_stiffness)
         call take(deck%value, k, g%backing_height, g%backing_unit_weight)
      end associate
      associate (g => deck%tie)
         g%given = deck%group(9)%line > 0
         call take(deck%value, k, g%x1, g%y1, g%x2, g%y2, g%ea, g%strength, g%prestress)
      end associate
      call name_run(deck, k)
   end subroutine name_values

   !> The groups from &ground on
   pure subroutine name_run(deck, k)
      type(deck_t), intent(inout) :: deck
      type(walk_t), intent(inout) :: k  !! The walk, at the last key before them

      associate (g => deck%ground)
         g%given = deck%group(10)%line > 0
         call take(deck%value, k, g%scale, g%pulse)
         call take(deck%value, k, g%record)
         call take(deck%value, k, g%amplitude, g%duration, g%frequency, g%direction_deg)
         call take(deck%value, k, g%columns)
         call take(deck%value, k, g%quantity, g%unit)
      end associate
      associate (g => deck%analysis)
         g%given = deck%group(11)%line > 0
         call take(deck%value, k, g%mode, g%geometry, g%flow, g%steps, g%max_displacement_ratio, &
            & g%time_step, g%duration)
         call take(deck%value, k, g%restitution, g%damping, g%penalty_ratio, &
            & g%collapse_displacement, g%collapse_rotation_deg, g%collapse_point, &
            & g%open_close_limit)
         call take(deck%value, k, g%restart)
         call take(deck%value, k, g%start, g%unknowns)
      end associate
      associate (g => deck%limerick)
         g%given = deck%group(12)%line > 0
         call take(deck%value, k, g%dynamic, g%auto_penalty, g%penetration_ratio, g%close_ratio, &
            & g%open_ratio, g%overlap_deg, g%stiffness_ratio)
         call take(deck%value, k, g%rotation, g%contact_damping, g%gravity_steps)
      end associate
      associate (g => deck%search)
         g%given = deck%group(13)%line > 0
         call take(deck%value, k, g%parameter)
         call take(deck%value, k, g%low, g%high, g%tolerance)
      end associate
      associate (g => deck%sweep)
         g%given = deck%group(14)%line > 0
         call take(deck%value, k, g%parameter)
         call take(deck%value, k, g%values, g%texts)
         call take(deck%value, k, g%first, g%last, g%count, g%linked)
      end associate
      associate (g => deck%output)
         g%given = deck%group(15)%line > 0
         call take(deck%value, k, g%vtu, g%joints, g%blocks, g%proof, g%thrust_bar, g%reactions, &
            & g%thrust_joint)
         call take(deck%value, k, g%condition, g%frames, g%energy, g%restart, g%max_cases)
      end associate
   end subroutine name_run

   !> Take the next values of the registry
   pure recursive subroutine take_values(value, k, a, b, c, d, e, f, g)
      type(deck_value_t), intent(in) :: value(0:)  !! All values: (0:n)
      type(walk_t), intent(inout) :: k
      type(input_value_t), intent(inout) :: a
      type(input_value_t), intent(inout), optional :: b, c, d, e, f, g

      if (is_over(k)) return
      k%at = k%at + 1
      if (is_taken(k)) call take_value(value(k%at), deck_key(k%at)%kind, a)
      if (present(b)) call take_values(value, k, b, c, d, e, f, g)
   end subroutine take_values

   !> Take one value
   pure subroutine take_value(value, kind, named)
      type(deck_value_t), intent(in) :: value
      integer, intent(in) :: kind  !! One of key_kind
      type(input_value_t), intent(inout) :: named

      named%given = value%given
      named%number = value%number
      named%flag = value%flag
      if (kind == key_kind%whole) named%whole = nint(named%number)
      if (kind == key_kind%word) named%word = value%text
   end subroutine take_value

   !> Whether nothing is left to be taken on a walk
   pure logical function is_over(k)
      type(walk_t), intent(in) :: k

      is_over = k%only > 0 .and. k%at >= k%only
   end function is_over

   !> Whether the value that a walk has come to is taken
   pure logical function is_taken(k)
      type(walk_t), intent(in) :: k

      is_taken = k%only == 0 .or. k%only == k%at
   end function is_taken

   !> Take the next texts
   pure recursive subroutine take_texts(value, k, a, b)
      type(deck_value_t), intent(in) :: value(0:)
      type(walk_t), intent(inout) :: k
      type(input_text_t), intent(inout) :: a
      type(input_text_t), intent(inout), optional :: b

      if (is_over(k)) return
      k%at = k%at + 1
      if (is_taken(k)) then
         a%given = value(k%at)%given
         a%text = value(k%at)%text
      end if
      if (present(b)) call take_texts(value, k, b)
   end subroutine take_texts

   !> Take the next lists; of words only whether they are given
   pure recursive subroutine take_lists(value, k, a, b, c, d, e, f, g)
      type(deck_value_t), intent(in) :: value(0:)
      type(walk_t), intent(inout) :: k
      type(input_list_t), intent(inout) :: a
      type(input_list_t), intent(inout), optional :: b, c, d, e, f, g

      if (is_over(k)) return
      k%at = k%at + 1
      if (is_taken(k)) then
         a%given = value(k%at)%given
         if (allocated(value(k%at)%numbers)) a%numbers = value(k%at)%numbers
      end if
      if (present(b)) call take_lists(value, k, b, c, d, e, f, g)
   end subroutine take_lists

   !> Give a value its default
   pure subroutine put_default(value, i)
      type(deck_value_t), intent(inout) :: value
      integer, intent(in) :: i  !! Place of its key in the registry
      character(len=:), allocatable :: default
      logical :: ok

      if (i == 0) return
      default = trim(deck_key(i)%default)
      select case (deck_key(i)%kind)
      case (key_kind%number, key_kind%whole)
         call read_number(default, value%number, ok)
      case (key_kind%word, key_kind%text)
         value%text = ""
         if (len(default) > 2) value%text = default(2:len(default) - 1)
      case (key_kind%flag)
         value%flag = default == ".true."
      case (key_kind%numbers)
         allocate (value%numbers(0))
      case (key_kind%texts)
         allocate (value%texts(0))
      end select
   end subroutine put_default
end module dda_deck_values
