// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// What a live view shows and lets a visitor do, apart from how it reaches the visitor.
namespace tactus::live {

/// A stream of messages that clients can subscribe to: CDR of a `ros2msg` definition.
struct Topic {
  std::string name;       ///< `/left/state`
  std::string type_name;  ///< `tactus_msgs/msg/LiveState`
  std::string definition;
};

/// A value that a client can see and perhaps change.
using ParameterValue = std::variant<double, bool, std::string>;

struct Parameter {
  std::string name;
  ParameterValue value;
};

enum class StatusLevel { info = 0, warning = 1, error = 2 };

/// Something that an operator at a client should read.
struct Status {
  StatusLevel level = StatusLevel::info;
  std::string message;
};

/// A client, for as long as it is connected. Each number is used once.
using ClientId = std::uint64_t;

/// The bytes of one message, shared by all who wait to send it.
using Payload = std::shared_ptr<const std::string>;

/// Takes what an application has to show, in the order of time for each topic.
using Publish = std::function<void(std::size_t topic, std::uint64_t time_ns, const Payload& payload)>;

/// What is behind a `Server`. The server's thread is the only one that calls it, after `Server::start`; nothing in
/// it may wait.
class Application {
 public:
  Application() = default;
  Application(const Application&) = delete;
  Application& operator=(const Application&) = delete;
  virtual ~Application() = default;

  /// What there is to see. Fixed for the life of the application.
  [[nodiscard]] virtual const std::vector<Topic>& topics() const = 0;
  /// What a client receives about the server before all else.
  [[nodiscard]] virtual std::map<std::string, std::string> metadata() const = 0;
  /// All parameters as they are now.
  [[nodiscard]] virtual std::vector<Parameter> parameters() const = 0;
  /// Changes parameters, in this order. What is refused keeps its value; the answer states why.
  virtual std::vector<Status> set_parameters(const std::vector<Parameter>& wanted) = 0;
  /// A message that a client published: what it declared about topic and encoding, and the bytes. All of it may be
  /// nonsense.
  virtual std::optional<Status> receive(ClientId client, std::string_view topic, std::string_view encoding,
                                        std::string_view bytes) = 0;
  /// The client is gone.
  virtual void leave(ClientId client) = 0;
  /// The last client is gone.
  virtual void stand_alone() = 0;
  /// Called every few milliseconds: hands over what is new, a bounded number of messages at once whatever continues
  /// meanwhile, for nobody is answered until it returns. `is_wanted(topic)` reports whether anyone would get it.
  virtual void collect(const std::function<bool(std::size_t topic)>& is_wanted, const Publish& publish) = 0;
};

}  // namespace tactus::live
