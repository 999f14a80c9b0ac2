# SPDX-License-Identifier: Apache-2.0
# Installs what BUILD holds into SCRATCH/prefix, and builds and runs the programs of this folder and the examples
# against it.
# GENERATOR, COMPILER and BUILD_TYPE are those of BUILD; SOURCE is the source folder of tactus.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/../run.cmake)

# What a program does once compiles in half the time without optimisation.
string(TOUPPER "${BUILD_TYPE}" upper)
function(build_against_the_package source build)
  run(${CMAKE_COMMAND} -S ${source} -B ${build} -G ${GENERATOR} -D CMAKE_CXX_COMPILER=${COMPILER}
      -D CMAKE_BUILD_TYPE=${BUILD_TYPE} "-DCMAKE_CXX_FLAGS_${upper}=-O0 -DNDEBUG" -D CMAKE_PREFIX_PATH=${SCRATCH}/prefix)
  run(${CMAKE_COMMAND} --build ${build} --parallel 1)  # the core that the test has, not all
endfunction()

file(REMOVE_RECURSE ${SCRATCH})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${SCRATCH}/installed)

# A prefix that was moved must work like one that was not, and nothing in it may point back to where it was built.
file(RENAME ${SCRATCH}/installed ${SCRATCH}/prefix)
file(GLOB_RECURSE package_files ${SCRATCH}/prefix/*.cmake)
foreach(file IN LISTS package_files)
  file(STRINGS ${file} lines)
  foreach(folder IN ITEMS ${SOURCE}/ ${BUILD} ${SCRATCH}/installed)
    string(FIND "${lines}" "${folder}" position)
    if(NOT position EQUAL -1)
      message(FATAL_ERROR "${file} names ${folder}, which no user of the package has")
    endif()
  endforeach()
endforeach()

build_against_the_package(${CMAKE_CURRENT_LIST_DIR} ${SCRATCH}/build)
run(${SCRATCH}/build/consumer)
run(${SCRATCH}/build/my_controller)
run(${SCRATCH}/build/everything)
run(${SCRATCH}/prefix/bin/tactus --help)

# An architecture of a user's own is one that a file can name. The example's force bends from half the force limit on:
# at a force gain of 0.1 no tap comes near that and the architecture is position-force bit for bit, at 3 it is not.
build_against_the_package(${SOURCE}/examples/own-architecture ${SCRATCH}/example)
set(my_tactus ${SCRATCH}/example/my-tactus)
set(experiment ${SCRATCH}/prefix/share/tactus/experiments/tapping.toml)
run(${my_tactus} run ${experiment} --json --set task.taps=2 --vary control.force_gain=0.1,3
    --vary control.architecture=position-force,soft-limit)
foreach(index RANGE 3)
  string(JSON metrics_${index} GET "${output}" runs ${index} metrics)
endforeach()
if(NOT metrics_0 STREQUAL metrics_1)
  message(FATAL_ERROR "without a large force soft-limit is not position-force:\n${output}")
endif()
if(metrics_2 STREQUAL metrics_3)
  message(FATAL_ERROR "soft-limit changes nothing:\n${output}")
endif()

execute_process(COMMAND ${my_tactus} run ${experiment} --set control.architecture=no-such
                RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE refusal)
if(NOT status EQUAL 2 OR NOT refusal MATCHES "^my-tactus: .*write one of position-force, .*soft-limit")
  message(FATAL_ERROR "an unknown architecture ended with ${status} and did not list the one of the example:\n${refusal}")
endif()

# Its own key is loaded, varied, checked with its place and documented as those of the library are. A smaller share bends
# earlier, so that the same taps end otherwise.
file(WRITE ${SCRATCH}/own.toml "[task]\nkind = \"tapping\"\ntaps = 2\n[control]\narchitecture = \"soft-limit\"\n
force_gain = 3.0\n[control.soft_limit]\nlinear_fraction = 0.2\n")
run(${my_tactus} run ${SCRATCH}/own.toml --json)
string(JSON from_file GET "${output}" runs 0 metrics)
run(${my_tactus} run ${SCRATCH}/own.toml --json --vary control.soft_limit.linear_fraction=0.2,0.8)
string(JSON varied_first GET "${output}" runs 0 metrics)
string(JSON varied_second GET "${output}" runs 1 metrics)
if(NOT from_file STREQUAL varied_first OR from_file STREQUAL varied_second)
  message(FATAL_ERROR "the own key of soft-limit was not used:\n${output}")
endif()
execute_process(COMMAND ${my_tactus} run ${SCRATCH}/own.toml --set control.soft_limit.linear_fraction=2
                RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE refusal)
if(NOT status EQUAL 2 OR NOT refusal MATCHES "control.soft_limit.linear_fraction: 2 is out of bounds")
  message(FATAL_ERROR "an own key out of bounds ended with ${status}:\n${refusal}")
endif()
file(WRITE ${SCRATCH}/wrong.toml "[task]\nkind = \"tapping\"\n[control.soft_limit]\nlinear_fractoin = 0.2\n")
execute_process(COMMAND ${my_tactus} run ${SCRATCH}/wrong.toml RESULT_VARIABLE status OUTPUT_QUIET
                ERROR_VARIABLE refusal)
if(NOT status EQUAL 2 OR NOT refusal MATCHES "wrong.toml:4:1: .*did you mean linear_fraction")
  message(FATAL_ERROR "a wrong own key ended with ${status} and no place:\n${refusal}")
endif()
run(${my_tactus} schema tapping)
string(JSON share GET "${output}" properties control properties soft_limit properties linear_fraction default)
run(${my_tactus} schema tapping --reference)
if(NOT share EQUAL 0.5 OR NOT output MATCHES "## `.control.soft_limit.`\n\nArchitecture soft-limit: where its bend begins")
  message(FATAL_ERROR "schema and reference do not tell the own key of soft-limit:\n${output}")
endif()

# Margins are those of position-force, as it has declared; a map, which sees the bend, refuses it by name.
foreach(architecture IN ITEMS position-force soft-limit)
  run(${my_tactus} stability margins ${experiment} --json --set control.architecture=${architecture})
  string(JSON margins_of_${architecture} GET "${output}" gain_limit)
endforeach()
if(NOT margins_of_position-force STREQUAL margins_of_soft-limit)
  message(FATAL_ERROR "soft-limit at rest is not position-force:\n${output}")
endif()
execute_process(COMMAND ${my_tactus} stability map ${SCRATCH}/prefix/share/tactus/experiments/stability-map.toml
                        --vary control.force_gain=1,2 --set control.architecture=soft-limit
                RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE refusal)
if(NOT status EQUAL 2 OR NOT refusal MATCHES "control.architecture: asks for something that the loop of a map")
  message(FATAL_ERROR "a map of soft-limit ended with ${status}:\n${refusal}")
endif()

# A loop of a user's own around cancellation alone.
build_against_the_package(${SOURCE}/examples/cancellation-loop ${SCRATCH}/loop)
run(${SCRATCH}/loop/cancellation-loop)
if(NOT output MATCHES "moved the motor by up to ([0-9]+) um, .* by up to ([0-9]+) um")
  message(FATAL_ERROR "the loop around cancellation says something else:\n${output}")
endif()
math(EXPR left "3 * ${CMAKE_MATCH_2}")
if(left GREATER CMAKE_MATCH_1)
  message(FATAL_ERROR "cancellation took away less than two thirds:\n${output}")
endif()

# A device of a user's own is driven by supervised sites over the network.
build_against_the_package(${SOURCE}/examples/own-device ${SCRATCH}/device)
run(sh ${CMAKE_CURRENT_LIST_DIR}/own_device.sh ${SCRATCH}/device/my-device ${experiment} ${SCRATCH}/device-run)

# A driver of a user's own for an arm, loaded as a plug-in: it is checked and driven, and its failures end in hold with the
# reason.
build_against_the_package(${SOURCE}/examples/own-arm ${SCRATCH}/arm)
run(sh ${CMAKE_CURRENT_LIST_DIR}/own_arm.sh ${SCRATCH}/prefix/bin/tactus ${SCRATCH}/arm/own-arm.so ${SOURCE}/examples
    ${SCRATCH}/arm-run)

# Devices of three joints at the real clock, one of them felt half as strongly.
build_against_the_package(${SOURCE}/examples/several-joints ${SCRATCH}/joints)
run(${SCRATCH}/joints/several-joints ${SCRATCH}/joints-run)
if(NOT output MATCHES "felt: ([0-9.]+), ([0-9.]+) and ([0-9.]+) N" OR NOT CMAKE_MATCH_1 GREATER 0.1
   OR NOT CMAKE_MATCH_1 STREQUAL CMAKE_MATCH_2 OR NOT CMAKE_MATCH_3 LESS CMAKE_MATCH_1)
  message(FATAL_ERROR "three joints felt something else:\n${output}")
endif()
run(${my_tactus} export ${SCRATCH}/joints-run --topic /master/joint_2 --to csv --out ${SCRATCH}/joints.csv)

# An experiment of a user's own is a kind like those of the library: its keys load, vary, are refused by name and stand in
# schema and reference. A faster servo renders a stiffer wall (J. E. Colgate and G. Schenkel, Journal of Robotic Systems
# 14(1), 1997: K < 2 (b - B)/T).
build_against_the_package(${SOURCE}/examples/own-experiment ${SCRATCH}/experiment)
set(my_experiment ${SCRATCH}/experiment/my-experiment)
set(wall ${SOURCE}/examples/own-experiment/virtual-wall.toml)
run(${my_experiment} run ${wall} --json --vary servo.rate_Hz=1000,5000 --set task.observation_s=0.3)
foreach(index RANGE 1)
  string(JSON limit_${index} GET "${output}" runs ${index} metrics stiffness_limit_N_per_m)
endforeach()
if(NOT limit_1 GREATER limit_0 OR NOT limit_0 GREATER 0)
  message(FATAL_ERROR "a servo of 5 kHz does not render a stiffer wall than one of 1 kHz:\n${output}")
endif()
run(${my_experiment} run ${wall} --out ${SCRATCH}/wall --set task.observation_s=0.3)
if(NOT EXISTS ${SCRATCH}/wall/report.html OR NOT EXISTS ${SCRATCH}/wall/figure-1.svg)
  message(FATAL_ERROR "the experiment of one's own leaves no report")
endif()
run(${my_experiment} schema virtual-wall)
string(JSON least GET "${output}" properties task properties press_m minimum)
run(${my_experiment} schema virtual-wall --reference)
if(NOT output MATCHES "`softest_N_per_m` . N/m")
  message(FATAL_ERROR "the reference lacks a key of the experiment:\n${output}")
endif()
execute_process(COMMAND ${my_experiment} run ${wall} --vary task.press_m=0.01,3
                RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE refusal)
if(NOT status EQUAL 2 OR NOT refusal MATCHES "^my-experiment: --vary task.press_m=3: task.press_m: ")
  message(FATAL_ERROR "a value out of bounds ended with ${status}:\n${refusal}")
endif()
execute_process(COMMAND ${my_experiment} run ${wall} --set task.kind=virtual-wal
                RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE refusal)
if(NOT status EQUAL 2 OR NOT refusal MATCHES "write one of tapping, .*, virtual-wall")
  message(FATAL_ERROR "an unknown kind ended with ${status} and did not list the one of the example:\n${refusal}")
endif()
