// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/cdr.hpp>
#include <tactus/data/telemetry/recorder.hpp>
#include <tactus/interfaces/live/application.hpp>

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tactus::live {

/// What a run takes from its viewers, where its operator allows that. Called by the server's thread.
struct RunRequests {
  /// A line, as it is typed at the console. Errors: why it is refused.
  std::function<Check(const std::string& line)> ask;
  /// The force gain that was asked for last; none if it cannot change.
  std::function<std::optional<double>()> force_gain;
};

/// What a run at the real clock does, for observers: every record of its streams, under the topics of its log.
///
/// A viewer changes nothing and commands nothing, and each attempt is refused with a message; but with `RunRequests` it
/// may ask: by the parameter `force_gain`, or by a message on the topic `/request`, JSON of `std_msgs/String`
/// (`{"data":"tare"}`). A status answers.
class RunView final : public Application {
 public:
  /// `about` is what a viewer receives first.
  explicit RunView(std::map<std::string, std::string> about, std::optional<RunRequests> requests = {})
      : about_(std::move(about)), requests_(std::move(requests)) {}

  /// Shows what goes into the stream from now on. Before a server starts.
  template <Recordable Record, std::size_t Capacity>
  void add(const std::string& topic, const std::string& type_name,
           const telemetry::RecordStream<Record, Capacity>& stream) {
    topics_.push_back({topic, type_name, telemetry::ros2msg(stream.columns())});
    sources_.push_back(std::make_unique<SourceOf<Record, Capacity>>(stream));
  }
  /// Records that were overwritten before they could be shown. Any thread.
  [[nodiscard]] std::uint64_t lost_records() const { return lost_.load(std::memory_order_relaxed); }

  [[nodiscard]] const std::vector<Topic>& topics() const override { return topics_; }
  [[nodiscard]] std::map<std::string, std::string> metadata() const override { return about_; }
  [[nodiscard]] std::vector<Parameter> parameters() const override;
  std::vector<Status> set_parameters(const std::vector<Parameter>& wanted) override;
  std::optional<Status> receive(ClientId client, std::string_view topic, std::string_view encoding,
                                std::string_view bytes) override;
  void leave(ClientId) override {}
  void stand_alone() override {}
  void collect(const std::function<bool(std::size_t topic)>& is_wanted, const Publish& publish) override;

 private:
  /// A stream whose records are bytes already.
  class Source {
   public:
    Source() = default;
    Source(const Source&) = delete;
    Source& operator=(const Source&) = delete;
    virtual ~Source() = default;
    /// The next record; without its bytes if they are not wanted. False if no record is waiting.
    virtual bool next(bool wanted, std::uint64_t& time_ns, std::string& bytes) = 0;
    [[nodiscard]] virtual std::uint64_t lost() const noexcept = 0;
  };
  template <Recordable Record, std::size_t Capacity>
  class SourceOf final : public Source {
   public:
    explicit SourceOf(const telemetry::RecordStream<Record, Capacity>& stream) : entries_(stream.watch()) {}
    bool next(bool wanted, std::uint64_t& time_ns, std::string& bytes) override {
      typename telemetry::RecordStream<Record, Capacity>::Entry entry;
      if (!entries_.next(entry)) return false;
      time_ns = entry.time_ns;
      if (!wanted) return true;
      const auto cdr = telemetry::to_cdr(entry.record);
      bytes.assign(cdr.begin(), cdr.end());
      return true;
    }
    [[nodiscard]] std::uint64_t lost() const noexcept override { return entries_.lost(); }

   private:
    typename telemetry::RecordStream<Record, Capacity>::Reader entries_;
  };

  [[nodiscard]] Status answer(const std::string& line) const;

  std::map<std::string, std::string> about_;
  std::optional<RunRequests> requests_;
  std::vector<Topic> topics_;
  std::vector<std::unique_ptr<Source>> sources_;  ///< one for each topic
  std::atomic<std::uint64_t> lost_{0};
};

}  // namespace tactus::live
