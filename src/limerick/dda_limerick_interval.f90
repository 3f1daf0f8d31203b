!> Length of the steps and stiffness of the contacts, both chosen by the last motion
submodule (dda_limerick_step) dda_limerick_interval
   use dda_limerick_model, only : force_at, next_record
   implicit none

   !> What is left of the time step when contacts did not settle
   real(wp), parameter :: cut = 0.3_wp

   !> Growth of the time step from one step to the next, at most
   real(wp), parameter :: growth = 1.3_wp

   !> A motion beyond this multiple of what is allowed is tried again
   real(wp), parameter :: too_far = 3.0_wp

   !> A penetration beyond this multiple of its aim is tried again with a penalty ten times as large
   real(wp), parameter :: too_deep = 2.5_wp

   !> A record of a load that is nearer than this share of the step has been reached
   real(wp), parameter :: short = 1.0e-6_wp

   !> Least penalty over that of the step before
   real(wp), parameter :: relaxation = 1.0_wp/3.0_wp

contains

   !> Length of the next step from the largest acceleration (Shi
   module procedure choose_interval
      real(wp) :: acceleration, velocity, allowed, mass, longest, record

      if (.not. model%constants%auto_time_step) return
      allowed = model%constants%max_displacement_ratio*march%half_size
      mass = march%mean_area*model%material(1)%density
      velocity = 0.0_wp
      if (march%steps == 0) then
         longest = march%time_step
         acceleration = max(model%material(1)%unit_weight/model%material(1)%density, &
            & 4.0_wp*largest_stress(model)*sqrt(march%mean_area)/mass, &
            & largest_load(model, 0.0_wp, .true.)/mass)
         velocity = largest_velocity(model)
         if (acceleration > 0.0_wp .or. velocity > 0.0_wp) longest = huge(longest)
      else
         longest = growth*march%time_step
         acceleration = max(march%penetration*march%half_size*march%used_penalty, &
            & largest_load(model, march%time, .false.))/mass
         if (model%constants%dynamic) velocity = march%displacement_ratio*allowed/march%time_step
      end if
      ! the root of velocity*t + acceleration*t**2/2 = allowed in the form that loses no digits
      velocity = velocity + sqrt(velocity**2 + 2.0_wp*acceleration*allowed)
      march%time_step = longest
      if (velocity > 0.0_wp) march%time_step = min(longest, 2.0_wp*allowed/velocity)
      record = next_record(model, march%time + short*march%time_step)
      march%time_step = min(march%time_step, record - march%time)
   end procedure choose_interval

   !> Largest initial stress of a material [Pa]
   pure real(wp) function largest_stress(model)
      type(limerick_model_t), intent(in) :: model
      integer :: m

      largest_stress = 0.0_wp
      do m = 1, size(model%material)
         largest_stress = max(largest_stress, maxval(abs(model%material(m)%stress)))
      end do
   end function largest_stress

   !> Largest initial velocity of a material [m/s]
   pure real(wp) function largest_velocity(model)
      type(limerick_model_t), intent(in) :: model
      integer :: m

      largest_velocity = 0.0_wp
      do m = 1, size(model%material)
         largest_velocity = max(largest_velocity, maxval(abs(model%material(m)%velocity)))
      end do
   end function largest_velocity

   !> Largest component of the loads at a time or of all that are tabulated [N/m]
   pure real(wp) function largest_load(model, time, ever)
      type(limerick_model_t), intent(in) :: model
      !> The time [s]
      real(wp), intent(in) :: time
      !> Whether all tabulated forces count instead
      logical, intent(in) :: ever
      integer :: i

      largest_load = 0.0_wp
      do i = 1, size(model%boundary%loaded)
         if (ever) then
            largest_load = max(largest_load, maxval(abs(model%boundary%loaded(i)%force%value)))
         else
            largest_load = max(largest_load, maxval(abs(force_at(model, i, time))))
         end if
      end do
   end function largest_load

   !> Whether a step is accepted
   module procedure judge_limerick_step
      real(wp) :: shortest
      logical :: moved_too_far

      shortest = model%constants%time_step/100.0_wp
      moved_too_far = march%displacement_ratio > too_far
      accepted = settled .and. .not. moved_too_far
      if (.not. settled) then
         if (model%constants%auto_time_step) march%time_step = max(cut*march%time_step, shortest)
      else if (moved_too_far) then
         march%time_step = max(march%time_step/sqrt(march%displacement_ratio), shortest)
      else if (model%constants%auto_penalty) then
         call adapt_penalty(model, contacts, march)
         accepted = march%penetration <= too_deep*model%constants%penetration_ratio
         if (.not. accepted) march%penalty = 10.0_wp*march%penalty
      end if
   end procedure judge_limerick_step

   !> The penalty goes, down to a third at the most, to where the penetration is what is aimed at
   !> (Shi: spri)
   pure subroutine adapt_penalty(model, contacts, march)
      type(limerick_model_t), intent(in) :: model
      type(contact_list_t), intent(in) :: contacts
      type(limerick_march_t), intent(inout) :: march
      real(wp) :: opening
      integer :: c

      march%penetration = 0.0_wp
      opening = 0.0_wp
      do c = 1, contacts%n
         if (contacts%item(c)%state == limerick_state%open) cycle
         march%penetration = max(march%penetration, -contacts%item(c)%gap/march%half_size)
         opening = max(opening, contacts%item(c)%gap/march%half_size)
      end do
      associate (constants => model%constants)
         march%penalty = march%penalty*max(march%penetration/constants%penetration_ratio, &
            & opening/(2.0_wp*constants%max_displacement_ratio), relaxation)
      end associate
   end subroutine adapt_penalty

end submodule dda_limerick_interval
