// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/run_view.hpp>

#include <utility>

#include <nlohmann/json.hpp>

namespace tactus::live {

namespace {

/// A tenth of a second at 5 kHz, ten times what a call usually finds.
constexpr std::size_t most_records_a_call = 512;

constexpr const char* gain_name = "force_gain";
constexpr std::string_view request_topic = "/request";
constexpr std::size_t longest_request = 256;  ///< bytes

}  // namespace

std::vector<Parameter> RunView::parameters() const {
  const auto gain = requests_ ? requests_->force_gain() : std::nullopt;
  return gain ? std::vector<Parameter>{{gain_name, *gain}} : std::vector<Parameter>();
}

/// Asks for this and states what came of it.
Status RunView::answer(const std::string& line) const {
  if (const Check refused = requests_->ask(line)) return {StatusLevel::error, describe(*refused)};
  return {StatusLevel::info, line + ": asked for"};
}

std::vector<Status> RunView::set_parameters(const std::vector<Parameter>& wanted) {
  if (!requests_) {
    return {{StatusLevel::error, "a run has no parameters to set: it is observed, and continues as it was started"}};
  }
  std::vector<Status> answers;
  for (const Parameter& parameter : wanted) {
    const auto* const number = std::get_if<double>(&parameter.value);
    if (parameter.name != gain_name || number == nullptr) {
      answers.push_back({StatusLevel::error, "a run has one parameter to set: force_gain, a number"});
    } else {
      answers.push_back(answer("set force_gain " + format_number(*number)));
    }
  }
  return answers;
}

std::optional<Status> RunView::receive(ClientId, std::string_view topic, std::string_view encoding,
                                       std::string_view bytes) {
  if (!requests_ || topic != request_topic) {
    return Status{StatusLevel::error, std::string(topic.substr(0, 80)) +
                                          ": nobody listens: a run is observed, and commanded by its own operator"};
  }
  const auto message = encoding == "json" && bytes.size() <= longest_request
                           ? nlohmann::json::parse(bytes, nullptr, false)
                           : nlohmann::json(nlohmann::json::value_t::discarded);
  const auto data = message.is_object() ? message.find("data") : message.end();
  if (!message.is_object() || data == message.end() || !data->is_string()) {
    return Status{StatusLevel::error, R"(a request is JSON with a text, as {"data":"set force_gain 2"})"};
  }
  return answer(data->get<std::string>());
}

void RunView::collect(const std::function<bool(std::size_t topic)>& is_wanted, const Publish& publish) {
  std::uint64_t lost = 0;
  for (std::size_t topic = 0; topic < sources_.size(); ++topic) {
    const bool wanted = is_wanted(topic);
    std::uint64_t time_ns = 0;
    std::string bytes;
    // What comes while this runs waits for the next call: else a slow call would never end.
    for (std::size_t i = 0; i < most_records_a_call && sources_[topic]->next(wanted, time_ns, bytes); ++i) {
      if (wanted) publish(topic, time_ns, std::make_shared<const std::string>(std::move(bytes)));
    }
    lost += sources_[topic]->lost();
  }
  lost_.store(lost, std::memory_order_relaxed);
}

}  // namespace tactus::live
