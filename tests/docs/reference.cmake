# SPDX-License-Identifier: Apache-2.0
# cmake -D TACTUS=<command> -D KIND=<experiment> -D PAGE=<page under ROOT> -D ROOT=<source folder> -P reference.cmake
#
# Fails, with the first line that differs and the command that mends it, unless PAGE is what the command prints.
cmake_minimum_required(VERSION 3.25)

set(remedy "regenerate it from the root of the project with\n  build/release/bin/tactus schema ${KIND} --reference > ${PAGE}")

execute_process(COMMAND ${TACTUS} schema ${KIND} --reference RESULT_VARIABLE status OUTPUT_VARIABLE printed)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "`tactus schema ${KIND} --reference` failed with status ${status}")
endif()
if(NOT EXISTS ${ROOT}/${PAGE})
  message(FATAL_ERROR "${PAGE} is missing; ${remedy}")
endif()
file(READ ${ROOT}/${PAGE} page)
if(page STREQUAL printed)
  return()
endif()

# Brackets and semicolons would split or join the entries of a CMake list.
foreach(text page printed)
  string(REPLACE ";" "<semicolon>" ${text} "${${text}}")
  string(REPLACE "[" "<" ${text} "${${text}}")
  string(REPLACE "]" ">" ${text} "${${text}}")
  string(REPLACE "\n" ";" ${text} "${${text}}")
endforeach()
foreach(old new IN ZIP_LISTS page printed)
  math(EXPR line "${line} + 1")
  if(NOT old STREQUAL new)
    message("${PAGE}:${line}\n  page:    ${old}\n  command: ${new}")
    break()
  endif()
endforeach()
message(FATAL_ERROR "${PAGE} is not what the command prints; ${remedy}")
