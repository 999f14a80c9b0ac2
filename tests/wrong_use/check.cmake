# SPDX-License-Identifier: Apache-2.0
# One wrong use: SOURCE compiles as it stands, and with TACTUS_WRONG_USE defined the compiler refuses it for the reason
# that MESSAGE (a regular expression) describes. COMPILER and INCLUDES say how to compile.
cmake_minimum_required(VERSION 3.25)

list(TRANSFORM INCLUDES PREPEND -I)
set(compile ${COMPILER} -std=c++20 -fsyntax-only ${INCLUDES})

execute_process(COMMAND ${compile} ${SOURCE} RESULT_VARIABLE status ERROR_VARIABLE output)
if(NOT status EQUAL 0)
  message("${output}")
  message(FATAL_ERROR "${SOURCE} must compile without TACTUS_WRONG_USE, and does not")
endif()

execute_process(COMMAND ${compile} -D TACTUS_WRONG_USE ${SOURCE} RESULT_VARIABLE status ERROR_VARIABLE output)
if(status EQUAL 0)
  message(FATAL_ERROR "${SOURCE} must not compile with TACTUS_WRONG_USE, and does")
endif()
if(NOT output MATCHES "error: [^\n]*(${MESSAGE})")
  message("${output}")
  message(FATAL_ERROR "${SOURCE} fails to compile, but no error matches `${MESSAGE}`")
endif()
