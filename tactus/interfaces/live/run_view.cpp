// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/run_view.hpp>

#include <utility>

namespace tactus::live {

namespace {

/// A tenth of a second at 5 kHz, ten times what a call usually finds.
constexpr std::size_t most_records_a_call = 512;

}  // namespace

std::vector<Status> RunView::set_parameters(const std::vector<Parameter>&) {
  return {{StatusLevel::error, "a run has no parameters to set: it is observed, and continues as it was started"}};
}

std::optional<Status> RunView::receive(ClientId, std::string_view topic, std::string_view, std::string_view) {
  return Status{StatusLevel::error, std::string(topic.substr(0, 80)) +
                                        ": nobody listens: a run is observed, and commanded by its own operator"};
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
