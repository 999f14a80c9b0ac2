# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` leaves behind: a package that find_package(tactus) finds, the `tactus` command and the
# experiments. Install components: `library`, `command` and, where none is named, `development`.

include(CMakePackageConfigHelpers)
set(TACTUS_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/tactus)

# Libraries of others that a program linking a component must find too. `Package::target` is found as `Package`; what is
# linked as $<BUILD_INTERFACE:...> (a header-only library that only sources include) concerns no user.
set(component_facts "")
foreach(component IN LISTS TACTUS_COMPONENTS_BUILT)
  set(dependencies "")
  foreach(module IN LISTS TACTUS_COMPONENT_${component})
    get_target_property(linked tactus_${module} INTERFACE_LINK_LIBRARIES)
    foreach(library IN LISTS linked)
      if(library MATCHES "^(\\$<LINK_ONLY:)?([A-Za-z0-9_]+)::" AND NOT CMAKE_MATCH_2 STREQUAL "tactus")
        if(CMAKE_MATCH_2 STREQUAL "PkgConfig")
          message(FATAL_ERROR "tactus_${module} links ${library}, which no user of the installed package has; "
                              "link the library by its path instead")
        endif()
        list(APPEND dependencies ${CMAKE_MATCH_2})
      endif()
    endforeach()
    install(TARGETS tactus_${module} EXPORT tactus_${component}
            LIBRARY COMPONENT library NAMELINK_COMPONENT development)
    tactus_folder(folder ${module})
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/tactus/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tactus/${component}
            FILES_MATCHING PATTERN *.hpp PATTERN internal EXCLUDE)
  endforeach()
  list(REMOVE_DUPLICATES dependencies)
  install(EXPORT tactus_${component} NAMESPACE tactus:: DESTINATION ${TACTUS_PACKAGE_DIR}
          FILE tactus-${component}.cmake)
  string(APPEND component_facts
         "set(_tactus_${component}_modules ${TACTUS_COMPONENT_${component}})\n"
         "set(_tactus_${component}_needs ${TACTUS_COMPONENT_${component}_NEEDS})\n"
         "set(_tactus_${component}_finds ${dependencies})\n")
endforeach()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/tactusConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/tactusConfig.cmake
                              INSTALL_DESTINATION ${TACTUS_PACKAGE_DIR}
                              NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may break its users, so 0.1 asks for 0.1.x.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/tactusConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/tactusConfig.cmake ${PROJECT_BINARY_DIR}/tactusConfigVersion.cmake
        DESTINATION ${TACTUS_PACKAGE_DIR})

if(TARGET tactus)
  install(TARGETS tactus COMPONENT command)
  include(${CMAKE_CURRENT_LIST_DIR}/TactusInstallCommand.cmake)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT command)
