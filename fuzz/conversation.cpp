// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/conversation.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

using namespace tactus::live;

namespace {

void demand(bool holds) {
  if (!holds) std::abort();
}

/// Two topics, and a gain between 0 and 10.
class Example final : public Application {
 public:
  [[nodiscard]] const std::vector<Topic>& topics() const override { return topics_; }
  [[nodiscard]] std::map<std::string, std::string> metadata() const override { return {{"key", "text"}}; }
  [[nodiscard]] std::vector<Parameter> parameters() const override {
    return {{"gain", gain_}, {"on", true}, {"method", std::string("none")}};
  }
  std::vector<Status> set_parameters(const std::vector<Parameter>& wanted) override {
    std::vector<Status> refused;
    for (const Parameter& parameter : wanted) {
      const auto* value = std::get_if<double>(&parameter.value);
      if (parameter.name == "gain" && value != nullptr && *value >= 0.0 && *value <= 10.0) {
        gain_ = *value;
      } else {
        refused.push_back({StatusLevel::error, parameter.name + " is refused"});
      }
    }
    return refused;
  }
  std::optional<Status> receive(ClientId, std::string_view topic, std::string_view, std::string_view bytes) override {
    demand(topic == "/operator/hand" || topic.size() <= 4096);
    if (bytes.empty()) return Status{StatusLevel::warning, "an empty message on " + std::string(topic)};
    return std::nullopt;
  }
  void leave(ClientId) override {}
  void stand_alone() override {}
  void collect(const std::function<bool(std::size_t)>&, const Publish&) override {}

 private:
  double gain_ = 1.0;
  std::vector<Topic> topics_{{"/a", "pkg/msg/A", "float64 a\n"}, {"/b", "pkg/msg/B", "float64 b\n"}};
};

/// Sends so many frames: each one is whole, and what is text is JSON with an `op`.
void send(Conversation& conversation, std::size_t most) {
  Outbox& outbox = conversation.outbox();
  for (; most > 0 && !outbox.empty(); --most) {
    const Frame& frame = outbox.begin_sending();
    if (!frame.binary) {
      const auto text = nlohmann::json::parse(frame.head, nullptr, false);
      demand(text.is_object() && text.contains("op"));
    }
    outbox.sent();
  }
}

}  // namespace

/// The input is a row of up to 16 frames with 0xff between them, which no text holds. A frame that begins with 0x01 is
/// binary. Between frames both topics have something to show, and some of what waits is sent. Nothing grows beyond its
/// limits, and every answer is well formed.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Example example;
  const ConversationLimits limits{
      .subscriptions = 8, .advertisements = 4, .names = 8, .outbox = {.frames = 32, .bytes = 8192}};
  Conversation conversation(1, example, limits);
  static const Payload payload = std::make_shared<const std::string>("0123456789abcdef");
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  for (int frames = 0; frames < 16 && !rest.empty() && !conversation.is_hopeless(); ++frames) {
    const std::string_view frame = rest.substr(0, rest.find('\xff'));
    rest.remove_prefix(std::min(rest.size(), frame.size() + 1));
    if (frame.starts_with('\x01')) {
      conversation.take_binary(frame);
    } else if (conversation.take_text(frame)) {
      conversation.tell_parameters(example.parameters());
    }
    for (const std::size_t topic : {0U, 1U}) conversation.show(topic, 1, payload);
    conversation.tell_losses();
    const Outbox& outbox = conversation.outbox();
    demand(conversation.is_hopeless() ||
           (outbox.size() <= limits.outbox.frames && outbox.bytes() <= limits.outbox.bytes));
    send(conversation, frame.size() % 5);
  }
  send(conversation, limits.outbox.frames + 1);
  return 0;
}
