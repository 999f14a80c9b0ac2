# SPDX-License-Identifier: Apache-2.0
# cmake -D ROOT=<folder that holds tactus/> -P check.cmake
#
# Reads every #include of the library and fails when one breaks a rule of the layers, which ROOT/cmake/TactusComponents.cmake
# lists:
#   - a module includes itself and modules that stand before it, always as <tactus/component/module/thing.hpp>;
#   - a module of a component includes modules of this component and of those on which it builds;
#   - the kernel includes the standard library, Eigen and itself, and nothing that needs an operating system;
#   - no header that is installed includes a library of others, Eigen excepted;
#   - what stands in a folder `internal` is not installed, and only sources of its own module include it.
cmake_minimum_required(VERSION 3.25)

set(needs_a_system barrier chrono condition_variable filesystem fstream future iostream latch mutex semaphore
                   shared_mutex stop_token thread)

include(${ROOT}/cmake/TactusComponents.cmake)
set(layers)
foreach(component IN LISTS TACTUS_ALL_COMPONENTS)
  tactus_close_components(needs_of_${component} ${component})
  foreach(module IN LISTS TACTUS_COMPONENT_${component})
    tactus_folder(folder ${module})
    list(APPEND layers ${folder})
  endforeach()
endforeach()

set(violations "")
function(violation file message)
  list(APPEND violations "${file}: ${message}")
  set(violations "${violations}" PARENT_SCOPE)
endfunction()

file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/tactus/*.hpp ${ROOT}/tactus/*.cpp)
if(NOT files)
  message(FATAL_ERROR "no source files found under ${ROOT}/tactus")
endif()

foreach(file IN LISTS files)
  string(REGEX REPLACE "^tactus/(([^/]+)/[^/]+)/.*" "\\1" module ${file})
  set(component ${CMAKE_MATCH_2})
  list(FIND layers ${module} layer)
  if(layer EQUAL -1)
    violation(${file} "its folder is that of no module in cmake/TactusComponents.cmake")
    continue()
  endif()

  file(STRINGS ${ROOT}/${file} includes REGEX "^[ \t]*#[ \t]*include")
  foreach(include IN LISTS includes)
    if(NOT include MATCHES "<(.+)>")
      violation(${file} "write ${include} as <tactus/component/module/thing.hpp>")
      continue()
    endif()
    set(header ${CMAKE_MATCH_1})

    if(header MATCHES "^tactus/(([^/]+)/[^/]+)/")
      set(included ${CMAKE_MATCH_1})
      set(included_component ${CMAKE_MATCH_2})
      list(FIND layers ${included} included_layer)
      if(included_layer EQUAL -1 OR included_layer GREATER layer)
        violation(${file}
                  "${module} may not include <${header}>: ${included} does not stand before it")
      elseif(NOT included_component IN_LIST needs_of_${component})
        violation(${file}
                  "${module} may not include <${header}>: ${component} does not build on ${included_component}")
      endif()
      if(header MATCHES "/internal/" AND NOT (included STREQUAL module AND file MATCHES "\\.cpp$|/internal/"))
        violation(${file} "<${header}> is for the sources of ${included} alone")
      endif()
    elseif(header MATCHES "^[a-z_0-9]+$")
      if(component STREQUAL "kernel" AND header IN_LIST needs_a_system)
        violation(${file} "the kernel needs no operating system, so it may not include <${header}>")
      endif()
    elseif(NOT header MATCHES "^(unsupported/)?Eigen/")
      if(component STREQUAL "kernel")
        violation(${file} "the kernel needs the standard library and Eigen only, so it may not include <${header}>")
      elseif(file MATCHES "\\.hpp$" AND NOT file MATCHES "/internal/"
             AND NOT header STREQUAL "immintrin.h") # the compiler brings that one
        violation(${file} "it is installed, so it may not include <${header}>: include that in a source file")
      endif()
    endif()
  endforeach()
endforeach()

list(LENGTH files checked)
list(LENGTH violations found)
foreach(text IN LISTS violations)
  message("${text}")
endforeach()
if(found GREATER 0)
  message(FATAL_ERROR "${found} of the includes in ${checked} files break the layers")
endif()
message("the includes of ${checked} files keep the layers")
