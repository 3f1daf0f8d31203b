!> Frames of a run: corners, stresses, joint forces and states at selected steps
module dda_frames
   use dda_bar, only : bar_state_t
   use dda_block_system, only : block_system_t
   use dda_boundary, only : measured_point_t
   use dda_contact_types, only : joint_t
   use dda_contacts, only : contacts_t
   use dda_deformation, only : displacement_matrix, moved_point
   use dda_friction_cone, only : joint_face_t
   use dda_energy, only : audit_t
   use dda_growth, only : make_room
   use dda_kinds, only : wp
   use dda_step_context, only : run_t
   implicit none
   private

   public :: frame_t, album_t, blank_album, frame_is_due, keep_frame, keep_pictures

   !> One picture
   type :: frame_t
      integer :: step = 0  !! Accepted steps before it
      !> Sum of the lengths of these steps, or time on the path of a static run [s]
      real(wp) :: time = 0.0_wp
      real(wp) :: displacement = 0.0_wp     !! Farthest that a corner has moved [m]
      real(wp), allocatable :: moved(:, :)  !! Corners of all blocks: (2, n_vertex) [m]
      !> Motion of all blocks: (6, n_block) [m, m, rad, -, -, -]
      real(wp), allocatable :: motion(:, :)
      real(wp), allocatable :: stress(:, :)  !! Stress sx, sy, txy of all blocks: (3, n_block) [Pa]
      !> The joints, which come and go where they are searched: (n_joint)
      type(joint_t), allocatable :: joint(:)
      real(wp), allocatable :: force(:, :)  !! Force N1, N2, T of all joints: (3, n_joint) [N/m]
      real(wp), allocatable :: slip(:)      !! Slip of all joints in the last step: (n_joint) [m]
      real(wp) :: farthest = 0.0_wp         !! Largest motion of a point in the last step [m]
      !> Faces that the forces lie on: (n_joint)
      type(joint_face_t), allocatable :: face(:)
      !> Blocks that are not there; unallocated where all are: (n_block)
      logical, allocatable :: absent(:)
      type(bar_state_t), allocatable :: bar(:)  !! The bars: (n_bar)
   end type frame_t

   !> The pictures of a run
   type :: album_t
      real(wp) :: spacing = 0.0_wp  !! Displacement from one picture to the next; 0 to keep none [m]
      !> Displacement to which a collapse goes on after its verdict, for the pictures of it; 0 to
      !> end there [m]
      real(wp) :: follow = 0.0_wp
      integer :: every = 0  !! Steps from one picture to the next, in time; 0 to go by displacement
      !> Time from one picture to the next; 0 to go by steps or displacement [s]
      real(wp) :: interval = 0.0_wp
      real(wp) :: begin = 0.0_wp  !! Time from which that is counted [s]
      real(wp) :: due = 0.0_wp    !! Displacement or time at which the next one is due [m or s]
      integer :: n = 0            !! Pictures kept
      !> The pictures, the first n of them
      type(frame_t), allocatable :: frame(:)
      type(audit_t) :: audit  !! Energies of a dynamic run
      !> Points whose way is kept in every step: (n_point)
      type(measured_point_t), allocatable :: point(:)
      integer :: n_track = 0  !! Steps of which it is kept, the beginning among them
      !> Step and time of each, the first n_track of them: (2, :) [-, s]
      real(wp), allocatable :: when(:, :)
      real(wp), allocatable :: track(:, :, :)  !! Where the points are: (2, n_point, :) [m]
      real(wp), allocatable :: speed(:, :, :)  !! Velocities in a dynamic run: (2, n_point, :) [m/s]
      !> Supports whose reactions are kept in every step, as block and restrained point; unallocated
      !> where none are: (2, n)
      integer, allocatable :: support(:, :)
      !> Reactions of the last step: (3, n) [N/m, N/m, N]
      real(wp), allocatable :: reaction_now(:, :)
      real(wp), allocatable :: reaction(:, :, :)  !! Those of all steps: (3, n, :)
   end type album_t

   !> Relative tolerance of the time of a frame
   real(wp), parameter :: almost = 1.0_wp - 1.0e-9_wp

