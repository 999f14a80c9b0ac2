// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>
#include <tactus/runtime/ros2/messages.hpp>
#include <tactus/runtime/ros2/names.hpp>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tactus::ros2 {

/// Sends messages on one topic: reliable, volatile, the last ten kept, as ROS 2 does by default. Belongs to its
/// participant and is good as long as that. One thread at a time. Not real-time safe.
template <class Message>
class Writer {
 public:
  /// Errors: `failed` where the message could not be handed over, as when a reliable reader is at rest. A text in it
  /// ends at its first zero byte.
  Check write(const Message& message);
  /// Readers that are matched at the moment.
  [[nodiscard]] std::size_t readers() const;

 private:
  friend class Participant;
  explicit Writer(std::int32_t handle) : handle_(handle) {}
  std::int32_t handle_;
};

/// Receives messages of one topic: best effort, volatile, the last ten kept. Belongs to its participant and is good as
/// long as that. One thread at a time. Not real-time safe.
///
/// What comes from the network is checked before it is a message: bytes that are no message of the type are dropped,
/// and so is one of more than 64 KiB.
template <class Message>
class Reader {
 public:
  /// What has arrived since the last call, oldest first, the last ten of it.
  std::vector<Message> take();
  /// Until something has arrived, `longest` at most.
  void wait(Seconds longest) const;
  /// Writers that are matched at the moment.
  [[nodiscard]] std::size_t writers() const;

 private:
  friend class Participant;
  explicit Reader(std::int32_t handle, std::int32_t waitset) : handle_(handle), waitset_(waitset) {}
  std::int32_t handle_;
  std::int32_t waitset_;
};

/// This process among the programs of a DDS domain. It has threads of its own.
class Participant {
 public:
  /// Joins the domain. Errors: `failed` where the network does not do it, and for a second participant of the process
  /// in the same domain.
  static Result<Participant> create(const Network& network);
  Participant(Participant&& other) noexcept : domain_(std::exchange(other.domain_, 0)), handle_(other.handle_) {}
  Participant& operator=(Participant&&) = delete;
  ~Participant();  ///< leaves the domain; its writers and readers end

  /// Messages are `JointState`, `WrenchStamped` and `Text`; `topic` is the name that `dds_topic` makes. Errors:
  /// `failed`.
  template <class Message>
  Result<Writer<Message>> writer(const std::string& topic);
  template <class Message>
  Result<Reader<Message>> reader(const std::string& topic);

 private:
  Participant(std::int32_t domain, std::int32_t handle) : domain_(domain), handle_(handle) {}
  std::int32_t domain_;
  std::int32_t handle_;
};

}  // namespace tactus::ros2
