# SPDX-License-Identifier: Apache-2.0
# What is installed beside the `tactus` command.

# What completes it in bash, and man pages where help2man is there: both are made by the command itself.
install(CODE "
  set(share \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\")
  file(MAKE_DIRECTORY \"\${share}/bash-completion/completions\" \"\${share}/man/man1\")
  execute_process(COMMAND \"$<TARGET_FILE:tactus>\" completion bash
                  OUTPUT_FILE \"\${share}/bash-completion/completions/tactus\" COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND \"${PROJECT_SOURCE_DIR}/scripts/man-pages\" \"$<TARGET_FILE:tactus>\" \"\${share}/man/man1\"
                  RESULT_VARIABLE made)
  if(NOT made EQUAL 0 AND NOT made EQUAL 77)
    message(FATAL_ERROR \"scripts/man-pages failed: \${made}\")
  endif()
" COMPONENT command)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/experiments DESTINATION ${CMAKE_INSTALL_DATADIR}/tactus COMPONENT command OPTIONAL)
# The live page, where it was built (web/).
install(DIRECTORY ${PROJECT_SOURCE_DIR}/web/dist/ DESTINATION ${CMAKE_INSTALL_DATADIR}/tactus/page
        COMPONENT command OPTIONAL)
