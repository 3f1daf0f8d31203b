# The main job: the paper's section 3 beside ours
# (variables: DDA, PYTHON, SOURCE, OUT; PACKAGE: folder of the Python package, and PACKAGE_PYTHON, its
# interpreter; empty if there is none: then the tables alone are printed; OPTIONS: further ones of
# `voussoir paper`)
set(decks ${SOURCE}/input/paper)
if(PACKAGE_PYTHON)
  set(ENV{PYTHONPATH} ${PACKAGE})
  execute_process(
    COMMAND ${PACKAGE_PYTHON} -m voussoir paper --out ${OUT} --decks ${decks} --dda ${DDA} ${OPTIONS}
    RESULT_VARIABLE status)
else()
  message("Tables only: no Python with NumPy was found, which the report wants")
  execute_process(
    COMMAND ${DDA} run ${decks}/table1.nml ${decks}/table2.nml ${decks}/table3.nml
      ${decks}/table4.nml --out ${OUT}
    RESULT_VARIABLE status OUTPUT_QUIET)
  execute_process(
    COMMAND ${PYTHON} ${SOURCE}/post/voussoir_paper/tables.py ${OUT} ${decks}/paper_tables.csv
    COMMAND_ERROR_IS_FATAL ANY)
endif()
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the paper's campaign ended with status ${status}")
endif()
