!> Where the collapse of a chain stops, before anything is decided
!>
!> What the forces of a chain lack, over the parameter, is zero where it ceases to fall; the joints
!> that break their bounds near there are its last mechanism. No proof rests on what is foreseen:
!> two decisions beside it tell whether it is so.
submodule (dda_bracket) dda_chain_foresight
   use dda_chain, only : chain_t
   use dda_chain_balance, only : carry_forces, rounding_of_forces, sum_loads
   use dda_chain_decision, only : doubtful
   use dda_chain_lack, only : faces_of, find_lack, lack_t
   use dda_settings, only : flow_rule
   implicit none

   !> Most values that are looked at
   integer, parameter :: max_values = 12
   !> Share of the value by which the second one lies beyond the first
   real(wp), parameter :: first_step = 0.05_wp
   !> How near a value must lie to where its mechanism would stop, over that
   real(wp), parameter :: near = 0.01_wp
   !> Largest ratio of two values in a row
   real(wp), parameter :: largest_ratio = 3.0_wp
   !> Least acceleration that what falls is taken to have, over that of free fall
   real(wp), parameter :: least_acceleration = 1.0e-3_wp

contains

   !> Foresee where the collapse of a chain stops
   module procedure foresee
      type(lack_t) :: lack
      real(wp) :: before, last, next, value
      integer :: i

      value = search%start
      next = value*(1.0_wp + first_step)
      do i = 1, max_values
         call link_once(family, value, critical%link)
         if (critical%link%known) call find_lack(critical%link%chain, lack)
         if (.not. (critical%link%known .and. lack%known)) return
         if (i > 1) then
            if (.not. abs(lack%least - last) > 0.0_wp) return
            next = value - lack%least*(value - before)/(lack%least - last)
            if (abs(next - value) <= near*value .and. lack%exchanges == 0) exit
            next = min(max(next, value/largest_ratio), value*largest_ratio)
         end if
         before = value
         last = lack%least
         value = next
      end do
      if (i > max_values) return
      critical%falls = value
      ! the trace begins with a step to where the mechanism seems to stop
      call bind_faces(critical%link%chain, lack, 0.8_wp*abs(next/value - 1.0_wp), critical%fallen)
      ! where joints slide many mechanisms stop within some tolerances of one another
      if (.not. any(critical%fallen%contacts%face%slip /= 0)) then
         call trace(family, search, merge(search%high, search%low, next > value), critical, &
            & proposal)
         call move_alloc(critical%fallen%contacts%face, face)
      end if
      deallocate (critical%fallen)
   end procedure foresee

   !> What would be a collapse if it were proven
   pure subroutine bind_faces(chain, lack, acceleration, fallen)
      type(chain_t), intent(in) :: chain
      type(lack_t), intent(in) :: lack
      !> How fast it is taken to fall, over free fall; that tells how far the trace steps, and but
      !> for its share that rounding hides no more
      real(wp), intent(in) :: acceleration
      type(decision_t), allocatable, intent(out) :: fallen
      real(wp) :: force(3, size(chain%joint)), load(3, size(chain%joint))

      call sum_loads(chain, load)
      call carry_forces(chain, load, lack%reaction, force)
      allocate (fallen)
      fallen%flow = flow_rule%associated
      fallen%halved = chain%halved
      fallen%keystone = chain%keystone
      allocate (fallen%contacts%face(size(chain%joint)))
      fallen%contacts%face(:) = faces_of(chain, lack)
      fallen%outcome%acceleration_ratio = max(acceleration, least_acceleration)
      fallen%outcome%rest_tolerance = fallen%outcome%acceleration_ratio*doubtful &
         & *rounding_of_forces(chain, force)/max(abs(lack%least), tiny(1.0_wp))
   end subroutine bind_faces

end submodule dda_chain_foresight
