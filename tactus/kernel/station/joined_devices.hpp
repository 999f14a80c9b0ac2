// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/station/device.hpp>

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace tactus::station {

/// Devices of one axis as the joints of one device: motors that have nothing in common but the hand, or the tool, that
/// they move. They are read and written in order. Real-time safe as far as they are.
class JoinedDevices final : public JointDevice {
 public:
  /// Errors: `out_of_bounds` for none of them, or for more than `most_joints`.
  static Result<std::unique_ptr<JoinedDevices>> make(std::vector<std::unique_ptr<Device>> joints) {
    if (joints.empty() || joints.size() > most_joints) {
      return out_of_bounds("joints", static_cast<double>(joints.size()), between(1.0, most_joints), units::none);
    }
    return std::unique_ptr<JoinedDevices>(new JoinedDevices(std::move(joints)));
  }

  [[nodiscard]] Joints<DeviceLimits> limits() const override {
    Joints<DeviceLimits> limits(joints_.size());
    for (std::size_t joint = 0; joint < joints_.size(); ++joint) limits[joint] = joints_[joint]->limits();
    return limits;
  }
  /// Where all of them are.
  [[nodiscard]] bool simulated() const noexcept override {
    bool all = true;
    for (const auto& joint : joints_) all = all && joint->simulated();
    return all;
  }
  Joints<DeviceReading> read(const Tick& tick) noexcept override {
    Joints<DeviceReading> reading(joints_.size());
    for (std::size_t joint = 0; joint < joints_.size(); ++joint) reading[joint] = joints_[joint]->read(tick);
    return reading;
  }
  void write(const Joints<DeviceCommand>& command) noexcept override {
    for (std::size_t joint = 0; joint < joints_.size(); ++joint) joints_[joint]->write(command[joint]);
  }
  /// Of the one that is worst.
  [[nodiscard]] DeviceHealth health() const noexcept override {
    DeviceHealth worst = DeviceHealth::good;
    for (const auto& joint : joints_) worst = worse(worst, joint->health());
    return worst;
  }

 private:
  explicit JoinedDevices(std::vector<std::unique_ptr<Device>> joints) : joints_(std::move(joints)) {}
  static DeviceHealth worse(DeviceHealth one, DeviceHealth other) noexcept { return one > other ? one : other; }

  std::vector<std::unique_ptr<Device>> joints_;
};

}  // namespace tactus::station
