# The paper's tables: run the decks, then print them beside the paper's values
# (variables: DDA, PYTHON, SOURCE, OUT)
set(decks)
foreach(table IN ITEMS table1 table2 table3 table4)
  list(APPEND decks ${SOURCE}/input/paper/${table}.nml)
endforeach()
execute_process(COMMAND ${DDA} run ${decks} --out ${OUT} RESULT_VARIABLE status OUTPUT_QUIET)
execute_process(
  COMMAND ${PYTHON} ${SOURCE}/post/voussoir/paper_tables.py ${OUT}
    ${SOURCE}/input/paper/paper_tables.csv
  COMMAND_ERROR_IS_FATAL ANY)
message("\nResults: ${OUT}")
if(NOT status EQUAL 0)
  message(FATAL_ERROR "dda ended with status ${status}")
endif()
