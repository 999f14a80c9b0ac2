// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/runtime/ros2/messages.hpp>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

/// A program of another vendor on the same network: Fast DDS, which most ROS 2 nodes speak through. Shares no code with
/// tactus: its bytes are made and read by Fast CDR.
namespace tactus::ros2::test {

using Bytes = std::vector<unsigned char>;

Bytes to_fast_cdr(const JointState& message);
/// These throw where the bytes are no such message.
JointState joint_state_of(const Bytes& bytes);
WrenchStamped wrench_of(const Bytes& bytes);
Text text_of(const Bytes& bytes);

/// What the other side announces about a writer or a reader of its own.
struct Announcement {
  std::string type;
  std::string user_data;
  bool reliable = false;
  bool is_volatile = false;
  bool writes = false;
};

class FastDdsPeer {
 public:
  /// On loopback only.
  explicit FastDdsPeer(std::uint32_t domain);
  FastDdsPeer(const FastDdsPeer&) = delete;
  FastDdsPeer& operator=(const FastDdsPeer&) = delete;
  ~FastDdsPeer();

  /// `type` as ROS 2 mangles it: `sensor_msgs::msg::dds_::JointState_`.
  void subscribe(const std::string& topic, const std::string& type);
  void advertise(const std::string& topic, const std::string& type);
  /// All that has come so far, header included.
  std::vector<Bytes> received(const std::string& topic);
  /// Readers of the other side that match what is advertised here.
  [[nodiscard]] int readers(const std::string& topic);
  void publish(const std::string& topic, const Bytes& bytes);

  /// By topic, those of this test's namespace.
  std::map<std::string, Announcement> announced();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Waits until `condition` holds; false after a few seconds.
template <class Condition>
bool eventually(Condition&& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace tactus::ros2::test
