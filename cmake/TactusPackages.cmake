# SPDX-License-Identifier: Apache-2.0
# The target `packages`: Debian packages of what is installed, one for each component, in the folder `packages` of the build.

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME tactus)
set(CPACK_PACKAGE_CONTACT "The tactus developers")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL command library development python documentation)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)

# Debian's names; the number of the library is its SOVERSION.
set(packages_command tactus)
set(packages_library libtactus0)
set(packages_development libtactus-dev)
set(packages_python python3-tactus)
set(packages_documentation tactus-doc)
set(sections_command science)
set(sections_library libs)
set(sections_development libdevel)
set(sections_python python)
set(sections_documentation doc)

set(CPACK_COMPONENT_COMMAND_DESCRIPTION
    "The tactus command: experiments, advice, diagnosis, identification and rigs.")
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "The shared library with a C interface, for C, Python and other languages.")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
    "Headers and static libraries for programs in C and C++20; find_package(tactus) finds them.")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "The Python package over the shared library.")
set(CPACK_COMPONENT_DOCUMENTATION_DESCRIPTION
    "How-to guides, reference and theory, with the experiments, rigs, recordings and notebooks that they name.")

# What a program that links the static libraries must find too: those of find_package and their own libraries.
set(library_of_this_version "libtactus0 (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "${library_of_this_version}, libeigen3-dev, libmatio-dev, zlib1g-dev, libzstd-dev, libhdf5-dev, libtinyxml2-dev, libssl-dev, cyclonedds-dev, libmujoco-dev")
if(TARGET tactus_ranks)
  string(APPEND CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ", libopenmpi-dev")
endif()
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.9), ${library_of_this_version}")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib, python3-pandas, python3-distributed")
set(CPACK_DEBIAN_COMMAND_PACKAGE_SUGGESTS "tactus-doc")
foreach(component IN ITEMS PYTHON DOCUMENTATION)
  set(CPACK_DEBIAN_${component}_PACKAGE_ARCHITECTURE all)
  set(CPACK_DEBIAN_${component}_PACKAGE_SHLIBDEPS OFF)
  set(CPACK_DEBIAN_${component}_PACKAGE_GENERATE_SHLIBS OFF)
endforeach()

# `cmake --install` leaves these out: Python has its wheel (TactusWheel.cmake lists its modules), and the documentation is
# read where it is.
install(FILES ${wheel_modules} DESTINATION lib/python3/dist-packages/tactus COMPONENT python EXCLUDE_FROM_ALL)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs ${PROJECT_SOURCE_DIR}/examples ${PROJECT_SOURCE_DIR}/experiments
        DESTINATION share/doc/tactus-doc COMPONENT documentation EXCLUDE_FROM_ALL PATTERN __pycache__ EXCLUDE)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${packages_${component}})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${sections_${component}})
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION share/doc/${packages_${component}} RENAME copyright
          COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()

include(CPack)

# `package` of CPack builds the tests too; this one builds what the packages have.
add_custom_target(packages
  COMMAND ${CMAKE_CPACK_COMMAND} --config ${PROJECT_BINARY_DIR}/CPackConfig.cmake
  WORKING_DIRECTORY ${PROJECT_BINARY_DIR}
  COMMENT "Making Debian packages in ${CPACK_PACKAGE_DIRECTORY}"
  VERBATIM)
foreach(module IN LISTS modules_built)
  add_dependencies(packages tactus_${module})
endforeach()
add_dependencies(packages tactus)
