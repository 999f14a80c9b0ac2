// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/own_params.hpp>

#include <string>

namespace tactus::control {

void OwnParams::append_to(std::vector<Binding>& bindings, std::string_view section) {
  for (const OwnKeys& keys : registered_keys()) {
    const std::string path = join(section, keys.group);
    bindings.push_back({path, units::none, any_finite, keys.doc, Section{}});
    find_or_make(keys).append_to(bindings, path);
  }
}

Check OwnParams::check() const {
  for (const OwnKeys& keys : registered_keys()) {
    const OwnGroup* held = find(*keys.type);
    if (held == nullptr) continue;
    if (auto error = held->check()) return under(keys.group, *std::move(error));
  }
  return {};
}

const OwnGroup* OwnParams::find(const std::type_info& type) const {
  for (const auto& group : groups_) {
    const OwnGroup& held = *group;
    if (typeid(held) == type) return &held;
  }
  return nullptr;
}

OwnGroup& OwnParams::find_or_make(const OwnKeys& keys) {
  for (const auto& group : groups_) {
    OwnGroup& held = *group;
    if (typeid(held) == *keys.type) return held;
  }
  return *groups_.emplace_back(keys.make());
}

}  // namespace tactus::control
