!> What the user should know of a case beside its row
module dda_case_remarks
   use dda_critical, only : critical_t
   use dda_forward, only : outcome_t
   use dda_kinds, only : wp
   use dda_text, only : to_text
   use dda_verdict, only : verdict
   implicit none
   private

   public :: jump_remark, path_remark

contains

   !> What the user should know of the path of a static run
   pure function path_remark(outcome, before) result(remark)
      !> How the run ended
      type(outcome_t), intent(in) :: outcome
      !> What else there is to know
      character(len=*), intent(in) :: before
      !> All of it
      character(len=:), allocatable :: remark

      remark = before
      if (outcome%verdict /= verdict%stable) then
         if (len(remark) > 0) remark = remark//"; "
         remark = remark//trim(merge("the blocks fall    ", "rest is proven till", &
            & outcome%verdict == verdict%collapsed))
         if (outcome%path_time < 0.0_wp) then
            remark = remark//" when led points have gone " &
               & //to_text(1.0_wp + outcome%path_time)//" of their way"
         else
            remark = remark//" at time "//to_text(outcome%path_time)
         end if
      end if
      if (outcome%jumps == 0) return
      if (len(remark) > 0) remark = remark//"; "
      remark = remark//"jumps on the way: "//to_text(outcome%jumps)//", the largest " &
         & //to_text(outcome%largest_jump)//" m"
   end function path_remark

   !> What the user should know of jumps on the loading path
   pure function jump_remark(critical, before) result(remark)
      !> What was found
      type(critical_t), intent(in) :: critical
      !> What else there is to know
      character(len=*), intent(in) :: before
      !> All of it
      character(len=:), allocatable :: remark

      remark = before
      if (len(remark) > 0) remark = remark//"; "
      remark = remark//"jumps on the loading path: "//to_text(critical%jumps)//", the largest " &
         & //to_text(critical%largest_jump)//" m"
   end function jump_remark
end module dda_case_remarks
