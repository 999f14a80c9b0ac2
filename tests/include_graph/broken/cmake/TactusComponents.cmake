# SPDX-License-Identifier: Apache-2.0
# Components of the folder `broken`, with the rules of the real ones.
include(${CMAKE_CURRENT_LIST_DIR}/../../../../cmake/TactusComponents.cmake)

set(TACTUS_ALL_COMPONENTS kernel data simulation hardware interfaces)
set(TACTUS_COMPONENT_kernel core signal control)
set(TACTUS_COMPONENT_data recording)
set(TACTUS_COMPONENT_simulation arm_plants)
set(TACTUS_COMPONENT_hardware devices)
set(TACTUS_COMPONENT_interfaces cli)
set(TACTUS_COMPONENT_data_NEEDS kernel)
set(TACTUS_COMPONENT_simulation_NEEDS data)
set(TACTUS_COMPONENT_hardware_NEEDS data)
set(TACTUS_COMPONENT_interfaces_NEEDS simulation hardware)
