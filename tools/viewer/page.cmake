# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
#
# Builds the page of `adit view` with npm, in a copy of its sources, so that nothing is left in the tree:
# cmake -D SOURCE=tools/viewer -D FOLDER=... -D OUTPUT=view_page.cpp -P page.cmake
# A machine without npm, or without what npm needs, gets a program without a page, and is told so.
file(GLOB sources ${SOURCE}/page/* ${SOURCE}/page/.npmrc)
file(COPY ${sources} DESTINATION ${FOLDER})

function(give_up why)
  message(WARNING "adit view is built without its page: ${why}. What else `adit` does is whole. "
    "`./dev setup` installs what the page needs; then remove ${OUTPUT} and build again.")
  configure_file(${SOURCE}/view_page_missing.cpp.in ${OUTPUT} COPYONLY)
  file(TOUCH ${OUTPUT})
endfunction()

find_program(NPM npm NO_CACHE)
find_program(NODE node NO_CACHE)
if(NOT NPM OR NOT NODE)
  give_up("this machine has no npm, or no node")
  return()
endif()

# Packages are installed once for each lock file.
file(SHA256 ${FOLDER}/package-lock.json lock)
set(stamp ${FOLDER}/node_modules/.adit-${lock})
if(NOT EXISTS ${stamp})
  execute_process(COMMAND ${NPM} ci --prefer-offline WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(failed)
    give_up("`npm ci` failed, ${said}")
    return()
  endif()
  file(TOUCH ${stamp})
endif()
execute_process(COMMAND ${NODE} build.mjs ${OUTPUT} WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "the page of `adit view` does not build, see above")
endif()
