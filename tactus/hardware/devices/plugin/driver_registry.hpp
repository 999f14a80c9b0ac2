// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/plugin/blocking_driver.hpp>
#include <tactus/kernel/core/binding.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::devices {

/// What a rig file states of one side whose bus is a registered driver, apart from the driver's own keys.
struct DriverRequest {
  std::string port;                  ///< as written, for instance a path or HOST:PORT; empty if it is not written
  std::vector<std::int64_t> motors;  ///< the key `motor` of each joint, in the order of the joints
};

/// The driver's own keys of one side (`[arm.leader]`), and the driver that they make.
class DriverSettings {
 public:
  virtual ~DriverSettings() = default;
  virtual void append_to(std::vector<Binding>& bindings, std::string_view section) = 0;
  /// Nothing is opened. Errors: what the driver refuses.
  [[nodiscard]] virtual Result<std::unique_ptr<BlockingDriver>> make(const DriverRequest& request) const = 0;
};

/// A driver that a rig file can name: `bus = "NAME"`.
struct DriverKind {
  std::string name;
  std::string summary;  ///< one line
  std::function<std::unique_ptr<DriverSettings>()> settings;
};

/// All that are registered.
std::span<const DriverKind> driver_kinds();
/// Null if no driver of this name is registered.
const DriverKind* find_driver(std::string_view name);
/// Adds a driver, or replaces that of the same name. Call it before the command runs, from one thread. Errors: `name`
/// is empty or that of a built-in bus.
Check add_driver(DriverKind kind);

/// A driver with described keys of its own: `Params`, and `make`, which opens nothing.
template <class Driver>
concept PluggableDriver = std::derived_from<Driver, BlockingDriver> && Described<typename Driver::Params> &&
    requires(const typename Driver::Params& params, const DriverRequest& request) {
  { Driver::make(params, request) } -> std::same_as<Result<std::unique_ptr<BlockingDriver>>>;
};

/// Adds the driver to those that a rig file can name. Its keys are under `[PAIR.leader]` or `[PAIR.follower]`,
/// alongside `bus`, `port` and `watchdog_s`; they are loaded, checked against their bounds and reported with their line
/// as all keys.
template <PluggableDriver Driver>
Check register_driver(std::string name, std::string summary) {
  class Settings final : public DriverSettings {
   public:
    void append_to(std::vector<Binding>& bindings, std::string_view section) override {
      append_bindings(params_, section, bindings);
    }
    [[nodiscard]] Result<std::unique_ptr<BlockingDriver>> make(const DriverRequest& request) const override {
      return Driver::make(params_, request);
    }

   private:
    typename Driver::Params params_;
  };
  return add_driver({std::move(name), std::move(summary), [] { return std::make_unique<Settings>(); }});
}

}  // namespace tactus::devices
