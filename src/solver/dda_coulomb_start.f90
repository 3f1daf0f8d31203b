!> State of an assembly under a sudden load
!>
!> Coulomb's law has no unit of force: a load that grows in proportion from nothing makes every
!> force and every motion grow in proportion, so that the whole load at once is a loading path, too.
!> Interior springs with strong damping find which joints stick and slide; an open-close loop with
!> less and less damping decides.
submodule (dda_loading_path) dda_coulomb_start
   use dda_coulomb_equations, only : path_damping, solve_equations, use_faces
   use dda_coulomb_interior, only : coulomb_iterate_t
   use dda_coulomb_law, only : apply_law, force_faces, imbalance, unloaded_state
   use dda_damped_motion, only : enough, interior_motion, sharp
   use dda_joint_graph, only : joint_motion
   use dda_kinds, only : small
   use dda_load_jump, only : jump_to_balance
   implicit none

   !> Residual of equilibrium over the weight of a block
   real(wp), parameter :: balance = 1.0e-10_wp
   !> Largest share of the load that damping may take at rest
   real(wp), parameter :: unseen = 1.0e-5_wp

contains

   !> State under a load that is applied at once
   module procedure load_at_once
      real(wp), parameter :: damping(3) = [1.0e-5_wp, 1.0e-4_wp, 1.0e-3_wp]
      real(wp) :: largest
      integer :: i
      logical :: stands

      state = unloaded_state(joints)
      end = motion_end%balanced
      if (.not. maxval(abs(load)) > 0.0_wp) return
      do i = 1, size(damping)
         call try_interior(joints, equations, load, damping(i), state, stands)
         if (stands) return
      end do
      state = unloaded_state(joints)
      jump%tolerance = balance
      call find_elastic_motion(joints, equations, load, state, path_damping, largest)
      jump%far = far_factor*max(1.0_wp, largest)
      state%load = load
      call jump_to_balance(joints, equations, (state%motion), state, jump, end)
   end procedure load_at_once

   !> See how soft an assembly is; what moves freely is not soft
   module procedure see_softness
      real(wp) :: damping, largest

      damping = path_damping
      do
         call find_elastic_motion(joints, equations, load, state, damping, largest)
         if (damping*largest <= unseen .or. damping <= least_damping) exit
         damping = 0.1_wp*damping
      end do
      equations%rest_damping = merge(damping, path_damping, damping*largest <= moves_unbalanced)
   end procedure see_softness

   !> Largest displacement where no joint opens or slides
   pure subroutine find_elastic_motion(joints, equations, load, state, damping, largest)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      real(wp), intent(in) :: load(:, :)
      type(coulomb_state_t), intent(in) :: state
      real(wp), intent(in) :: damping   !! Multiple of the mass
      real(wp), intent(out) :: largest  !! The displacement, vast where nothing holds
      real(wp) :: motion(size(load, 1), size(load, 2)), opening(3, size(state%slip))

      largest = sqrt(huge(largest))
      call use_faces(equations, joints, state%face, damping)
      if (equations%usable) call solve_equations(equations, joints, load, motion, opening)
      if (equations%usable) largest = maxval(abs(motion))
   end subroutine find_elastic_motion

   !> Interior springs at a damping, then the open-close loop at ever less of it
   pure subroutine try_interior(joints, equations, load, first, state, stands)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      real(wp), intent(in) :: load(:, :)
      real(wp), intent(in) :: first   !! Damping to begin with
      type(coulomb_state_t), intent(out) :: state
      logical, intent(out) :: stands  !! True if its forces balance the load
      integer, parameter :: most_passes = 12
      real(wp), parameter :: least = 1.0e-13_wp
      type(coulomb_iterate_t) :: inner
      real(wp) :: damping, left, last
      integer :: passes, rounds
      logical :: settled

      call take_interior(joints, equations, load, first, enough, inner, state, settled)
      stands = .false.
      if (.not. settled) return
      damping = first
      last = huge(1.0_wp)
      rounds = 0
      do while (damping >= 0.5_wp*least)
         call settle_faces(joints, equations, load, damping, most_passes, state, left, passes)
         if (passes == 0) then
            if (damping < first) inner = coulomb_iterate_t()
            call take_interior(joints, equations, load, damping, sharp, inner, state, settled)
            if (settled) call settle_faces(joints, equations, load, damping, most_passes, state, &
               & left, passes)
         end if
         if (passes == 0) return
         rounds = rounds + 1
         stands = left < balance
         if (stands) exit
         if (left > 0.85_wp*last .and. rounds >= 3) return
         last = left
         damping = 0.1_wp*damping
      end do
      state%load = load
   end subroutine try_interior

   !> One damped step to a load from nothing: faces are chosen until they agree with the motion
   pure subroutine settle_faces(joints, equations, load, damping, most, after, left, passes)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      real(wp), intent(in) :: load(:, :)
      !> Multiple of the mass
      real(wp), intent(in) :: damping
      !> Passes at most
      integer, intent(in) :: most
      !> In: the faces to begin with; out: the state after the step
      type(coulomb_state_t), intent(inout) :: after
      !> Residual of the load
      real(wp), intent(out) :: left
      !> Number of passes, 0 if the faces did not settle
      integer, intent(out) :: passes
      real(wp), parameter :: rounding = 1.0e-13_wp
      type(coulomb_state_t) :: before
      real(wp) :: change(3, size(after%slip)), rest(size(load, 1), size(load, 2))
      real(wp) :: step(size(load, 1), size(load, 2))
      integer(small) :: faces(3, size(after%slip))
      integer :: pass

      passes = 0
      left = huge(1.0_wp)
      before = unloaded_state(joints)
      ! the law does not ask for them
      deallocate (before%motion, before%load)
      faces = after%face
      do pass = 1, most
         call use_faces(equations, joints, faces, damping)
         if (.not. equations%usable) return
         call force_faces(joints, before, faces, change)
         call imbalance(joints, load, change, rest)
         call solve_equations(equations, joints, rest, step, change)
         if (.not. (equations%usable .and. all(abs(step) <= huge(1.0_wp)))) return
         call apply_law(joints, before, change, after)
         after%motion = step
         call imbalance(joints, load, after%force, rest)
         left = maxval(abs(rest))
         if (all(after%face == faces) .or. maxval(abs(rest - damping*joints%graph%mass*step)) &
            & < rounding*real(size(step, 2), wp)) then
            passes = pass
            return
         end if
         faces = after%face
      end do
   end subroutine settle_faces

   !> Faces by interior springs
   pure subroutine take_interior(joints, equations, load, damping, tolerance, inner, state, settled)
      type(coulomb_joints_t), intent(in) :: joints
      type(coulomb_equations_t), intent(inout) :: equations
      real(wp), intent(in) :: load(:, :), damping
      real(wp), intent(in) :: tolerance                 !! Tolerance of the interior springs
      type(coulomb_iterate_t), intent(inout) :: inner  !! The iterate, from which it goes on
      type(coulomb_state_t), intent(out) :: state
      logical, intent(out) :: settled  !! True if the interior springs have converged
      type(coulomb_state_t) :: unloaded
      real(wp), allocatable :: opening(:, :)

      equations%usable = .false.
      call interior_motion(joints, equations%base, load, damping, tolerance, inner, settled)
      unloaded = unloaded_state(joints)
      state = unloaded
      state%motion = inner%motion
      allocate (opening, mold=state%force)
      call joint_motion(joints%graph, state%motion, opening)
      call apply_law(joints, unloaded, opening, state)
   end subroutine take_interior

end submodule dda_coulomb_start
