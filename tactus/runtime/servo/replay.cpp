// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/replay_rows.hpp>

namespace tactus::runtime {

std::string about(const telemetry::LogContent& content, const std::string& name, const std::string& key) {
  const auto found = content.summary.metadata.find(name);
  if (found == content.summary.metadata.end()) return {};
  const auto value = found->second.find(key);
  return value == found->second.end() ? std::string() : value->second;
}

}  // namespace tactus::runtime
