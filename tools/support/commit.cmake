# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
#
# Writes which commit is being built: cmake -D SOURCE=<tree> -D OUTPUT=<file> -P commit.cmake, with each build.
# The file changes only when what it says does. A tree that is no checkout by itself has an unknown one.
find_package(Git QUIET)
set(commit unknown)
if(Git_FOUND)
  set(git ${CMAKE_COMMAND} -E env GIT_OPTIONAL_LOCKS=0 ${GIT_EXECUTABLE} -C ${SOURCE})
  execute_process(COMMAND ${git} rev-parse --show-prefix
    OUTPUT_VARIABLE below OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed AND below STREQUAL "")
    execute_process(COMMAND ${git} describe --always --dirty --exclude=*
      OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
    if(NOT failed)
      set(commit ${described})
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "adit/tools/support/commit.hpp"

namespace adit {

std::string_view commit() {
  return "@commit@";
}

}  // namespace adit
]])
