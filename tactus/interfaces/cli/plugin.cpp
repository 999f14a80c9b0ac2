// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/plugin/plugin.hpp>
#include <tactus/interfaces/cli/plugin.hpp>

#include <filesystem>

#include <dlfcn.h>

namespace tactus::cli {

Check load_plugin(const std::string& file) {
  const auto refused = [&file](ErrorCode code, std::string why) {
    return Error{.code = code, .parameter = "--plugin", .message = std::move(why), .place = file};
  };
  // Without a slash the loader would search the libraries of the system.
  std::error_code ignored;
  const auto path = std::filesystem::absolute(file, ignored);
  void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* const why = dlerror();
    return refused(ErrorCode::missing, std::string("cannot be loaded: ") + (why != nullptr ? why : "no reason given"));
  }
  const auto* const plugin = static_cast<const devices::Plugin*>(dlsym(library, "tactus_plugin"));
  if (plugin == nullptr) {
    return refused(ErrorCode::inconsistent, "is no plug-in of tactus: it must contain TACTUS_PLUGIN(function)");
  }
  if (plugin->layout != devices::plugin_layout()) {
    return refused(ErrorCode::inconsistent,
                   "was compiled against another version of tactus: compile it again against this one");
  }
  return plugin->add();
}

}  // namespace tactus::cli
