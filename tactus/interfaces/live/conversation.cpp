// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/conversation.hpp>
#include <tactus/kernel/core/version.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

namespace tactus::live {

namespace {

using Json = nlohmann::json;

constexpr unsigned char client_message_opcode = 1;
constexpr unsigned char server_message_opcode = 1;
constexpr std::size_t deepest_nesting = 16;

std::string little_endian(std::uint64_t value, std::size_t bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes; ++i) text += static_cast<char>(static_cast<unsigned char>(value >> (8 * i)));
  return text;
}

/// Text as JSON or nothing. What is nested deeper than any request is refused before anything is built from it.
std::optional<Json> parsed(std::string_view text) {
  bool too_deep = false;
  Json value = Json::parse(
      text,
      [&too_deep](int depth, Json::parse_event_t, Json&) {
        too_deep = too_deep || depth > static_cast<int>(deepest_nesting);
        return !too_deep;
      },
      false);
  if (too_deep || value.is_discarded() || !value.is_object()) return std::nullopt;
  return value;
}

std::string shortened(std::string_view text) {
  constexpr std::size_t most = 80;
  return std::string(text.substr(0, most)) + (text.size() > most ? "..." : "");
}

std::optional<std::uint32_t> id_of(const Json& value) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
    return std::nullopt;
  }
  return value.get<std::uint32_t>();
}

std::optional<std::uint32_t> id_in(const Json& object, const char* key) {
  if (!object.is_object()) return std::nullopt;
  const auto found = object.find(key);
  return found == object.end() ? std::nullopt : id_of(*found);
}

std::optional<std::string> text_in(const Json& object, const char* key) {
  if (!object.is_object()) return std::nullopt;
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string()) return std::nullopt;
  return found->get<std::string>();
}

std::optional<ParameterValue> value_of(const Json& value) {
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_number()) return value.get<double>();
  if (value.is_string()) return value.get<std::string>();
  return std::nullopt;
}

Json to_json(const std::vector<Parameter>& parameters) {
  Json list = Json::array();
  for (const Parameter& parameter : parameters) {
    Json item{{"name", parameter.name}};
    std::visit([&item](const auto& value) { item["value"] = value; }, parameter.value);
    // A whole number must still arrive as a floating-point one.
    if (std::holds_alternative<double>(parameter.value)) item["type"] = "float64";
    list.push_back(std::move(item));
  }
  return list;
}

