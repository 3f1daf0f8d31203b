# The Python package: the theory's Fortran as the extension module voussoir._theory, beside the
# package's own files, so that PYTHONPATH=<build>/python finds it, and <build>/bin/voussoir runs it.
#
#   voussoir_find_python()   sets VOUSSOIR_PYTHON to an interpreter that has NumPy and the headers
#                            to build for it, or to VOUSSOIR_PYTHON-NOTFOUND; says which and why
#   voussoir_add_python()    targets _theory and voussoir_python (in ALL); nothing without Python
#
# Python3_EXECUTABLE, where given, is the only candidate; else the first python3 on PATH, then that of
# each system prefix: a private interpreter without NumPy does not hide the system's.
# The same file serves `pip install .` (SKBUILD is then set).

enable_language(C)

get_filename_component(VOUSSOIR_SOURCE_ROOT "${CMAKE_CURRENT_LIST_DIR}/.." ABSOLUTE)

# Whether an interpreter can import NumPy's f2py: its NumPy version in `version`, empty if not
function(voussoir_numpy_version interpreter version)
  execute_process(
    COMMAND "${interpreter}" -c "import numpy, numpy.f2py; print(numpy.__version__)"
    OUTPUT_VARIABLE found ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed)
  if(failed)
    set(found "")
  endif()
  set(${version} "${found}" PARENT_SCOPE)
endfunction()

function(voussoir_find_python)
  set(candidates)
  if(Python3_EXECUTABLE)
    list(APPEND candidates "${Python3_EXECUTABLE}")
  elseif(Python_EXECUTABLE)
    list(APPEND candidates "${Python_EXECUTABLE}")
  else()
    find_program(VOUSSOIR_FIRST_PYTHON NAMES python3 python)
    mark_as_advanced(VOUSSOIR_FIRST_PYTHON)
    if(VOUSSOIR_FIRST_PYTHON)
      list(APPEND candidates "${VOUSSOIR_FIRST_PYTHON}")
    endif()
    foreach(prefix IN LISTS CMAKE_SYSTEM_PREFIX_PATH)
      if(EXISTS "${prefix}/bin/python3")
        list(APPEND candidates "${prefix}/bin/python3")
      endif()
    endforeach()
    list(REMOVE_DUPLICATES candidates)
  endif()

  set(chosen VOUSSOIR_PYTHON-NOTFOUND)
  foreach(candidate IN LISTS candidates)
    voussoir_numpy_version("${candidate}" numpy_version)
    if(numpy_version)
      set(chosen "${candidate}")
      break()
    endif()
    message(STATUS "Python: ${candidate} has no NumPy")
  endforeach()
  if(NOT chosen)
    message(STATUS "Python: no interpreter with NumPy was found (on Debian: python3-numpy). "
      "The package voussoir is left out; the Fortran program and its tests are built.")
  endif()
  set(VOUSSOIR_PYTHON "${chosen}" PARENT_SCOPE)
endfunction()

# Symlinks of the files of all packages of post/ and of tests/voussoir_benches in <build>/python, where the extension
# is put as well. Those beside voussoir, which test the program and repeat the paper, are not installed.
function(voussoir_link_packages folder)
  file(GLOB_RECURSE links "${folder}/*.py" "${folder}/*.json")
  foreach(link IN LISTS links)  # of files that have moved: a module must not hide a package
    if(IS_SYMLINK "${link}" AND NOT EXISTS "${link}")
      file(REMOVE "${link}")
    endif()
  endforeach()
  foreach(package IN ITEMS post/voussoir post/voussoir_paper tests/voussoir_benches)
    get_filename_component(root "${VOUSSOIR_SOURCE_ROOT}/${package}" DIRECTORY)
    file(GLOB_RECURSE files CONFIGURE_DEPENDS RELATIVE "${root}" "${VOUSSOIR_SOURCE_ROOT}/${package}/*")
    list(FILTER files EXCLUDE REGEX "(^|/)__pycache__/|\\.pyc$")
    foreach(file IN LISTS files)
      get_filename_component(subfolder "${folder}/${file}" DIRECTORY)
      file(MAKE_DIRECTORY "${subfolder}")
      file(CREATE_LINK "${root}/${file}" "${folder}/${file}" COPY_ON_ERROR SYMBOLIC)
    endforeach()
  endforeach()
endfunction()

