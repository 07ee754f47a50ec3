# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
#
# What tools/support/commit.cmake writes of a checkout before and after a commit, of a changed one, and of a tree that is
# none: cmake -D TREE=<adit's> -D FOLDER=<to work in> -P commit_test.cmake
find_package(Git QUIET)
if(NOT Git_FOUND)
  message("this test needs git")
  return()
endif()
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/checkout/below)

function(git)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${FOLDER}/checkout -c user.name=a -c user.email=a@b.c -c commit.gpgsign=false
      -c core.hooksPath=/dev/null ${ARGN}
    OUTPUT_VARIABLE said OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_VARIABLE said_why RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "git ${ARGN}: ${said_why}")
  endif()
  set(said ${said} PARENT_SCOPE)
endfunction()

# Writes for a tree and wants this commit named.
function(expect source wanted)
  execute_process(COMMAND ${CMAKE_COMMAND} -D SOURCE=${source} -D OUTPUT=${FOLDER}/commit.cpp
    -P ${TREE}/tools/support/commit.cmake COMMAND_ERROR_IS_FATAL ANY)
  file(STRINGS ${FOLDER}/commit.cpp found REGEX return)
  if(NOT found STREQUAL "  return \"${wanted}\"\\;")
    message(FATAL_ERROR "expected ${wanted} of ${source}, found:${found}")
  endif()
endfunction()

git(init -q)
expect(${FOLDER}/checkout unknown)
foreach(content one two)
  file(WRITE ${FOLDER}/checkout/file ${content})
  git(add file)
  git(commit -q -m ${content})
  git(rev-parse --short HEAD)
  expect(${FOLDER}/checkout ${said})
endforeach()
expect(${FOLDER}/checkout/below unknown)

# Writing the same again leaves the file alone, so that nothing is built again.
expect(${FOLDER}/checkout ${said})
file(TIMESTAMP ${FOLDER}/commit.cpp before "%s")
execute_process(COMMAND ${CMAKE_COMMAND} -E sleep 1.1)
expect(${FOLDER}/checkout ${said})
file(TIMESTAMP ${FOLDER}/commit.cpp after "%s")
if(NOT before STREQUAL after)
  message(FATAL_ERROR "it was written again though nothing had changed")
endif()

file(WRITE ${FOLDER}/checkout/file three)
expect(${FOLDER}/checkout ${said}-dirty)
