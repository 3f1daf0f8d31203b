!> Analysis files in DDAML, the XML format
submodule (dda_read_limerick) dda_ddaml_analysis
   use dda_ddaml_form, only : analysis_form
   use dda_ddaml_material, only : choose, element_error, number_attribute, read_history, &
      & read_joint, read_material, whole_attribute
   use dda_plain_files, only : check_steps
   use dda_word_list, only : quoted
   use dda_xml_tree, only : attribute_of, count_children, find_child
   implicit none

   !> Default maximum number of steps of the gravity phase
   integer, parameter :: usual_gravity_steps = 5000

contains

   !> Read the analysis from an element tree
   module procedure read_ddaml_analysis
      integer :: part

      analysis%file = tree%file
      ! Shi's values for absent elements
      analysis%auto_time_step = .false.
      analysis%auto_penalty = .false.
      call find_part(tree, "Analysis", part, error)
      if (.not. allocated(error)) call check_elements(tree, part, analysis_form, warnings, error)
      if (allocated(error)) return
      ! gravity gives the unit weights that are missing
      call number_attribute(tree, part, "Gravaccel", "value", 0.0_wp, analysis%gravity, error)
      if (.not. allocated(error)) call read_properties(tree, part, analysis, warnings, error)
      if (.not. allocated(error)) call read_loads(tree, part, analysis, error)
      if (.not. allocated(error)) call read_switches(tree, part, analysis, warnings, error)
      call read_bounds(tree, part, analysis, error)
      call read_constants(tree, part, analysis, error)
      if (.not. allocated(error)) call check_complete(tree, part, analysis, warnings, error)
   end procedure read_ddaml_analysis

   !> Read the constants of the scheme
   pure subroutine read_constants(tree, part, analysis, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: part  !! Place of Analysis
      type(limerick_analysis_t), intent(inout) :: analysis
      type(error_t), allocatable, intent(inout) :: error
      integer :: at

      at = find_child(tree, part, "AConstants")
      if (at == 0) return
      call number_attribute(tree, at, "Openclose", "value", 0.0_wp, analysis%close_ratio, error)
      call number_attribute(tree, at, "Opencriteria", "value", 0.0_wp, analysis%open_ratio, error)
      call number_attribute(tree, at, "NormSpringPen", "value", 1.0e-30_wp, &
         & analysis%penetration_ratio, error)
      call number_attribute(tree, at, "AngleOverlap", "value", 0.0_wp, analysis%overlap_deg, error)
      call number_attribute(tree, at, "ShearNormRatio", "value", 1.0e-30_wp, &
         & analysis%stiffness_ratio, error)
   end subroutine read_constants

   !> Read the limits of a run
   pure subroutine read_bounds(tree, part, analysis, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: part
      type(limerick_analysis_t), intent(inout) :: analysis
      type(error_t), allocatable, intent(inout) :: error
      integer :: at, i
      character(len=*), parameter :: damping(2) = ["Contactdamping", "ContactDamping"]
      character(len=*), parameter :: limit(2) = ["Opencloselimit", "OCLimit       "]

      call whole_attribute(tree, part, "Numtimesteps", "timesteps", 1, analysis%max_steps, error)
      call number_attribute(tree, part, "Maxtimestep", "maxtimestep", 0.0_wp, analysis%time_step, &
         & error)
      call number_attribute(tree, part, "Mintimestep", "mintimestep", 0.0_wp, &
         & analysis%min_time_step, error)
      call number_attribute(tree, part, "Maxdisplacement", "maxdisplacement", 0.0_wp, &
         & analysis%max_displacement_ratio, error)
      do i = 1, 2
         call whole_attribute(tree, part, trim(limit(i)), "maxopenclose", 1, &
            & analysis%open_close_limit, error)
         call number_attribute(tree, part, damping(i), "value", 0.0_wp, analysis%contact_damping, &
            & error)
      end do
      at = find_child(tree, part, "Saveinterval")
      if (at == 0) return
      analysis%save_interval = 10
      if (attribute_place(tree, at, "step") > 0) &
         & call whole_attribute(tree, part, "Saveinterval", "step", 0, analysis%save_interval, &
         & error)
      if (analysis%save_interval == 0) analysis%save_interval = 10
   end subroutine read_bounds

   !> Read the elements with a choice of words
   pure subroutine read_switches(tree, part, analysis, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: part
      type(limerick_analysis_t), intent(inout) :: analysis
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(inout) :: error
      logical :: turned_on
      integer :: at

      call choose(tree, part, "Analysistype", "type", "dynamic", "static", analysis%dynamic, error)
      call choose(tree, part, "Rotation", "type", "exact secondorder", "linear", &
         & analysis%exact_rotation, error)
      turned_on = .false.
      call choose(tree, part, "Gravity", "flag", "yes", "no", turned_on, error)
      if (turned_on) call read_gravity(tree, find_child(tree, part, "Gravity"), analysis, error)
      call choose(tree, part, "Autotimestep", "flag", "yes", "no", analysis%auto_time_step, error)
      call choose(tree, part, "Planestrain", "flag", "yes", "no", analysis%plane_strain, error)
      call choose(tree, part, "Autopenalty", "flag", "yes", "no", analysis%auto_penalty, error)
      at = find_child(tree, part, "Autopenalty")
      if (allocated(error) .or. at == 0) return
      if (attribute_place(tree, at, "pfactor") > 0) then
         call number_attribute(tree, part, "Autopenalty", "pfactor", 0.0_wp, &
            & analysis%penalty_factor, error)
      else
         call add_warning(warnings, "Autopenalty needs the attribute pfactor: using 50", &
            & tree%file, tree%element(at)%row)
      end if
   end subroutine read_switches

   !> Read the phase that applies gravity
   pure subroutine read_gravity(tree, at, analysis, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at  !! Place of Gravity
      type(limerick_analysis_t), intent(inout) :: analysis
      type(error_t), allocatable, intent(inout) :: error

      analysis%gravity_steps = usual_gravity_steps
      call whole_attribute(tree, at, "Gravitysteplimit", "val", 1, analysis%gravity_steps, error)
      call number_attribute(tree, at, "Normaltolerance", "val", 0.0_wp, &
         & analysis%gravity_tolerance(1), error)
      call number_attribute(tree, at, "Sheartolerance", "val", 0.0_wp, &
         & analysis%gravity_tolerance(2), error)
   end subroutine read_gravity

   !> Read the materials of blocks and joints
   pure subroutine read_properties(tree, part, analysis, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: part  !! Place of Analysis
      type(limerick_analysis_t), intent(inout) :: analysis
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      integer :: at, n_blocks, n_joints
      logical :: has_bolt

      has_bolt = .false.
      allocate (analysis%material(count_children(tree, part, "Blockmaterial")))
      allocate (analysis%joint(count_children(tree, part, "Jointproperties")))
      n_blocks = 0
      n_joints = 0
      at = first_child(tree, part)
      do while (at > 0 .and. .not. allocated(error))
         if (tree%element(at)%name == "Blockmaterial") then
            n_blocks = n_blocks + 1
            call check_type(tree, at, n_blocks, warnings)
            call read_material(tree, at, analysis%gravity, analysis%material(n_blocks), warnings, &
               & error)
         else if (tree%element(at)%name == "Jointproperties") then
            n_joints = n_joints + 1
            call check_type(tree, at, n_joints, warnings)
            call read_joint(tree, at, analysis%joint(n_joints), warnings, error)
         else if (tree%element(at)%name == "Boltproperties" .and. .not. has_bolt) then
            has_bolt = .true.
            call read_bolt(tree, at, analysis%bolt, error)
         end if
         at = next_sibling(tree, at)
      end do
   end subroutine read_properties

   !> Read bolt properties: the first such element applies to all bolts, as in Shi's program
   pure subroutine read_bolt(tree, at, property, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at
      real(wp), intent(out) :: property(3)  !! Stiffness, strength and prestress: (3)
      type(error_t), allocatable, intent(out) :: error
      character(len=*), parameter :: what(3) = [character(len=9) :: "stiffness", "strength", &
         & "prestress"]
      type(word_list_t) :: words
      integer :: k

      property = 0.0_wp
      call element_words(tree, at, words)
      do k = 1, 3
         call take_property(words, "the "//trim(what(k))//" of bolts", property(k), error)
      end do
   end subroutine read_bolt

   !> Warn of material types: numbers follow the order of the file, whatever the type is
   pure subroutine check_type(tree, at, number, warnings)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: at      !! Place of the material
      integer, intent(in) :: number  !! Its number
      type(warnings_t), intent(inout) :: warnings
      character(len=:), allocatable :: given

      given = attribute_of(tree, at, "type")
      if (given == "" .or. given == to_text(number)) return
      call add_warning(warnings, "expected type "//to_text(number)//" of "//tree%element(at)%name &
         & //", its place in the file, got "//quoted(given)//": using its place", tree%file, &
         & tree%element(at)%row)
   end subroutine check_type

   !> Read the forces on load points
   pure subroutine read_loads(tree, part, analysis, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: part
      type(limerick_analysis_t), intent(inout) :: analysis
      type(error_t), allocatable, intent(out) :: error
      integer :: list, at, n, pass

      do pass = 1, 2
         n = 0
         list = first_child(tree, part)
         do while (list > 0)
            if (tree%element(list)%name == "Loadpointlist") then
               at = first_child(tree, list)
               do while (at > 0)
                  n = n + 1
                  if (pass == 2) call read_history(tree, at, analysis%load(n), error)
                  if (allocated(error)) return
                  at = next_sibling(tree, at)
               end do
            end if
            list = next_sibling(tree, list)
         end do
         if (pass == 1) allocate (analysis%load(n))
      end do
   end subroutine read_loads

   !> Check that an analysis is complete
   pure subroutine check_complete(tree, part, analysis, warnings, error)
      type(xml_tree_t), intent(in) :: tree
      integer, intent(in) :: part
      type(limerick_analysis_t), intent(in) :: analysis
      type(warnings_t), intent(inout) :: warnings
      type(error_t), allocatable, intent(out) :: error
      character(len=*), parameter :: wanted(5) = [character(len=16) :: "Numtimesteps", &
         & "Maxtimestep", "Maxdisplacement", "Blockmaterial", "Jointproperties"]
      integer :: i

      do i = 1, size(wanted)
         if (find_child(tree, part, trim(wanted(i))) == 0) call element_error(tree, part, &
            & "expected the element "//trim(wanted(i))//" in Analysis, got none; add it", error)
      end do
      if (allocated(error)) return
      if (find_child(tree, part, "Autopenalty") == 0) call add_warning(warnings, "expected " &
         & //"Autopenalty, got none: using flag=""no"" with pfactor=""50""", &
         & tree%file, tree%element(part)%row)
      call check_steps(analysis, tree%file, tree%element(part)%row, error)
   end subroutine check_complete

end submodule dda_ddaml_analysis
