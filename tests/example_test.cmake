# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
#
# The program of docs/embedding.md maps a simulated recording; `adit run` must place as many sweeps, the last one at the
# same position. Usage: cmake -D ADIT=... -D EXAMPLE=... -D FOLDER=... -P example_test.cmake
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})

function(run output)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE text ERROR_VARIABLE errors)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGN}: exit code ${code}\n${text}${errors}")
  endif()
  set(${output} "${text}" PARENT_SCOPE)
endfunction()

run(ignored ${ADIT} simulate room --sensor VLP-16 --duration 3 -o ${FOLDER}/room.mcap)
run(ignored ${ADIT} run ${FOLDER}/room.mcap -o ${FOLDER}/out --quiet)
run(printed ${EXAMPLE} ${FOLDER}/room.mcap)

file(STRINGS ${FOLDER}/out/trajectory.tum expected)
string(REGEX MATCHALL "[^\n]+" lines "${printed}")
list(LENGTH expected expected_count)
list(LENGTH lines count)
if(count LESS 10 OR NOT count EQUAL expected_count)
  message(FATAL_ERROR "the example placed ${count} sweeps, adit run ${expected_count}")
endif()

# Stamp and x, to three digits: the example prints six.
list(GET lines -1 last)
list(GET expected -1 expected_last)
string(REGEX MATCH "^[0-9]+ +(-?[0-9.]+)" ignored "${last}")
string(SUBSTRING "${CMAKE_MATCH_1}" 0 5 x)
string(REGEX MATCH "^[0-9.]+ (-?[0-9.]+)" ignored "${expected_last}")
string(SUBSTRING "${CMAKE_MATCH_1}" 0 5 expected_x)
if(NOT x STREQUAL expected_x)
  message(FATAL_ERROR "the example ends at x = ${x}, adit run at ${expected_x}:\n${last}\n${expected_last}")
endif()
