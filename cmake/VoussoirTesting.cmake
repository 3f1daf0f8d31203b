# Tests in the .pf language: by pFUnit where it is installed, else by the runner in
# tests/framework, which reads the same files.
#
#   TEST_FRAMEWORK   AUTO, PFUNIT or BUILTIN
#   add_pfunit_ctest(name TEST_SOURCES a.pf b.pf [OTHER_SOURCES x.f90] [LINK_LIBRARIES lib]
#                    [LABELS label] [WORKING_DIRECTORY folder])
#
# Afterwards VOUSSOIR_TEST_FRAMEWORK is PFUNIT or BUILTIN and VOUSSOIR_TEST_PYTHON is a Python 3
# interpreter, which needs no packages.

set(TEST_FRAMEWORK AUTO CACHE STRING "What runs the .pf tests: AUTO, PFUNIT or BUILTIN")
set_property(CACHE TEST_FRAMEWORK PROPERTY STRINGS AUTO PFUNIT BUILTIN)
set(VOUSSOIR_TEST_FRAMEWORK BUILTIN)

if(DEFINED Python3_EXECUTABLE)
  set(VOUSSOIR_TEST_PYTHON "${Python3_EXECUTABLE}")
else()
  find_program(VOUSSOIR_TEST_PYTHON NAMES python3 python REQUIRED DOC "Python 3 for the tests")
endif()

if(NOT TEST_FRAMEWORK MATCHES "^(AUTO|PFUNIT|BUILTIN)$")
  message(FATAL_ERROR "TEST_FRAMEWORK wants AUTO, PFUNIT or BUILTIN, got '${TEST_FRAMEWORK}'")
elseif(TEST_FRAMEWORK STREQUAL "PFUNIT")
  find_package(PFUNIT REQUIRED)
  set(VOUSSOIR_TEST_FRAMEWORK PFUNIT)
elseif(TEST_FRAMEWORK STREQUAL "AUTO")
  find_package(PFUNIT QUIET)
  if(PFUNIT_FOUND)
    # Module files of another compiler cannot be read by this one.
    file(WRITE "${CMAKE_BINARY_DIR}/pfunit_check.f90" "use funit\nend\n")
    try_compile(VOUSSOIR_PFUNIT_USABLE "${CMAKE_BINARY_DIR}/pfunit_check"
      SOURCES "${CMAKE_BINARY_DIR}/pfunit_check.f90" LINK_LIBRARIES PFUNIT::funit)
    if(VOUSSOIR_PFUNIT_USABLE)
      set(VOUSSOIR_TEST_FRAMEWORK PFUNIT)
    else()
      message(STATUS "pFUnit in ${PFUNIT_DIR} cannot be used by this compiler")
    endif()
  endif()
endif()

if(VOUSSOIR_TEST_FRAMEWORK STREQUAL "PFUNIT")
  message(STATUS "Test framework: pFUnit ${PFUNIT_VERSION} in ${PFUNIT_DIR}")
  return()
endif()
message(STATUS "Test framework: the runner in tests/framework, by ${VOUSSOIR_TEST_PYTHON}")

get_filename_component(VOUSSOIR_FUNIT_SOURCE
  "${CMAKE_CURRENT_LIST_DIR}/../tests/framework" ABSOLUTE)
set(VOUSSOIR_FUNIT_BINARY "${CMAKE_BINARY_DIR}/funit")

add_custom_command(
  OUTPUT "${VOUSSOIR_FUNIT_BINARY}/funit.f90"
  COMMAND "${CMAKE_COMMAND}" -E make_directory "${VOUSSOIR_FUNIT_BINARY}"
  COMMAND "${VOUSSOIR_TEST_PYTHON}" "${VOUSSOIR_FUNIT_SOURCE}/make_funit.py"
          "${VOUSSOIR_FUNIT_BINARY}/funit.f90"
  DEPENDS "${VOUSSOIR_FUNIT_SOURCE}/make_funit.py"
  COMMENT "Writing the assertions"
  VERBATIM)
add_library(funit STATIC EXCLUDE_FROM_ALL
  "${VOUSSOIR_FUNIT_SOURCE}/funit_runner.f90"
  "${VOUSSOIR_FUNIT_SOURCE}/funit_compare.f90"
  "${VOUSSOIR_FUNIT_BINARY}/funit.f90")