function(voussoir_add_python)
  voussoir_find_python()
  set(VOUSSOIR_PYTHON "${VOUSSOIR_PYTHON}" PARENT_SCOPE)
  if(NOT VOUSSOIR_PYTHON)
    return()
  endif()

  set(Python3_EXECUTABLE "${VOUSSOIR_PYTHON}")
  find_package(Python3 QUIET COMPONENTS Interpreter Development.Module NumPy)
  if(NOT Python3_Development.Module_FOUND OR NOT Python3_NumPy_FOUND)
    message(STATUS "Python: ${VOUSSOIR_PYTHON} has no headers to build for (on Debian: python3-dev). "
      "The package voussoir is left out; the Fortran program and its tests are built.")
    set(VOUSSOIR_PYTHON VOUSSOIR_PYTHON-NOTFOUND PARENT_SCOPE)
    return()
  endif()
  message(STATUS "Python: ${VOUSSOIR_PYTHON} ${Python3_VERSION} with NumPy ${Python3_NumPy_VERSION}")

  # f2py only writes the C and Fortran of the wrapper; CMake compiles them.
  set(theory "${VOUSSOIR_SOURCE_ROOT}/src/theory")
  set(generated "${CMAKE_CURRENT_BINARY_DIR}/f2py")
  set(api "${theory}/theory_api.f90")
  file(MAKE_DIRECTORY "${generated}")
  execute_process(
    COMMAND "${VOUSSOIR_PYTHON}" -c "import numpy.f2py; print(numpy.f2py.get_include())"
    OUTPUT_VARIABLE f2py_include OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  add_custom_command(
    OUTPUT "${generated}/_theorymodule.c" "${generated}/_theory-f2pywrappers2.f90"
    COMMAND "${VOUSSOIR_PYTHON}" -m numpy.f2py ${api} -m _theory --lower --quiet
            --f2cmap "${theory}/theory.f2cmap"
    WORKING_DIRECTORY "${generated}"
    DEPENDS ${api} "${theory}/theory.f2cmap"
    COMMENT "Wrapping the theory for Python"
    VERBATIM)

  file(GLOB sources CONFIGURE_DEPENDS "${theory}/couplet_heyman*.f90")
  Python3_add_library(_theory MODULE WITH_SOABI ${sources} ${api}
    "${generated}/_theorymodule.c" "${generated}/_theory-f2pywrappers2.f90"
    "${f2py_include}/fortranobject.c")
  # Before the system's: Debian's own NumPy headers would shadow those of a newer NumPy.
  target_include_directories(_theory BEFORE PRIVATE ${Python3_NumPy_INCLUDE_DIRS} "${f2py_include}")
  target_compile_definitions(_theory PRIVATE NPY_NO_DEPRECATED_API=NPY_1_7_API_VERSION)
  # Calls run side by side: local variables are on the stack
  set(fortran -O3 -ffp-contract=off -fno-tree-loop-vectorize -frecursive)
  target_compile_options(_theory PRIVATE
    "$<$<COMPILE_LANG_AND_ID:Fortran,GNU>:${fortran}>" "$<$<COMPILE_LANGUAGE:C>:-w>")
  set_target_properties(_theory PROPERTIES
    Fortran_MODULE_DIRECTORY "${generated}/mod"
    POSITION_INDEPENDENT_CODE ON)
  target_include_directories(_theory PRIVATE "${generated}/mod")

  if(SKBUILD)
    install(TARGETS _theory LIBRARY DESTINATION voussoir COMPONENT python)
    return()
  endif()
  set(package "${CMAKE_BINARY_DIR}/python/voussoir")
  voussoir_link_packages("${CMAKE_BINARY_DIR}/python")
  # The generator expression keeps generators of several configurations from adding a subfolder.
  set_target_properties(_theory PROPERTIES LIBRARY_OUTPUT_DIRECTORY "${package}$<0:>")
  add_custom_target(voussoir_python ALL DEPENDS _theory)
  set(permissions OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
    WORLD_EXECUTE)
  set(VOUSSOIR_PACKAGE_FOLDER python)
  configure_file("${VOUSSOIR_SOURCE_ROOT}/cmake/voussoir.in" "${CMAKE_BINARY_DIR}/bin/voussoir"
    @ONLY FILE_PERMISSIONS ${permissions})

  # Installed, the package has a folder of its own: no other Python meets it by accident.
  set(VOUSSOIR_PACKAGE_FOLDER "${CMAKE_INSTALL_LIBDIR}/voussoir/python")
  configure_file("${VOUSSOIR_SOURCE_ROOT}/cmake/voussoir.in"
    "${CMAKE_BINARY_DIR}/install/voussoir" @ONLY)
  install(PROGRAMS "${CMAKE_BINARY_DIR}/install/voussoir" TYPE BIN COMPONENT python)
  install(TARGETS _theory LIBRARY DESTINATION "${VOUSSOIR_PACKAGE_FOLDER}/voussoir"
    COMPONENT python)
  install(DIRECTORY "${VOUSSOIR_SOURCE_ROOT}/post/voussoir"
    DESTINATION "${VOUSSOIR_PACKAGE_FOLDER}" COMPONENT python
    PATTERN "__pycache__" EXCLUDE PATTERN "*.pyc" EXCLUDE)
endfunction()
