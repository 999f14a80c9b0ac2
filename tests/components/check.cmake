# SPDX-License-Identifier: Apache-2.0
# Every component configures alone, with those on which it builds, and finds the libraries of these alone; so does what is
# left when one is left out. `kernel` is built and installed, and a loop around cancellation builds against it and runs. Then
# `identification` and `hardware` are built, without the simulator.
# SOURCE is the source folder of tactus, SCRATCH a folder to work in, BESIDE the folder of that build, which is beside the build
# folder that runs this test; GENERATOR, COMPILER, BUILD_TYPE and WARNINGS_AS_ERRORS are those of this one.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/../run.cmake)
include(${SOURCE}/cmake/TactusComponents.cmake)

# With the same flags and relative paths, ccache has most of what is compiled here. The compiler is known to work.
set(configure ${CMAKE_COMMAND} -G ${GENERATOR} -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_COMPILER_WORKS=ON
              -D CMAKE_BUILD_TYPE=${BUILD_TYPE} -D TACTUS_WARNINGS_AS_ERRORS=${WARNINGS_AS_ERRORS})

# What a component finds, in the words of CMake's cache.
set(finds_kernel Eigen3_DIR)
set(finds_data nlohmann_json_DIR TACTUS_MATIO_LIBRARY TACTUS_HDF5_LIBRARY TACTUS_TINYXML2_LIBRARY TACTUS_ZSTD_INCLUDE_DIR)
set(finds_identification)
set(finds_simulation TACTUS_MUJOCO_LIBRARY)
set(finds_analysis)
set(finds_runtime OPENSSL_SSL_LIBRARY TACTUS_CYCLONEDDS_INCLUDE_DIR)
set(finds_hardware Boost_DIR)
set(finds_interfaces CLI11_DIR)
set(finds_mpi MPI_CXX_HEADER_DIR)

# Configures with the components WANTED, and compares what was built and found with what their closure names.
function(check_configuration wanted)
  file(REMOVE_RECURSE ${SCRATCH}/configured)
  list(JOIN wanted "\;" argument)
  run(${configure} -S ${SOURCE} -B ${SCRATCH}/configured "-DTACTUS_COMPONENTS=${argument}")
  tactus_close_components(closed ${wanted})
  file(STRINGS ${SCRATCH}/configured/CMakeCache.txt cache)
  foreach(component IN LISTS TACTUS_ALL_COMPONENTS)
    foreach(entry IN LISTS finds_${component})
      set(found NO)
      if(cache MATCHES "(^|;)${entry}:[A-Z]+=")
        set(found YES)
      endif()
      set(expected NO)
      if(component IN_LIST closed)
        set(expected YES)
      endif()
      if(NOT found STREQUAL expected)
        message(FATAL_ERROR "with the components ${wanted}: ${entry} of ${component} looked for: ${found}, expected: ${expected}")
      endif()
    endforeach()
    foreach(module IN LISTS TACTUS_COMPONENT_${component})
      tactus_folder(folder ${module})
      if(component IN_LIST closed AND NOT EXISTS ${SCRATCH}/configured/tactus/${folder})
        message(FATAL_ERROR "with the components ${wanted}: module ${module} of ${component} is missing")
      elseif(NOT component IN_LIST closed AND EXISTS ${SCRATCH}/configured/tactus/${folder})
        message(FATAL_ERROR "with the components ${wanted}: module ${module} of ${component} is built and need not be")
      endif()
    endforeach()
  endforeach()
endfunction()

file(REMOVE_RECURSE ${SCRATCH} ${BESIDE})
foreach(component IN LISTS TACTUS_ALL_COMPONENTS)
  if(component STREQUAL "mpi")  # nothing builds on it
    continue()
  endif()
  if(NOT component STREQUAL "interfaces")  # that is the whole, which the build that runs this test has
    check_configuration("${component}")
  endif()
  set(left)
  foreach(other IN LISTS TACTUS_ALL_COMPONENTS)
    tactus_close_components(closed ${other})
    if(NOT component IN_LIST closed)
      list(APPEND left ${other})
    endif()
  endforeach()
  if(left)
    check_configuration("${left}")
  endif()
