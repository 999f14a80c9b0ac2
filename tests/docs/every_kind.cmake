# SPDX-License-Identifier: Apache-2.0
# cmake -D TACTUS=<command> -D FOLDER=<of the reference pages> -P every_kind.cmake
#
# Fails unless each kind of experiment that the command knows has a page in FOLDER.
cmake_minimum_required(VERSION 3.25)

# The command lists its kinds to who asks for one that is not there.
execute_process(COMMAND ${TACTUS} schema - RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE refusal)
if(NOT status EQUAL 2 OR NOT refusal MATCHES "write one of ([a-z, -]+)")
  message(FATAL_ERROR "`tactus schema -` ended with ${status} and listed no kinds: ${refusal}")
endif()
string(REPLACE ", " ";" kinds "${CMAKE_MATCH_1}")
foreach(kind IN LISTS kinds)
  if(NOT EXISTS ${FOLDER}/${kind}.md)
    message(FATAL_ERROR "docs/reference/${kind}.md is missing; write it from the root of the project with\n"
                        "  build/release/bin/tactus schema ${kind} --reference > docs/reference/${kind}.md")
  endif()
endforeach()
list(LENGTH kinds count)
message("${count} kinds have their pages")
