# cmake -D TACTUS=<command> -D PAGE=<page> -D ROOT=<source folder> -D SCRATCH=<folder> -P blocks.cmake
#
# Runs the command blocks of a page as they are written, one after the other, in a folder of its own that has the
# examples. They call the command as build/release/bin/tactus.
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${SCRATCH})
file(MAKE_DIRECTORY ${SCRATCH}/build/release/bin)
file(CREATE_LINK ${TACTUS} ${SCRATCH}/build/release/bin/tactus SYMBOLIC)
file(CREATE_LINK ${ROOT}/examples ${SCRATCH}/examples SYMBOLIC)
file(READ ${PAGE} text)
string(REPLACE ";" "\\;" text "${text}")
string(REGEX MATCHALL "\n```sh\n[^`]+\n```" blocks "${text}")
list(LENGTH blocks count)
if(count EQUAL 0)
  message(FATAL_ERROR "${PAGE} has no command blocks; are they marked with sh?")
endif()
foreach(block IN LISTS blocks)
  string(REGEX REPLACE "^\n```sh\n|\n```$" "" block "${block}")
  execute_process(COMMAND sh -ec "${block}" WORKING_DIRECTORY ${SCRATCH} RESULT_VARIABLE status ERROR_VARIABLE complaint
                  OUTPUT_QUIET)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${PAGE}: this block ends with ${status}:\n${block}\n${complaint}")
  endif()
endforeach()
message("${count} blocks ran")
