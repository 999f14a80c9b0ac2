# SPDX-License-Identifier: Apache-2.0
# The parts of tactus that can be left out. A component is a folder of modules, and builds on other components; it finds
# the libraries of its own modules alone. `kernel` needs Eigen and no operating system. scripts/install-deps names the
# packages of each.
#
# The order is that of the layers: a module links and includes only modules that stand before it. The include-graph test
# reads these lists.

set(TACTUS_ALL_COMPONENTS kernel data runtime hardware identification simulation analysis interfaces mpi)
# Built only if it is asked for, or its library is found.
set(TACTUS_OPTIONAL_COMPONENTS mpi)

set(TACTUS_COMPONENT_kernel core signal mechanics arm control arm_control station)
set(TACTUS_COMPONENT_data recording configuration report urdf telemetry)
set(TACTUS_COMPONENT_identification identification arm_identification diagnosis)
set(TACTUS_COMPONENT_simulation arm_plants simulation tasks experiments real_time)
set(TACTUS_COMPONENT_analysis stability arm_stability advice)
set(TACTUS_COMPONENT_runtime link runtime ros2)
set(TACTUS_COMPONENT_hardware wire emulation devices)
set(TACTUS_COMPONENT_interfaces live cli c_api)
set(TACTUS_COMPONENT_mpi ranks)

set(TACTUS_COMPONENT_kernel_NEEDS)
set(TACTUS_COMPONENT_data_NEEDS kernel)
set(TACTUS_COMPONENT_identification_NEEDS data)
set(TACTUS_COMPONENT_simulation_NEEDS identification hardware)
set(TACTUS_COMPONENT_analysis_NEEDS simulation)
set(TACTUS_COMPONENT_runtime_NEEDS data)
set(TACTUS_COMPONENT_hardware_NEEDS runtime)
set(TACTUS_COMPONENT_interfaces_NEEDS analysis)
set(TACTUS_COMPONENT_mpi_NEEDS interfaces)

# Leaves in OUT where a module is, below tactus/. Four folders have a shorter name than their module.
function(tactus_folder out module)
  set(folder_of_runtime servo)
  set(folder_of_identification axis)
  set(folder_of_arm_identification arm)
  set(folder_of_simulation teleoperator)
  foreach(component IN LISTS TACTUS_ALL_COMPONENTS)
    if(module IN_LIST TACTUS_COMPONENT_${component})
      if(DEFINED folder_of_${module})
        set(module ${folder_of_${module}})
      endif()
      set(${out} ${component}/${module} PARENT_SCOPE)
      return()
    endif()
  endforeach()
  message(FATAL_ERROR "${module} is no module of any component")
endfunction()

# Leaves in OUT the components WANTED and all on which they build, those that others build on first.
function(tactus_close_components out)
  set(closed)
  set(open ${ARGN})
  while(open)
    list(POP_FRONT open component)
    if(NOT component IN_LIST TACTUS_ALL_COMPONENTS)
      list(JOIN TACTUS_ALL_COMPONENTS ", " all)
      message(FATAL_ERROR "TACTUS_COMPONENTS names `${component}`, which is no component of tactus; the components are: ${all}")
    endif()
    list(APPEND closed ${component})
    list(APPEND open ${TACTUS_COMPONENT_${component}_NEEDS})
  endwhile()
  set(ordered)
  foreach(component IN LISTS TACTUS_ALL_COMPONENTS)
    if(component IN_LIST closed)
      list(APPEND ordered ${component})
    endif()
  endforeach()
  set(${out} ${ordered} PARENT_SCOPE)
endfunction()
