!> What a step of a chain works on
module dda_chain_state
   use, intrinsic :: iso_fortran_env, only : int64
   use dda_chain, only : chain_t
   use dda_chain_factor, only : chain_factor_t, chain_matrix_t, new_chain_factor
   use dda_friction_cone, only : joint_face_t
   use dda_kinds, only : wp
   implicit none
   private

   public :: chain_step_t, new_chain_step, hash

   !> Motion of the blocks, joints, and equations of a step
   type :: chain_step_t
      !> Length of the step [s]
      real(wp) :: dt = 0.0_wp
      !> Motion of the blocks: (3, n)
      real(wp), allocatable :: motion(:, :)
      !> Trial forces at the beginning of the step: (3, n + 1) [N/m]
      real(wp), allocatable :: start(:, :)
      !> Loads and moments that these leave unbalanced, on the faces of the step before: (3, n)
      real(wp), allocatable :: load(:, :)
      !> Joints that were not stuck in the step before: (n + 1)
      logical, allocatable :: was_loose(:)
      !> Forces that their faces had then: (3, n + 1) [N/m]
      real(wp), allocatable :: held(:, :)
      !> Trial forces at its end: (3, n + 1) [N/m]
      real(wp), allocatable :: trial(:, :)
      !> Admissible forces at its end: (3, n + 1) [N/m]
      real(wp), allocatable :: force(:, :)
      !> Work of what was not in balance at its beginning: it goes into speed, but for what the
      !> springs take [J/m]
      real(wp) :: work = 0.0_wp
      !> Faces that the equations hold: (n + 1)
      type(joint_face_t), allocatable :: face(:)
      !> Which of them are the inside of the cone: (n + 1)
      logical, allocatable :: stuck(:)
      !> Faces that the forces ask for: (n + 1)
      type(joint_face_t), allocatable :: wanted(:)
      !> How far the force of a face is from the admissible one; a joint at either end has no
      !> neighbour there: (0:n + 2) [N/m]
      real(wp), allocatable :: gap(:)
      !> The largest of these [N/m]
      real(wp) :: highest = 0.0_wp
      !> Force that rounding alone can make: of all loads [N/m]
      real(wp) :: load_noise = 0.0_wp
      !> Force that rounding can make over the largest motion [N/m2]
      real(wp) :: spring_noise = 0.0_wp
      !> Matrix of the faces
      type(chain_matrix_t) :: matrix
      !> Its factor
      type(chain_factor_t) :: factor
      !> Blocks that have changed since the factor was made: first and last, none if first > last
      integer :: changed(2) = 0
      !> Passes of the open-close loop
      integer :: passes = 0
      !> Factorisations, whole or in part
      integer :: factorisations = 0
      !> Whether every joint's force agrees with its face
      logical :: settled = .false.
   end type chain_step_t

contains

   !> Room for a step, without length, faces and forces; these are to be in balance with the loads
   pure subroutine new_chain_step(chain, step)
      !> The chain
      type(chain_t), intent(in) :: chain
      !> The step
      type(chain_step_t), intent(out) :: step
      integer :: n

      n = size(chain%mass)
      allocate (step%motion(3, n), step%start(3, n + 1), step%held(3, n + 1))
      allocate (step%trial(3, n + 1), step%force(3, n + 1))
      allocate (step%face(n + 1), step%wanted(n + 1), step%stuck(n + 1))
      allocate (step%load(3, n), source=0.0_wp)
      allocate (step%was_loose(n + 1), source=.false.)
      allocate (step%gap(0:n + 2), source=0.0_wp)
      step%load_noise = 1.0e-13_wp*chain%whole_load
      step%spring_noise = 8.0_wp*epsilon(1.0_wp)*chain%stiffest
      call new_chain_factor(n, step%matrix, step%factor)
   end subroutine new_chain_step

   !> A number that tells sets of faces apart
   pure function hash(step) result(number)
      !> The step
      type(chain_step_t), intent(in) :: step
      !> The number
      integer(int64) :: number
      integer(int64) :: code
      integer :: j

      number = 0_int64
      do j = 1, size(step%face)
         if (step%stuck(j)) cycle
         associate (face => step%face(j))
            code = 12_int64*j + face%slip + 1
            if (face%open(1)) code = code + 3
            if (face%open(2)) code = code + 6
         end associate
         code = ieor(code, ishft(code, 21))
         code = ieor(code, ishft(code, -35))
         code = ieor(code, ishft(code, 4))
         code = ieor(code, ishft(code, 41))
         number = ieor(ishft(number, 7) + ishft(number, -57), code)
      end do
   end function hash
end module dda_chain_state
