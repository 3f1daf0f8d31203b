!> Joint forces of elastic blocks, for a structure that was decided with rigid ones
module dda_shared_forces
   use dda_block_system, only : n_unknown
   use dda_decision, only : decide, decision_t, share_elastically
   use dda_joint_springs, only : new_joint_springs
   use dda_kinds, only : wp
   use dda_scene, only : scene_t
   use dda_settings, only : flow_rule
   implicit none
   private

   public :: share_forces

   !> The first step over the time of free fall through the elastic motion
   real(wp), parameter :: long = 1.0e3_wp

contains

   !> Run a standing scene again with strain. Under the associated rule its rest is one whatever the
   !> way to it: the run begins with the faces of the joints at rest, and with a long step
   pure subroutine share_forces(scene, decision)
      !> The scene as it was decided, rigid
      type(scene_t), intent(in) :: scene
      !> Its decision; contacts and blocks become those of the elastic run if that one agrees
      type(decision_t), intent(inout) :: decision
      type(scene_t) :: elastic
      type(decision_t) :: other
      logical :: shared

      elastic = scene
      elastic%settings%n_dof = n_unknown
      call new_joint_springs(scene%system, 0.0_wp*scene%system%motion, scene%contacts%joint, &
         & scene%settings%penalty_ratio, n_unknown, elastic%contacts%springs)
      if (decision%flow == flow_rule%associated) then
         elastic%contacts%face = decision%contacts%face
         elastic%settings%time_step = long*decision%outcome%elastic_time
      end if
      call share_elastically(elastic%settings, elastic%system, elastic%contacts, other, &
         & shared)
      if (.not. shared) call decide(elastic%settings, elastic%system, elastic%contacts, other)
      if (other%outcome%verdict /= decision%outcome%verdict) return
      decision%contacts = other%contacts
      decision%system = other%system
   end subroutine share_forces
end module dda_shared_forces
