// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/station/device.hpp>

#include <memory>

namespace tactus::runtime {

/// The simulated operator at a simulated master, where there is one.
class SimulatedOperator {
 public:
  virtual ~SimulatedOperator() = default;
  /// Whether the site is coupled from now on. Once a cycle, on the servo thread; real-time safe.
  virtual void follow(bool follows) noexcept = 0;

 protected:
  SimulatedOperator() = default;
  SimulatedOperator(const SimulatedOperator&) = default;
  SimulatedOperator& operator=(const SimulatedOperator&) = default;
};

/// What a site drives.
struct SiteDevice {
  std::unique_ptr<station::Device> device;
  SimulatedOperator* person = nullptr;  ///< who holds a simulated master; part of the device
};

}  // namespace tactus::runtime
