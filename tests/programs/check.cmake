# SPDX-License-Identifier: Apache-2.0
# cmake -D ROOT=<source folder> -D LIST=<programs.txt> -P check.cmake
#
# Fails where a package of LIST is not one of scripts/install-deps, or where a file of the tests starts a program by a path
# and LIST does not name it.
cmake_minimum_required(VERSION 3.25)

execute_process(COMMAND sh ${ROOT}/scripts/install-deps --checks --list OUTPUT_VARIABLE packages
                COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE "\n" ";" packages "${packages}")
# npm is not listed where it is there already, maybe from elsewhere.
list(APPEND packages essential npm)

set(wrong "")
set(programs "")
file(STRINGS ${LIST} lines REGEX "^[^#]")
foreach(line IN LISTS lines)
  string(REGEX MATCH "^([^ ]+) +([^ ]+)$" line "${line}")
  list(APPEND programs ${CMAKE_MATCH_1})
  if(NOT CMAKE_MATCH_2 IN_LIST packages)
    string(APPEND wrong "${CMAKE_MATCH_1} needs the package `${CMAKE_MATCH_2}`, which scripts/install-deps does not list\n")
  endif()
endforeach()

file(GLOB_RECURSE files ${ROOT}/tests/*.txt ${ROOT}/tests/*.cmake ${ROOT}/tests/*.cpp ${ROOT}/tests/*.sh)
foreach(file IN LISTS files)
  file(STRINGS ${file} lines REGEX "/bin/[a-z]")
  foreach(line IN LISTS lines)
    if(line MATCHES "(^|[^A-Za-z}])(/usr)?/s?bin/([A-Za-z0-9+-]+)" AND NOT CMAKE_MATCH_3 IN_LIST programs)
      string(APPEND wrong "${file} starts ${CMAKE_MATCH_3}, which ${LIST} does not name\n")
    endif()
  endforeach()
endforeach()

if(wrong)
  message(FATAL_ERROR "${wrong}")
endif()
