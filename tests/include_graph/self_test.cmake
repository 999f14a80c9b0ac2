# SPDX-License-Identifier: Apache-2.0
# The include check must find each mistake that the folder `broken` holds, and nothing else.
cmake_minimum_required(VERSION 3.25)

execute_process(COMMAND ${CMAKE_COMMAND} -D ROOT=${CMAKE_CURRENT_LIST_DIR}/broken -P ${CMAKE_CURRENT_LIST_DIR}/check.cmake
                RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(status EQUAL 0)
  message("${output}")
  message(FATAL_ERROR "the check let broken includes pass")
endif()

set(expected
  "kernel/core/upward.hpp: kernel/core may not include <tactus/kernel/signal/sound.hpp>: kernel/signal does not stand before it"
  "kernel/control/clock.cpp: the kernel needs no operating system, so it may not include <chrono>"
  "kernel/signal/foreign.hpp: the kernel needs the standard library and Eigen only, so it may not include <nlohmann/json.hpp>"
  "data/recording/leak.hpp: it is installed, so it may not include <matio.h>"
  "interfaces/cli/leak.hpp: it is installed, so it may not include <CLI/CLI.hpp>"
  "data/recording/tape/upward.hpp: data/recording may not include <tactus/interfaces/cli/leak.hpp>: interfaces/cli does not stand before it"
  "data/recording/quoted.hpp: write #include \"quoted.hpp\" as <tactus/component/module/thing.hpp>"
  "data/recording/unknown.hpp: data/recording may not include <tactus/data/stray/thing.hpp>"
  "data/recording/prying.hpp: <tactus/data/recording/internal/tools.hpp> is for the sources of data/recording alone"
  "interfaces/cli/prying.cpp: <tactus/data/recording/internal/tools.hpp> is for the sources of data/recording alone"
  "data/stray/thing.hpp: its folder is that of no module in cmake/TactusComponents.cmake"
  "hardware/devices/aside.hpp: hardware/devices may not include <tactus/simulation/arm_plants/plant.hpp>: hardware does not build on simulation"
  "12 of the includes in 16 files break the layers")
foreach(text IN LISTS expected)
  string(FIND "${output}" "${text}" position)
  if(position EQUAL -1)
    message("${output}")
    message(FATAL_ERROR "the check did not say `${text}`")
  endif()
endforeach()
