#pragma once

#include <tactus/station/device.hpp>

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace tactus::station {

/// Devices of one axis as the joints of one device: motors that have nothing in common but the hand, or the tool, that
/// they move. They are read and written in order. Real-time safe as far as they are.
class JoinedDevices final : public JointDevice {
 public:
  /// 1 to `most_joints` of them.
  explicit JoinedDevices(std::vector<std::unique_ptr<Device>> joints) : joints_(std::move(joints)) {}

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
  static DeviceHealth worse(DeviceHealth one, DeviceHealth other) noexcept { return one > other ? one : other; }

  std::vector<std::unique_ptr<Device>> joints_;
};

}  // namespace tactus::station
