// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace tactus::tasks {

/// The version of tactus and the build of the program or library that contains it, as "0.1.0, build 1f3a…": finished
/// tasks of one build are not those of another one, whose code may differ. The build is the linker's build ID (note
/// NT_GNU_BUILD_ID of ELF); without one there is only the version. What a plug-in contains is not in it.
std::string version_and_build();

}  // namespace tactus::tasks
