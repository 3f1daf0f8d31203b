!> Decisions of scenes, in one word
module scene_decision
   use dda_decision, only : decide, decide_by_steps
   use dda_error, only : error_t
   use dda_kinds, only : wp
   use dda_scene, only : family_t, scene_t
   use dda_search, only : decision_t
   use scene_model, only : model_t, scene_of
   implicit none
   private

   public :: decision_at, decision_of, stepped_at, verdicts_around

contains

   !> Decision of a family's scene
   pure function decision_at(family, value) result(decision)
      class(family_t), intent(in) :: family
      real(wp), intent(in) :: value  !! Value of its parameter
      type(decision_t) :: decision
      type(scene_t) :: scene
      type(error_t), allocatable :: error

      call family%build(value, scene, error)
      call decide(scene, decision)
   end function decision_at

   !> Decision of a family's scene by steps to rest or collapse
   pure function stepped_at(family, value) result(decision)
      class(family_t), intent(in) :: family
      real(wp), intent(in) :: value  !! Value of its parameter
      type(decision_t) :: decision
      type(scene_t) :: scene
      type(error_t), allocatable :: error

      call family%build(value, scene, error)
      call decide_by_steps(scene, decision)
   end function stepped_at

   !> Verdicts of a family just below and just above a value
   pure function verdicts_around(family, value, margin) result(answer)
      class(family_t), intent(in) :: family
      real(wp), intent(in) :: value   !! Value of its parameter
      real(wp), intent(in) :: margin  !! How far below and above
      integer :: answer(2)            !! One of verdict each: (2)
      type(decision_t) :: below, above

      below = decision_at(family, value - margin)
      above = decision_at(family, value + margin)
      answer = [below%outcome%verdict, above%outcome%verdict]
   end function verdicts_around

   !> Decision of a model
   pure function decision_of(model) result(decision)
      type(model_t), intent(in) :: model
      type(decision_t) :: decision
      type(scene_t) :: scene

      scene = scene_of(model)
      call decide(scene, decision)
   end function decision_of
end module scene_decision
