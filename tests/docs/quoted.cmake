# SPDX-License-Identifier: Apache-2.0
# cmake -D PAGE=<page> -D FILE=<file> -D LANGUAGE=<of the block> -P quoted.cmake
#
# Fails unless PAGE quotes FILE in full, word for word.
cmake_minimum_required(VERSION 3.25)

file(READ ${PAGE} page)
file(READ ${FILE} quoted)
string(FIND "${page}" "```${LANGUAGE}\n${quoted}```" place)
if(place EQUAL -1)
  message(FATAL_ERROR "${PAGE} does not quote ${FILE} as it stands; copy the file into its block of ${LANGUAGE}")
endif()
