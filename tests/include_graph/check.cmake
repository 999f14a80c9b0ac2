# cmake -D ROOT=<folder that holds tactus/> -D "LAYERS=core;signal;..." -P check.cmake
#
# Reads every #include of the library and fails when one breaks a rule of the layers:
#   - a module includes itself and modules that stand before it in LAYERS, always as <tactus/module/thing.hpp>;
#   - a module of a component includes modules of this component and of those on which it builds, as
#     ROOT/cmake/TactusComponents.cmake lists them, and a module in LAYERS belongs to one component;
#   - the kernel includes the standard library, Eigen and itself, and nothing that needs an operating system;
#   - no header that is installed includes a library of others, Eigen excepted;
#   - what stands in a folder `internal` is not installed, and only sources of its own module include it.
cmake_minimum_required(VERSION 3.25)

set(needs_a_system barrier chrono condition_variable filesystem fstream future iostream latch mutex semaphore
                   shared_mutex stop_token thread)

include(${ROOT}/cmake/TactusComponents.cmake)
set(kernel ${TACTUS_COMPONENT_kernel})
foreach(component IN LISTS TACTUS_ALL_COMPONENTS)
  tactus_close_components(needs_of_${component} ${component})
  foreach(module IN LISTS TACTUS_COMPONENT_${component})
    list(APPEND components_of_${module} ${component})
  endforeach()
endforeach()

set(violations "")
function(violation file message)
  list(APPEND violations "${file}: ${message}")
  set(violations "${violations}" PARENT_SCOPE)
endfunction()

foreach(module IN LISTS LAYERS)
  list(LENGTH components_of_${module} owners)
  if(NOT owners EQUAL 1)
    violation(cmake/TactusComponents.cmake "${module} must belong to one component, and belongs to ${owners}")
  endif()
endforeach()

file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/tactus/*.hpp ${ROOT}/tactus/*.cpp)
if(NOT files)
  message(FATAL_ERROR "no source files found under ${ROOT}/tactus")
endif()

foreach(file IN LISTS files)
  string(REGEX REPLACE "^tactus/([^/]+)/.*" "\\1" module ${file})
  list(FIND LAYERS ${module} layer)
  if(layer EQUAL -1)
    violation(${file} "its folder is not in TACTUS_LAYERS of the root CMakeLists.txt")
    continue()
  endif()

  file(STRINGS ${ROOT}/${file} includes REGEX "^[ \t]*#[ \t]*include")
  foreach(include IN LISTS includes)
    if(NOT include MATCHES "<(.+)>")
      violation(${file} "write ${include} as <tactus/module/thing.hpp>")
      continue()
    endif()
    set(header ${CMAKE_MATCH_1})

    if(header MATCHES "^tactus/([^/]+)/")
      set(included ${CMAKE_MATCH_1})
      list(FIND LAYERS ${included} included_layer)
      if(included_layer EQUAL -1 OR included_layer GREATER layer)
        violation(${file}
                  "${module} may not include <${header}>: ${included} does not stand before it in TACTUS_LAYERS")
      elseif(NOT components_of_${included} IN_LIST needs_of_${components_of_${module}})
        violation(${file}
                  "${module} may not include <${header}>: ${components_of_${module}} does not build on ${components_of_${included}}")
      endif()
      if(header MATCHES "/internal/" AND NOT (included STREQUAL module AND file MATCHES "\\.cpp$|/internal/"))
        violation(${file} "<${header}> is for the sources of ${included} alone")
      endif()
    elseif(header MATCHES "^[a-z_0-9]+$")
      if(module IN_LIST kernel AND header IN_LIST needs_a_system)
        violation(${file} "the kernel needs no operating system, so it may not include <${header}>")
      endif()
    elseif(NOT header MATCHES "^(unsupported/)?Eigen/")
      if(module IN_LIST kernel)
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
