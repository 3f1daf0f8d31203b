!> The values of a deck: the defaults of the registry, and each value under its name
module dda_deck_values
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use dda_block_input, only : new_plan
   use dda_deck, only : deck_t
   use dda_deck_key, only : key_kind
   use dda_deck_keys, only : deck_group, deck_key
   use dda_input, only : deck_place_t, input_value_t
   use dda_key_values, only : default_value
   use dda_kinds, only : wp
   implicit none
   private

   public :: name_values, new_deck

contains

   !> A deck of defaults
   pure subroutine new_deck(deck, file)
      type(deck_t), intent(out) :: deck
      !> Name that errors will show
      character(len=*), intent(in) :: file
      integer :: i

      deck%file = file
      call new_plan(deck%plan)
      allocate (deck%value(0:size(deck_key)), deck%group(size(deck_group)), deck%sweeps(0))
      deck%value(0)%number = ieee_value(1.0_wp, ieee_quiet_nan)
      do i = 1, size(deck_key)
         deck%value(i) = default_value(deck_key(i))
      end do
      call name_values(deck)
   end subroutine new_deck

   !> Let the values that have names be those of the registry, key by key in its order
   pure subroutine name_values(deck)
      type(deck_t), intent(inout) :: deck
      integer :: k

      k = 0
      associate (g => deck%scene)
         g%given = deck%group(1)%line > 0
         call take(deck%value, deck%group(1), k, g%title, g%kind, g%geometry, g%analysis)
      end associate
      associate (g => deck%arch)
         g%given = deck%group(2)%line > 0
         call take(deck%value, deck%group(2), k, g%radius, g%thickness_ratio, g%half_angle_deg, &
            & g%voussoirs, g%joints_deg, g%facet_deg, g%springing, g%abutment_size, &
            & g%abutment_overhang, g%shape)
         call take(deck%value, deck%group(2), k, g%span, g%rise, g%right_rise, g%thickness, &
            & g%crown_thickness, g%springing_thickness, g%joint_direction, g%rings, g%spans, &
            & g%pier_width)
         call take(deck%value, deck%group(2), k, g%pier_height, g%pier_courses, g%buttress_width, &
            & g%buttress_height, g%lune_deg)
      end associate
      associate (g => deck%material)
         g%given = deck%group(3)%line > 0
         call take(deck%value, deck%group(3), k, g%density, g%unit_weight, g%young, g%poisson, &
            & g%compressive_strength, g%plane)
      end associate
      associate (g => deck%joint)
         g%given = deck%group(4)%line > 0
         call take(deck%value, deck%group(4), k, g%friction_deg, g%cohesion, g%tension, &
            & g%residual_deg, g%slip_length)
      end associate
      associate (g => deck%load)
         g%given = deck%group(5)%line > 0
         call take(deck%value, deck%group(5), k, g%gravity, g%gravity_direction_deg, &
            & g%horizontal_coefficient, g%load_factor, g%live_horizontal, g%displacement_factor, &
            & g%water_rise)
      end associate
      associate (g => deck%live)
         g%given = deck%group(6)%line > 0
         call take(deck%value, deck%group(6), k, g%x, g%y, g%fx, g%fy)
      end associate
      associate (g => deck%vehicle)
         g%given = deck%group(7)%line > 0
         call take(deck%value, deck%group(7), k, g%axles, g%spacings, g%length, g%position, &
            & g%worst)
      end associate
      associate (g => deck%fill)
         g%given = deck%group(8)%line > 0
         call take(deck%value, deck%group(8), k, g%height, g%unit_weight, g%friction_deg, &
            & g%spread, g%passive_coefficient, g%passive_share, g%backing_height, &
            & g%backing_unit_weight)
      end associate
      associate (g => deck%tie)
         g%given = deck%group(9)%line > 0
         call take(deck%value, deck%group(9), k, g%x1, g%y1, g%x2, g%y2, g%ea, g%strength, &
            & g%prestress)
      end associate
      call name_run(deck, k)
   end subroutine name_values

   !> Name the values of the groups from &ground on
   pure subroutine name_run(deck, k)
      type(deck_t), intent(inout) :: deck
      !> Place of the key before them in the registry
      integer, intent(inout) :: k

      associate (g => deck%ground)
         g%given = deck%group(10)%line > 0
         call take(deck%value, deck%group(10), k, g%scale, g%pulse, g%record, g%amplitude, &
            & g%duration, g%frequency, g%direction_deg, g%columns, g%quantity, g%unit)
      end associate
      associate (g => deck%analysis)
         g%given = deck%group(11)%line > 0
         call take(deck%value, deck%group(11), k, g%mode, g%geometry, g%flow, g%steps, &
            & g%max_displacement_ratio, g%time_step, g%duration, g%restitution, g%damping, &
            & g%penalty_ratio)
         call take(deck%value, deck%group(11), k, g%collapse_displacement, &
            & g%collapse_rotation_deg, g%collapse_point, g%open_close_limit, g%restart, g%start, &
            & g%unknowns)
      end associate
      associate (g => deck%limerick)
         g%given = deck%group(12)%line > 0
         call take(deck%value, deck%group(12), k, g%dynamic, g%auto_penalty, g%penetration_ratio, &
            & g%close_ratio, g%open_ratio, g%overlap_deg, g%stiffness_ratio, g%rotation, &
            & g%contact_damping, g%gravity_steps)
      end associate
      associate (g => deck%search)
         g%given = deck%group(13)%line > 0
         call take(deck%value, deck%group(13), k, g%parameter, g%low, g%high, g%tolerance)
      end associate
      associate (g => deck%sweep)
         g%given = deck%group(14)%line > 0
         call take(deck%value, deck%group(14), k, g%parameter, g%values, g%texts, g%first, &
            & g%last, g%count, g%linked)
      end associate
      associate (g => deck%output)
         g%given = deck%group(15)%line > 0
         call take(deck%value, deck%group(15), k, g%vtu, g%joints, g%blocks, g%proof, &
            & g%thrust_bar, g%reactions, g%thrust_joint, g%condition, g%frames, g%energy)
         call take(deck%value, deck%group(15), k, g%restart, g%max_cases)
      end associate
   end subroutine name_run

   !> Take the next values of the registry
   pure recursive subroutine take(value, group, k, a, b, c, d, e, f, g, h, i, j)
      !> All values: (0:n)
      type(input_value_t), intent(in) :: value(0:)
      !> Where their group is
      type(deck_place_t), intent(in) :: group
      !> Place of the key before in, of the last one out
      integer, intent(inout) :: k
      type(input_value_t), intent(inout) :: a
      type(input_value_t), intent(inout), optional :: b, c, d, e, f, g, h, i, j

      k = k + 1
      a = value(k)
      if (deck_key(k)%kind == key_kind%whole) a%whole = nint(a%number)
      if (deck_key(k)%kind == key_kind%word) a%word = a%text
      if (a%place%line == 0) a%place = group
      if (present(b)) call take(value, group, k, b, c, d, e, f, g, h, i, j)
   end subroutine take
end module dda_deck_values
