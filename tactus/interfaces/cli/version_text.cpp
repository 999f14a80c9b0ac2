// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/version_text.hpp>
#include <tactus/kernel/core/version.hpp>

namespace tactus::cli {

std::string version_text() {
#if defined(__clang__)
  const std::string compiler = "clang " __clang_version__;
#elif defined(__GNUC__)
  const std::string compiler = "g++ " __VERSION__;
#else
  const std::string compiler = "another compiler";
#endif
#ifdef NDEBUG
  const std::string assertions = "off";
#else
  const std::string assertions = "on";
#endif
  const std::string sanitizers = TACTUS_SANITIZERS;
  return "tactus " + std::string(version()) + "\ncompiler: " + compiler + "\nbuild: " TACTUS_BUILD_TYPE +
         "\nassertions: " + assertions + "\nsanitizers: " + (sanitizers.empty() ? "none" : sanitizers);
}

}  // namespace tactus::cli