contains

   !> The same settings without frames, for another run
   pure type(album_t) function blank_album(album) result(blank)
      type(album_t), intent(in) :: album

      blank%spacing = album%spacing
      blank%follow = album%follow
      blank%every = album%every
      blank%interval = album%interval
      blank%begin = album%begin
      blank%audit%wanted = album%audit%wanted
      if (allocated(album%point)) blank%point = album%point
      if (allocated(album%support)) blank%support = album%support
   end function blank_album

   !> Keep a picture if one is due, and the places of the monitoring points
   pure subroutine keep_pictures(run, last, album)
      type(run_t), intent(in) :: run
      !> True if the run has ended here, with a step that has been offered
      logical, intent(in) :: last
      type(album_t), intent(inout) :: album

      associate (march => run%march)
         call keep_frame(run%system, run%contacts, march%steps, march%time, march%displacement, &
            & run%step%farthest, last, album)
      end associate
      if (.not. last) call keep_track(run, album)
   end subroutine keep_pictures

   !> True if a picture is due
   pure logical function frame_is_due(step, time, displacement, last, album) result(is_due)
      integer, intent(in) :: step   !! Accepted steps so far
      real(wp), intent(in) :: time  !! Sum of their lengths [s]
      !> Farthest that a corner has moved [m]
      real(wp), intent(in) :: displacement
      logical, intent(in) :: last  !! True if the run ends here, so that a picture is due anyway
      type(album_t), intent(in) :: album

      is_due = .false.
      if (.not. (max(album%spacing, album%interval) > 0.0_wp .or. album%every > 0)) return
      is_due = progress(time, displacement, album) >= album%due*almost
      if (album%every > 0) is_due = modulo(step, album%every) == 0
      ! on the path of a static run blocks fall while its clock stands still
      if (album%interval > 0.0_wp .and. album%spacing > 0.0_wp .and. album%n > 0) is_due = is_due &
         & .or. displacement >= album%frame(album%n)%displacement + album%spacing
      if (last .and. album%n > 0) is_due = album%frame(album%n)%step < step
      is_due = is_due .or. last .and. album%n == 0
   end function frame_is_due

   !> Measure by which pictures are counted: time where they have an interval, else displacement [s
   !> or m]
   pure real(wp) function progress(time, displacement, album)
      real(wp), intent(in) :: time  !! Sum of the lengths of the steps [s]
      real(wp), intent(in) :: displacement
      type(album_t), intent(in) :: album

      progress = displacement
      if (album%interval > 0.0_wp) progress = time - album%begin
   end function progress

   !> Keep a picture if one is due
   pure subroutine keep_frame(system, contacts, step, time, displacement, farthest, last, album)
      type(block_system_t), intent(in) :: system
      type(contacts_t), intent(in) :: contacts
      integer, intent(in) :: step
      real(wp), intent(in) :: time, displacement
      real(wp), intent(in) :: farthest  !! Largest motion of a point in the last step [m]
      logical, intent(in) :: last
      type(album_t), intent(inout) :: album
      type(frame_t), allocatable :: longer(:)
      real(wp) :: spacing

      if (.not. frame_is_due(step, time, displacement, last, album)) return
      spacing = merge(album%interval, album%spacing, album%interval > 0.0_wp)
      if (.not. allocated(album%frame)) allocate (album%frame(8))
      if (album%n == size(album%frame)) then
         allocate (longer(2*album%n))
         longer(:album%n) = album%frame
         call move_alloc(longer, album%frame)
      end if
      album%n = album%n + 1
      if (spacing > 0.0_wp) album%due = (aint(progress(time, displacement, album) &
         & /(spacing*almost)) + 1.0_wp)*spacing
      associate (frame => album%frame(album%n))
         frame%step = step
         frame%time = time
         frame%displacement = displacement
         frame%moved = system%moved
         frame%motion = system%motion
         frame%stress = system%stress
         if (allocated(system%absent)) frame%absent = system%absent
         if (allocated(system%bar)) frame%bar = system%bar
         frame%joint = contacts%joint
         frame%force = contacts%force
         frame%slip = contacts%increment(3, :)
         frame%farthest = farthest
         frame%face = contacts%face
      end associate
   end subroutine keep_frame

   !> Keep the places of the monitoring points
   pure subroutine keep_track(run, album)
      type(run_t), intent(in) :: run
      type(album_t), intent(inout) :: album
      real(wp) :: t(2, 6)
      integer :: i, n

      if (.not. allocated(album%point)) return
      n = album%n_track
      if (.not. allocated(album%track)) then
         allocate (album%track(2, size(album%point), 0), album%speed(2, size(album%point), 0))
         if (allocated(album%support)) allocate (album%reaction(3, size(album%support, 2), 0))
      end if
      call make_room(album%when, n + 1)
      call make_room(album%track, n + 1)
      call make_room(album%speed, n + 1)
      if (allocated(album%reaction)) call make_room(album%reaction, n + 1)
      album%n_track = n + 1
      if (allocated(album%reaction_now)) album%reaction(:, :, n + 1) = album%reaction_now
      album%when(:, n + 1) = [real(run%march%steps, wp), run%march%time]
      do i = 1, size(album%point)
         associate (point => album%point(i)%point, b => album%point(i)%block, &
            & place => album%track(:, i, n + 1), system => run%system)
            t = displacement_matrix(point, system%centroid(:, b))
            place = point + matmul(t, system%motion(:, b))
            if (run%settings%current) then
               place = moved_point(point, system%centroid(:, b), system%motion(:, b))
               t = displacement_matrix(place, system%centroid(:, b) + system%motion(1:2, b))
            end if
            album%speed(:, i, n + 1) = matmul(t, system%velocity(:, b))
         end associate
      end do
   end subroutine keep_track
end module dda_frames
