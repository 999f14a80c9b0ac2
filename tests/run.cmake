# SPDX-License-Identifier: Apache-2.0
# Included by the checks in this folder.

# Runs a command, leaves what it printed in `output`, and ends the check with that where the command fails.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGV " " command)
    message("${output}")
    message(FATAL_ERROR "`${command}` ended with ${status}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()
