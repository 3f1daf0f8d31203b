# One flag set for all floors, by compiler. No contraction and no fast maths: -O2 and -O3 give equal
# bits. Local variables are on the stack, for cases run side by side: none may be shared.
#
# CMAKE_Fortran_FLAGS and CMAKE_Fortran_FLAGS_<CONFIG> that a user gives stay as they are; CMake's own
# for GNU say the same twice, and what no source asks for.
if(CMAKE_Fortran_FLAGS_RELEASE STREQUAL "-O3 -DNDEBUG -O3")
  set(CMAKE_Fortran_FLAGS_RELEASE "-O3")
endif()
set(gnu -std=f2008 -Wall -Wextra -Wimplicit-interface -ffp-contract=off -frecursive)
set(gnu_debug -fcheck=all,no-array-temps -fbacktrace -ffpe-trap=invalid,zero,overflow
  -finit-real=snan)
set(llvm_flang -std=f2018 -ffp-contract=off)
set(intel -stand f08 -warn all -fp-model precise -recursive -assume realloc_lhs)
set(intel_debug -check all -traceback)
set(nag -f2008 -w=unused -recursive)
set(nag_debug -C=all -gline)
set(sanitizers -fsanitize=address,undefined -fno-omit-frame-pointer)

add_library(voussoir_flags INTERFACE)
set(is_fortran "$<COMPILE_LANGUAGE:Fortran>")
foreach(compiler IN ITEMS "GNU:gnu" "LLVMFlang:llvm_flang" "Intel,IntelLLVM:intel" "NAG:nag")
  string(REGEX MATCH "(.*):(.*)" _ "${compiler}")
  set(ids "${CMAKE_MATCH_1}")
  set(flags ${${CMAKE_MATCH_2}})
  set(debug_flags ${${CMAKE_MATCH_2}_debug})
  target_compile_options(voussoir_flags INTERFACE
    "$<$<COMPILE_LANG_AND_ID:Fortran,${ids}>:${flags}>"
    "$<$<AND:$<COMPILE_LANG_AND_ID:Fortran,${ids}>,$<CONFIG:Debug>>:${debug_flags}>")
endforeach()
target_compile_options(voussoir_flags INTERFACE
  $<$<BOOL:${VOUSSOIR_WERROR}>:-Werror>
  $<$<BOOL:${VOUSSOIR_NATIVE}>:-march=native>
  $<$<BOOL:${VOUSSOIR_COVERAGE}>:--coverage>
  "$<$<BOOL:${VOUSSOIR_SANITIZE}>:${sanitizers}>")
target_link_options(voussoir_flags INTERFACE
  $<$<BOOL:${VOUSSOIR_COVERAGE}>:--coverage>
  "$<$<BOOL:${VOUSSOIR_SANITIZE}>:${sanitizers}>")