endforeach()

# scripts/install-deps follows the same rules.
run(sh ${SOURCE}/scripts/install-deps --component kernel --list)
if(NOT output MATCHES "libeigen3-dev" OR output MATCHES "libmatio-dev|libgtest-dev")
  message(FATAL_ERROR "the packages of the kernel are not its own:\n${output}")
endif()
run(sh ${SOURCE}/scripts/install-deps --component mpi --list)
if(NOT output MATCHES "libcli11-dev.*libopenmpi-dev.*openmpi-bin")
  message(FATAL_ERROR "the packages of the component mpi are not its own:\n${output}")
endif()
run(sh ${SOURCE}/scripts/install-deps --list)
if(output MATCHES "openmpi")
  message(FATAL_ERROR "a build without MPI needs packages of MPI:\n${output}")
endif()
run(sh ${SOURCE}/scripts/install-deps --component hardware --list)
if(NOT output MATCHES "libeigen3-dev.*libmatio-dev.*libssl-dev.*libboost-dev" OR output MATCHES "libmujoco-dev|libcli11-dev|libgtest-dev")
  message(FATAL_ERROR "the packages of the hardware are not its own:\n${output}")
endif()

# A name that is no component, and tests of a part, are refused.
execute_process(COMMAND ${configure} -S ${SOURCE} -B ${SCRATCH}/refused -DTACTUS_COMPONENTS=kernal
                RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE refusal)
if(status EQUAL 0 OR NOT refusal MATCHES "names `kernal`")
  message(FATAL_ERROR "a component that does not exist was taken:\n${refusal}")
endif()
execute_process(COMMAND ${configure} -S ${SOURCE} -B ${SCRATCH}/refused -DTACTUS_COMPONENTS=kernel -DTACTUS_BUILD_TESTS=ON
                RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE refusal)
if(status EQUAL 0 OR NOT refusal MATCHES "TACTUS_BUILD_TESTS needs every component")
  message(FATAL_ERROR "tests of a part were taken:\n${refusal}")
endif()

run(${configure} -S ${SOURCE} -B ${BESIDE} -D TACTUS_COMPONENTS=kernel)
run(${CMAKE_COMMAND} --build ${BESIDE} --parallel 1)
run(${CMAKE_COMMAND} --install ${BESIDE} --prefix ${SCRATCH}/prefix)
run(${configure} -S ${SOURCE}/examples/cancellation-loop -B ${SCRATCH}/loop -D CMAKE_PREFIX_PATH=${SCRATCH}/prefix)
run(${CMAKE_COMMAND} --build ${SCRATCH}/loop --parallel 1)
run(${SCRATCH}/loop/cancellation-loop)
if(NOT output MATCHES "moved the motor by up to [0-9]+ um")
  message(FATAL_ERROR "the loop around cancellation printed something else:\n${output}")
endif()

# What this installation lacks is named.
file(WRITE ${SCRATCH}/asks/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)\nproject(asks LANGUAGES CXX)\n
find_package(tactus 0.1 CONFIG REQUIRED COMPONENTS hardware)\n")
execute_process(COMMAND ${configure} -S ${SCRATCH}/asks -B ${SCRATCH}/asks/build -D CMAKE_PREFIX_PATH=${SCRATCH}/prefix
                RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE refusal)
if(status EQUAL 0 OR NOT refusal MATCHES "has no component `hardware`; it has:[ \n]+kernel")
  message(FATAL_ERROR "a component that is not installed was found, or is not named:\n${refusal}")
endif()

# Two more components are built with those on which they build. The folder already has the kernel.
run(${configure} -S ${SOURCE} -B ${BESIDE} "-DTACTUS_COMPONENTS=identification;hardware")
run(${CMAKE_COMMAND} --build ${BESIDE} --parallel 1)
