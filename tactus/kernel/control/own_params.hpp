// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/binding.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <memory>
#include <string_view>
#include <typeinfo>
#include <utility>
#include <vector>

/// The parameters that an architecture has of its own, of a type that nobody else knows.
namespace tactus::control {

/// A parameter struct, its type erased.
class OwnGroup {
 public:
  virtual ~OwnGroup() = default;
  [[nodiscard]] virtual std::unique_ptr<OwnGroup> clone() const = 0;
  /// Adds its keys, below `section`. They point into this object.
  virtual void append_to(std::vector<Binding>& bindings, std::string_view section) = 0;
  [[nodiscard]] virtual Check check() const = 0;
};

template <Described T>
class OwnGroupOf final : public OwnGroup {
 public:
  [[nodiscard]] std::unique_ptr<OwnGroup> clone() const override { return std::make_unique<OwnGroupOf>(*this); }
  void append_to(std::vector<Binding>& bindings, std::string_view section) override {
    append_bindings(params, section, bindings);
  }
  [[nodiscard]] Check check() const override { return validate(params); }
  T params{};
};

/// The group of keys that an architecture adds to `[control]`; none where `make` is null.
struct OwnKeys {
  const char* group = "";  ///< its name in a file, with underscores
  const char* doc = "";
  const std::type_info* type = nullptr;
  std::unique_ptr<OwnGroup> (*make)() = nullptr;
};

/// The group `group` with the keys and defaults of `T`. Both texts must outlive the program's use of them.
template <Described T>
OwnKeys own_keys(const char* group, const char* doc) {
  return {.group = group, .doc = doc, .type = &typeid(OwnGroupOf<T>), .make = []() -> std::unique_ptr<OwnGroup> {
            return std::make_unique<OwnGroupOf<T>>();
          }};
}

/// The groups of all registered architectures, each once, in the order of their registration.
std::vector<OwnKeys> registered_keys();

/// What a file or a program states about the groups of all registered architectures. A value: a copy is independent.
/// What nobody has set has its defaults. Cold.
class OwnParams {
 public:
  OwnParams() = default;
  OwnParams(const OwnParams& other) {
    for (const auto& group : other.groups_) groups_.push_back(group->clone());
  }
  OwnParams(OwnParams&&) noexcept = default;
  OwnParams& operator=(OwnParams other) noexcept {
    groups_ = std::move(other.groups_);
    return *this;
  }
  ~OwnParams() = default;

  template <Described T>
  [[nodiscard]] const T& of() const {
    if (const auto* held = find(typeid(OwnGroupOf<T>))) return static_cast<const OwnGroupOf<T>*>(held)->params;
    static const T defaults{};
    return defaults;
  }
  template <Described T>
  [[nodiscard]] T& of() {
    OwnGroup& held = find_or_make(own_keys<T>("", ""));
    return static_cast<OwnGroupOf<T>&>(held).params;
  }

  /// Adds the keys of every registered architecture, below `section`. They point into this object.
  void append_to(std::vector<Binding>& bindings, std::string_view section);
  /// Whether all that was set lies within its bounds.
  [[nodiscard]] Check check() const;

 private:
  [[nodiscard]] const OwnGroup* find(const std::type_info& type) const;
  [[nodiscard]] OwnGroup& find_or_make(const OwnKeys& keys);

  std::vector<std::unique_ptr<OwnGroup>> groups_;
};

}  // namespace tactus::control