# Many short procedures that only pass their arguments on: neither optimised nor warned about.
set_target_properties(funit PROPERTIES
  Fortran_MODULE_DIRECTORY "${VOUSSOIR_FUNIT_BINARY}/mod"
  COMPILE_OPTIONS "$<$<Fortran_COMPILER_ID:GNU>:-std=f2008;-O0;-w>")
target_include_directories(funit PUBLIC "${VOUSSOIR_FUNIT_BINARY}/mod")

# Build one executable of .pf files and make it a test: the keywords are pFUnit's
function(add_pfunit_ctest name)
  set(unsupported REGISTRY MAX_PES EXTRA_USE EXTRA_INITIALIZE EXTRA_FINALIZE)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "WORKING_DIRECTORY;${unsupported}"
    "TEST_SOURCES;OTHER_SOURCES;LINK_LIBRARIES;LABELS")
  foreach(keyword IN LISTS unsupported ITEMS UNPARSED_ARGUMENTS)
    if(DEFINED arg_${keyword})
      message(FATAL_ERROR "add_pfunit_ctest(${name}): the in-tree runner does not know "
        "${keyword} '${arg_${keyword}}'")
    endif()
  endforeach()
  if(NOT arg_TEST_SOURCES)
    message(FATAL_ERROR "add_pfunit_ctest(${name}) wants TEST_SOURCES")
  endif()

  set(preprocessor "${VOUSSOIR_FUNIT_SOURCE}/pf_to_fortran.py")
  set(folder "${CMAKE_CURRENT_BINARY_DIR}/${name}.pf")
  file(MAKE_DIRECTORY "${folder}")
  set(driver "${folder}/${name}_driver.f90")
  set(generated)
  foreach(source IN LISTS arg_TEST_SOURCES)
    if(NOT source MATCHES "\\.pf$")
      message(FATAL_ERROR "add_pfunit_ctest(${name}): TEST_SOURCES are .pf files, got '${source}'")
    elseif(IS_ABSOLUTE "${source}")
      message(FATAL_ERROR "add_pfunit_ctest(${name}): pFUnit would write beside '${source}'; "
        "name it relative to the current folder")
    endif()
    get_filename_component(stem "${source}" NAME_WE)
    add_custom_command(
      OUTPUT "${folder}/${stem}.F90"
      COMMAND "${VOUSSOIR_TEST_PYTHON}" "${preprocessor}" "${CMAKE_CURRENT_SOURCE_DIR}/${source}"
              "${folder}/${stem}.F90"
      DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/${source}" "${preprocessor}"
      COMMENT "Translating ${source}"
      VERBATIM)
    list(APPEND generated "${folder}/${stem}.F90")
  endforeach()
  # Now, not at build time: make would not see that the list of files has changed.
  execute_process(
    COMMAND "${VOUSSOIR_TEST_PYTHON}" "${preprocessor}" --driver ${arg_TEST_SOURCES} "${driver}"
    COMMAND_ERROR_IS_FATAL ANY)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${preprocessor}")

  add_executable(${name} ${generated} ${arg_OTHER_SOURCES} "${driver}")
  set_target_properties(${name} PROPERTIES
    Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/mod/${name}")
  target_include_directories(${name} PRIVATE
    "${CMAKE_CURRENT_BINARY_DIR}/mod/${name}" "${CMAKE_CURRENT_SOURCE_DIR}")
  # Tests run once what the compiler would take minutes to make fast.
  target_compile_options(${name} PRIVATE
    $<$<AND:$<Fortran_COMPILER_ID:GNU>,$<CONFIG:Release>>:-O0>)
  # Without PRIVATE, as pFUnit does it: CMake does not let the two forms be mixed on a target.
  target_link_libraries(${name} ${arg_LINK_LIBRARIES} funit)

  if(NOT arg_WORKING_DIRECTORY)
    set(arg_WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
  endif()
  add_test(NAME ${name} COMMAND ${name} WORKING_DIRECTORY "${arg_WORKING_DIRECTORY}")
  if(arg_LABELS)
    set_property(TEST ${name} PROPERTY LABELS ${arg_LABELS})
  endif()
endfunction()
