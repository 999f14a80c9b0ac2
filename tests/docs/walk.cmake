# SPDX-License-Identifier: Apache-2.0
# cmake -D ROOT=<source folder> -P walk.cmake
#
# Fails unless each stop of the newcomer's walk in docs/architecture.md is a file that holds the name beside it.
cmake_minimum_required(VERSION 3.25)

file(READ ${ROOT}/docs/architecture.md page)
string(REGEX MATCH "\n## A newcomer's walk\n.*\n## Elements\n" walk "${page}")
string(REGEX MATCHALL "\n\\| `[^`]+` \\| `[^`]+` \\|" stops "${walk}")
list(LENGTH stops count)
if(count LESS 20)
  message(FATAL_ERROR "docs/architecture.md: the walk has ${count} stops; is it still there?")
endif()
foreach(stop IN LISTS stops)
  string(REGEX MATCH "`([^`]+)` \\| `([^`]+)`" matched "${stop}")
  set(file ${CMAKE_MATCH_1})
  set(name ${CMAKE_MATCH_2})
  if(NOT EXISTS ${ROOT}/${file})
    message(FATAL_ERROR "docs/architecture.md: the walk stops at ${file}, which is not there")
  endif()
  file(STRINGS ${ROOT}/${file} found REGEX "(^|[^A-Za-z0-9_])${name}([^A-Za-z0-9_]|$)" LIMIT_COUNT 1)
  if(NOT found)
    message(FATAL_ERROR "docs/architecture.md: the walk looks for ${name} in ${file}, where it is not")
  endif()
endforeach()
