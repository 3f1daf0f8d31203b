# The paper's tables: run the decks, then print them beside the paper's values
# (variables: DDA, PYTHON, SOURCE, OUT; PACKAGE: folder of the Python package, and PACKAGE_PYTHON, its
# interpreter, for the figures; empty if there is none)
set(decks)
foreach(table IN ITEMS table1 table2 table3 table4)
  list(APPEND decks ${SOURCE}/input/paper/${table}.nml)
endforeach()
execute_process(COMMAND ${DDA} run ${decks} --out ${OUT} RESULT_VARIABLE status OUTPUT_QUIET)
execute_process(
  COMMAND ${PYTHON} ${SOURCE}/post/voussoir/paper_tables.py ${OUT}
    ${SOURCE}/input/paper/paper_tables.csv
  COMMAND_ERROR_IS_FATAL ANY)
set(without_matplotlib 1)
if(PACKAGE_PYTHON)
  execute_process(COMMAND ${PACKAGE_PYTHON} -c "import matplotlib"
    RESULT_VARIABLE without_matplotlib ERROR_QUIET)
endif()
if(without_matplotlib)
  message("\nFigures 1 to 7 are left out: no Python with NumPy and matplotlib was found")
else()
  set(ENV{PYTHONPATH} ${PACKAGE})
  execute_process(COMMAND ${PACKAGE_PYTHON} -m voussoir.theory_figures --out ${OUT}
    COMMAND_ERROR_IS_FATAL ANY)
endif()
message("\nResults: ${OUT}")
if(NOT status EQUAL 0)
  message(FATAL_ERROR "dda ended with status ${status}")
endif()