/// What a client sent may hold bytes that are no UTF-8; an answer never does.
std::string dumped(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

struct Conversation::Request {
  Json content;
  /// A list by its key; an empty one where there is none.
  [[nodiscard]] const Json& list(const char* key) const {
    static const Json none = Json::array();
    const auto found = content.find(key);
    return found != content.end() && found->is_array() ? *found : none;
  }
};

Conversation::Conversation(ClientId client, Application& application, const ConversationLimits& limits)
    : client_(client), application_(application), limits_(limits), outbox_(limits.outbox) {
  send({.head = dumped({{"op", "serverInfo"},
                        {"name", "tactus " + std::string(version())},
                        {"capabilities", {"parameters", "parametersSubscribe", "clientPublish"}},
                        {"supportedEncodings", {"cdr", "json"}},
                        {"metadata", application_.metadata()}})});
  Json channels = Json::array();
  const std::vector<Topic>& topics = application_.topics();
  for (std::size_t i = 0; i < topics.size(); ++i) {
    channels.push_back({{"id", i + 1},
                        {"topic", topics[i].name},
                        {"encoding", "cdr"},
                        {"schemaName", topics[i].type_name},
                        {"schema", topics[i].definition},
                        {"schemaEncoding", "ros2msg"}});
  }
  send({.head = dumped({{"op", "advertise"}, {"channels", std::move(channels)}})});
}

void Conversation::send(Frame frame) { hopeless_ = !outbox_.push(std::move(frame)) || hopeless_; }

void Conversation::say(const Status& status, const std::string& id) {
  Json message{{"op", "status"}, {"level", static_cast<int>(status.level)}, {"message", status.message}};
  if (!id.empty()) message["id"] = id;
  send({.head = dumped(message)});
}

bool Conversation::take_text(std::string_view text) {
  std::optional<Json> content = parsed(text);
  if (!content) {
    say({StatusLevel::error, "a text message is not a JSON object: '" + shortened(text) + "'"});
    return false;
  }
  const std::string op = text_in(*content, "op").value_or("");
  const Request request{*std::move(content)};
  if (op == "setParameters") return set_parameters(request);
  if (op == "subscribe") {
    subscribe(request);
  } else if (op == "unsubscribe") {
    unsubscribe(request);
  } else if (op == "advertise") {
    advertise(request);
  } else if (op == "unadvertise") {
    unadvertise(request);
  } else if (op == "getParameters") {
    answer_parameters(request);
  } else if (op == "subscribeParameterUpdates" || op == "unsubscribeParameterUpdates") {
    watch_parameters(request, op == "subscribeParameterUpdates");
  } else {
    say({StatusLevel::error, "operation '" + shortened(op) + "' is unknown here"});
  }
  return false;
}

void Conversation::take_binary(std::string_view bytes) {
  constexpr std::size_t head_bytes = 5;
  if (bytes.size() < head_bytes || static_cast<unsigned char>(bytes[0]) != client_message_opcode) {
    say({StatusLevel::error, "a binary message does not begin as a client's message does"});
    return;
  }
  std::uint32_t channel = 0;
  for (std::size_t i = 0; i < 4; ++i) channel |= std::uint32_t{static_cast<unsigned char>(bytes[1 + i])} << (8 * i);
  const auto found = advertised_.find(channel);
  if (found == advertised_.end()) {
    say({StatusLevel::error, "channel " + std::to_string(channel) + " was not advertised by this client"});
    return;
  }
  const auto status =
      application_.receive(client_, found->second.topic, found->second.encoding, bytes.substr(head_bytes));
  if (status) say(*status);
}

void Conversation::show(std::size_t topic, std::uint64_t time_ns, const Payload& payload) {
  const auto found = subscriptions_.find(topic);
  if (found == subscriptions_.end()) return;
  const std::vector<std::uint32_t>& all = found->second;
  const std::size_t cost = frame_cost + payload->size();
  const std::size_t fit = std::min(all.size(), room_ / cost);
  room_ -= fit * cost;
  outbox_.lose(all.size() - fit);
  for (std::size_t i = 0; i < fit; ++i) {
    send({.binary = true,
          .may_be_dropped = true,
          .head = little_endian(server_message_opcode, 1) + little_endian(all[i], 4) + little_endian(time_ns, 8),
          .payload = payload});
  }
}

void Conversation::tell_parameters(const std::vector<Parameter>& all) {
  std::vector<Parameter> told;
  for (const Parameter& parameter : all) {
    if (watches_all_ || watched_.contains(parameter.name)) told.push_back(parameter);
  }
  if (!told.empty()) send({.head = dumped({{"op", "parameterValues"}, {"parameters", to_json(told)}})});
}

void Conversation::tell_losses() {
  const std::uint64_t lost = outbox_.dropped();
  if (lost == told_losses_) return;
  told_losses_ = lost;
  say({StatusLevel::warning, "this client is too slow: " + std::to_string(lost) + " messages to it were dropped"},
      "tactus.dropped");
}

void Conversation::subscribe(const Request& request) {
  for (const Json& item : request.list("subscriptions")) {
    const auto id = id_in(item, "id");
    const auto channel = id_in(item, "channelId");
    if (!id || !channel || *channel < 1 || *channel > application_.topics().size()) {
      say({StatusLevel::error, "a subscription needs an id and the channelId of an advertised channel"});
      return;
    }
    if (topic_of_.contains(*id)) {
      say({StatusLevel::error, "subscription " + std::to_string(*id) + " exists already"});
      return;
    }
    if (topic_of_.size() == limits_.subscriptions) {
      say({StatusLevel::error, "subscription " + std::to_string(*id) +
                                   " and those after it are refused: a client has " + "no more than " +
                                   std::to_string(limits_.subscriptions) +
                                   " subscriptions; end one first, or show a topic more often from one"});
      return;
    }
    topic_of_[*id] = *channel - 1;
    subscriptions_[*channel - 1].push_back(*id);
  }
}

void Conversation::unsubscribe(const Request& request) {
  for (const Json& item : request.list("subscriptionIds")) {
    const auto id = id_of(item);
    const auto found = id ? topic_of_.find(*id) : topic_of_.end();
    if (found == topic_of_.end()) {
      say({StatusLevel::warning, "there is no such subscription to end"});
      return;
    }
    const auto of_topic = subscriptions_.find(found->second);
    std::erase(of_topic->second, *id);
    if (of_topic->second.empty()) subscriptions_.erase(of_topic);
    topic_of_.erase(found);
  }
}

void Conversation::advertise(const Request& request) {
  for (const Json& item : request.list("channels")) {
    const auto id = id_in(item, "id");
    const auto topic = text_in(item, "topic");
    const auto encoding = text_in(item, "encoding");
    if (!id || !topic || !encoding) {
      say({StatusLevel::error, "an advertised channel needs an id, a topic and an encoding"});
      return;
    }
    if (!advertised_.contains(*id) && advertised_.size() == limits_.advertisements) {
      say({StatusLevel::error, "no more than " + std::to_string(limits_.advertisements) + " channels from a client"});
      return;
    }
    advertised_[*id] = {.topic = *topic, .encoding = *encoding};
  }
}

void Conversation::unadvertise(const Request& request) {
  for (const Json& item : request.list("channelIds")) {
    const auto id = id_of(item);
    if (!id || advertised_.erase(*id) == 0) {
      say({StatusLevel::warning, "there is no such channel of this client to withdraw"});
      return;
    }
  }
}

void Conversation::answer_parameters(const Request& request) {
  std::set<std::string> names;
  for (const Json& item : request.list("parameterNames")) {
    if (item.is_string()) names.insert(item.get<std::string>());
  }
  std::vector<Parameter> told = application_.parameters();
  if (!names.empty()) {
    std::erase_if(told, [&names](const Parameter& parameter) { return !names.contains(parameter.name); });
  }
  Json answer{{"op", "parameterValues"}, {"parameters", to_json(told)}};
  if (const auto id = text_in(request.content, "id")) answer["id"] = *id;
  send({.head = dumped(answer)});
}

bool Conversation::set_parameters(const Request& request) {
  std::vector<Parameter> wanted;
  std::set<std::string> named;
  for (const Json& item : request.list("parameters")) {
    if (wanted.size() == limits_.names) break;
    const auto name = text_in(item, "name");
    const auto value = name && item.contains("value") ? value_of(item["value"]) : std::nullopt;
    if (!value) {
      say({StatusLevel::error, "a parameter to set needs a name and a value that is a number, a flag or a text"});
      continue;
    }
    wanted.push_back({*name, *value});
    named.insert(*name);
  }
  if (wanted.empty()) return false;
  for (const Status& status : application_.set_parameters(wanted)) say(status);

  // The one who asked is told what holds now, whether that is what it wanted or not.
  std::vector<Parameter> told = application_.parameters();
  std::erase_if(told, [&named](const Parameter& parameter) { return !named.contains(parameter.name); });
  Json answer{{"op", "parameterValues"}, {"parameters", to_json(told)}};
  if (const auto id = text_in(request.content, "id")) answer["id"] = *id;
  send({.head = dumped(answer)});
  return true;
}

void Conversation::watch_parameters(const Request& request, bool watch) {
  const Json& names = request.list("parameterNames");
  // The protocol: no name means all of them.
  if (names.empty()) {
    watches_all_ = watch;
    if (!watch) watched_.clear();
    return;
  }
  for (const Json& item : names) {
    if (!item.is_string()) continue;
    if (!watch) {
      watched_.erase(item.get<std::string>());
    } else if (watched_.size() < limits_.names) {
      watched_.insert(item.get<std::string>());
    }
  }
}

}  // namespace tactus::live
