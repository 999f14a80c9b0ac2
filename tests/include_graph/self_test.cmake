# The include check must find each mistake that the folder `broken` holds, and nothing else.
cmake_minimum_required(VERSION 3.25)

execute_process(COMMAND ${CMAKE_COMMAND} -D ROOT=${CMAKE_CURRENT_LIST_DIR}/broken
                        -D "LAYERS=core;signal;mechanics;control;recording;simulation;devices;cli" -P ${CMAKE_CURRENT_LIST_DIR}/check.cmake
                RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(status EQUAL 0)
  message("${output}")
  message(FATAL_ERROR "the check let broken includes pass")
endif()

set(expected
  "core/upward.hpp: core may not include <tactus/signal/sound.hpp>: signal does not stand before it"
  "control/clock.cpp: the kernel needs no operating system, so it may not include <chrono>"
  "signal/foreign.hpp: the kernel needs the standard library and Eigen only, so it may not include <nlohmann/json.hpp>"
  "recording/leak.hpp: it is installed, so it may not include <matio.h>"
  "cli/leak.hpp: it is installed, so it may not include <CLI/CLI.hpp>"
  "recording/tape/upward.hpp: recording may not include <tactus/cli/leak.hpp>: cli does not stand before it"
  "recording/quoted.hpp: write #include \"quoted.hpp\" as <tactus/module/thing.hpp>"
  "recording/unknown.hpp: recording may not include <tactus/stray/thing.hpp>"
  "recording/prying.hpp: <tactus/recording/internal/tools.hpp> is for the sources of recording alone"
  "cli/prying.cpp: <tactus/recording/internal/tools.hpp> is for the sources of recording alone"
  "stray/thing.hpp: its folder is not in TACTUS_LAYERS"
  "devices/aside.hpp: devices may not include <tactus/simulation/plant.hpp>: hardware does not build on simulation"
  "cmake/TactusComponents.cmake: mechanics must belong to one component, and belongs to 0"
  "13 of the includes in 16 files break the layers")
foreach(text IN LISTS expected)
  string(FIND "${output}" "${text}" position)
  if(position EQUAL -1)
    message("${output}")
    message(FATAL_ERROR "the check did not say `${text}`")
  endif()
endforeach()
