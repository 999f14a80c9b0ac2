# What `cmake --install` leaves behind: a package that find_package(tactus) finds, the `tactus` command and the
# experiments.

include(CMakePackageConfigHelpers)
set(TACTUS_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/tactus)

# Libraries of others that a program linking tactus must find too. `Package::target` is found as `Package`; what is
# linked as $<BUILD_INTERFACE:...> (a header-only library that only sources include) concerns no user.
set(dependencies "")
get_property(modules GLOBAL PROPERTY TACTUS_MODULES)
foreach(module IN LISTS modules)
  get_target_property(linked tactus_${module} INTERFACE_LINK_LIBRARIES)
  foreach(library IN LISTS linked)
    if(library MATCHES "^(\\$<LINK_ONLY:)?([A-Za-z0-9_]+)::" AND NOT CMAKE_MATCH_2 STREQUAL "tactus")
      if(CMAKE_MATCH_2 STREQUAL "PkgConfig")
        message(FATAL_ERROR "tactus_${module} links ${library}, which no user of the installed package has; "
                            "link the library by its path instead")
      endif()
      list(APPEND dependencies "find_dependency(${CMAKE_MATCH_2})")
    endif()
  endforeach()
  install(TARGETS tactus_${module} EXPORT tactusTargets)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/tactus/${module} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tactus
          FILES_MATCHING PATTERN *.hpp PATTERN internal EXCLUDE)
endforeach()
list(REMOVE_DUPLICATES dependencies)
list(JOIN dependencies "\n" TACTUS_DEPENDENCIES)

install(EXPORT tactusTargets NAMESPACE tactus:: DESTINATION ${TACTUS_PACKAGE_DIR})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/tactusConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/tactusConfig.cmake
                              INSTALL_DESTINATION ${TACTUS_PACKAGE_DIR}
                              NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may break its users, so 0.1 asks for 0.1.x.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/tactusConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/tactusConfig.cmake ${PROJECT_BINARY_DIR}/tactusConfigVersion.cmake
        DESTINATION ${TACTUS_PACKAGE_DIR})

install(TARGETS tactus)
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
")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/experiments DESTINATION ${CMAKE_INSTALL_DATADIR}/tactus OPTIONAL)
# The live page, where it was built (web/).
install(DIRECTORY ${PROJECT_SOURCE_DIR}/web/dist/ DESTINATION ${CMAKE_INSTALL_DATADIR}/tactus/page OPTIONAL)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
