// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/live/application.hpp>
#include <tactus/interfaces/live/outbox.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tactus::live {

/// The names under which the protocol is offered; a client asks for one of them.
inline constexpr std::string_view subprotocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

/// How much one client may ask for.
struct ConversationLimits {
  std::size_t subscriptions = 32;  ///< three times as many as there are topics
  std::size_t advertisements = 16;
  std::size_t names = 64;  ///< parameters named in one request
  Outbox::Limits outbox;
};

/// The Foxglove WebSocket protocol with one client, without the network: what comes in, and frames that go out.
/// https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md, version 1.
///
/// Every input is survived: what makes no sense is answered with a status, and nothing grows beyond the limits.
class Conversation {
 public:
  /// What a frame costs alongside its bytes: about the time in which as many are copied.
  static constexpr std::size_t frame_cost = 64;

  /// Greets the client: server information and topics.
  Conversation(ClientId client, Application& application, const ConversationLimits& limits);

  /// A text frame. True where parameters may have changed: everyone who asked for that must be informed.
  [[nodiscard]] bool take_text(std::string_view text);
  void take_binary(std::string_view bytes);

  /// What all messages shown until the next turn may cost together, in bytes, `frame_cost` for each on top of its own.
  /// What is beyond is lost and counted, at no cost. As much as there is until it is called first.
  void begin_turn(std::size_t bytes) { room_ = bytes; }
  /// Sends a message to each subscription of its topic, while there is room in the turn.
  void show(std::size_t topic, std::uint64_t time_ns, const Payload& payload);
  [[nodiscard]] bool wants(std::size_t topic) const { return subscriptions_.contains(topic); }
  [[nodiscard]] bool wants_anything() const { return !subscriptions_.empty(); }
  /// Sends the parameters whose changes the client asked for.
  void tell_parameters(const std::vector<Parameter>& all);
  /// Where frames were lost since it was last called: states it, once for all of them.
  void tell_losses();

  [[nodiscard]] Outbox& outbox() { return outbox_; }
  /// The client asks without reading the answers; nothing but closing helps.
  [[nodiscard]] bool is_hopeless() const { return hopeless_; }

 private:
  struct Advertised {
    std::string topic;
    std::string encoding;
  };
  struct Request;

  void send(Frame frame);
  void say(const Status& status, const std::string& id = {});
  void subscribe(const Request& request);
  void unsubscribe(const Request& request);
  void advertise(const Request& request);
  void unadvertise(const Request& request);
  void answer_parameters(const Request& request);
  bool set_parameters(const Request& request);
  void watch_parameters(const Request& request, bool watch);

  ClientId client_;
  Application& application_;
  ConversationLimits limits_;
  Outbox outbox_;
  std::map<std::size_t, std::vector<std::uint32_t>> subscriptions_;  ///< by topic
  std::map<std::uint32_t, std::size_t> topic_of_;                    ///< by subscription
  std::map<std::uint32_t, Advertised> advertised_;
  std::set<std::string> watched_;
  bool watches_all_ = false;
  std::uint64_t told_losses_ = 0;
  std::size_t room_ = std::numeric_limits<std::size_t>::max();  ///< in this turn
  bool hopeless_ = false;
};

}  // namespace tactus::live
