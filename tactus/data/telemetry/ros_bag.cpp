// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/data/telemetry/ros_bag.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <utility>

namespace tactus::telemetry {
namespace {

constexpr std::size_t most_bag_numbers = std::size_t{1} << 26U;
constexpr std::size_t most_signals = 4096;
constexpr std::string_view joint_state = "sensor_msgs/msg/JointState";
constexpr std::string_view wrench_stamped = "geometry_msgs/msg/WrenchStamped";

/// Takes values off a message in CDR of either byte order. Once something does not fit, `ok` is false.
class CdrCursor {
 public:
  explicit CdrCursor(std::span<const unsigned char> message) {
    constexpr std::size_t head = 4;
    ok_ = message.size() >= head && message[0] == 0 && message[1] <= 1;
    if (!ok_) return;
    little_ = message[1] == 1;
    bytes_ = message.subspan(head);
  }

  template <class Unsigned>
  Unsigned take() {
    at_ = (at_ + sizeof(Unsigned) - 1) / sizeof(Unsigned) * sizeof(Unsigned);
    if (!ok_ || at_ + sizeof(Unsigned) > bytes_.size()) {
      ok_ = false;
      return 0;
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
      const std::size_t shift = 8 * (little_ ? i : sizeof(Unsigned) - 1 - i);
      value |= std::uint64_t{bytes_[at_ + i]} << shift;
    }
    at_ += sizeof(Unsigned);
    return static_cast<Unsigned>(value);
  }

  double take_double() { return std::bit_cast<double>(take<std::uint64_t>()); }

  std::string take_text() {
    const auto size = take<std::uint32_t>();
    if (!ok_ || size > bytes_.size() - at_) {
      ok_ = false;
      return {};
    }
    std::string text(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                     bytes_.begin() + static_cast<std::ptrdiff_t>(at_ + size));
    at_ += size;
    if (!text.empty() && text.back() == '\0') text.pop_back();
    return text;
  }

  /// How many members of at least `size` bytes follow.
  std::size_t take_count(std::size_t size) {
    const auto count = take<std::uint32_t>();
    if (ok_ && count <= (bytes_.size() - at_) / size) return count;
    if (count != 0) ok_ = false;
    return 0;
  }

  std::vector<double> take_doubles() {
    std::vector<double> values(take_count(sizeof(double)));
    for (double& value : values) value = take_double();
    return values;
  }

  /// A std_msgs/Header: its stamp in nanoseconds.
  std::int64_t take_header() {
    const auto seconds = static_cast<std::int32_t>(take<std::uint32_t>());
    const auto nanoseconds = take<std::uint32_t>();
    take_text();
    return std::int64_t{1'000'000'000} * seconds + nanoseconds;
  }

  [[nodiscard]] bool ok() const { return ok_; }

 private:
  std::span<const unsigned char> bytes_;
  std::size_t at_ = 0;
  bool little_ = true;
  bool ok_ = true;
};

/// The name of a type, with or without `/msg/`.
bool is_type(std::string_view name, std::string_view type) {
  const std::size_t middle = type.find("/msg/");
  return name == type || name == std::string(type.substr(0, middle)) + std::string(type.substr(middle + 4));
}

class BagReading {
 public:
  Check take(const LogChannel& channel, const LogMessage& message) {
    const bool is_joints = is_type(channel.type_name, joint_state);
    if (channel.encoding != "cdr" || (!is_joints && !is_type(channel.type_name, wrench_stamped))) {
      ++others_[{channel.topic, channel.type_name}];
      return std::nullopt;
    }
    CdrCursor cursor(message.bytes);
    const std::int64_t stamp_ns = cursor.take_header();
    const std::int64_t time_ns = stamp_ns > 0 ? stamp_ns : static_cast<std::int64_t>(message.time_ns);
    if (is_joints) {
      take_joints(channel.topic, time_ns, cursor);
    } else {
      constexpr std::array names{"force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"};
      for (const std::string_view name : names) {
        add({channel.topic, "", std::string(name)}, name.starts_with("force") ? "N" : "N m", time_ns,
            cursor.take_double());
      }
    }
    ++number_of_[channel.topic];
    if (!cursor.ok()) {
      return Error{.code = ErrorCode::syntax,
                   .parameter = {},
                   .message = "message " + std::to_string(number_of_[channel.topic]) + " of " + channel.topic +
                              " is no " + channel.type_name + " in CDR: record the topic again",
                   .place = {}};
    }
    if (numbers_ <= most_bag_numbers && signals_.size() <= most_signals) return std::nullopt;
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = {},
                 .message = "the bag holds more than " + std::to_string(most_bag_numbers) + " numbers or " +
                            std::to_string(most_signals) + " signals: cut it, or record fewer topics",
                 .place = {}};
  }

  Result<Bag> finish(const LogSummary& summary) && {
    Bag bag{.complete = summary.complete, .damaged_chunks = summary.damaged_chunks};
    for (const auto& [what, count] : others_) {
      bag.ignored.push_back(what.first + " (" + what.second + ", " + std::to_string(count) + " messages)");
    }
    if (signals_.empty()) {
      std::string list;
      for (const std::string& one : bag.ignored) list += (list.empty() ? "" : ", ") + one;
      return Error{.code = ErrorCode::missing,
                   .parameter = {},
                   .message =
                       "the bag has no sensor_msgs/msg/JointState and no geometry_msgs/msg/WrenchStamped, which "
                       "are read; it has: " +
                       (list.empty() ? std::string("no messages") : list),
                   .place = {}};
    }
    std::int64_t first_ns = signals_.front().times_ns.front();
    for (const Filling& one : signals_) first_ns = std::min(first_ns, one.times_ns.front());
    for (Filling& one : signals_) {
      for (const std::int64_t time_ns : one.times_ns) {
        one.signal.time_s.push_back(1e-9 * static_cast<double>(time_ns - first_ns));
      }
      bag.signals.push_back(std::move(one.signal));
    }
    return bag;
  }

 private:
  struct Key {
    std::string topic, joint, quantity;
    auto operator<=>(const Key&) const = default;
  };
  struct Filling {
    BagSignal signal;
    std::vector<std::int64_t> times_ns;
  };

  void take_joints(const std::string& topic, std::int64_t time_ns, CdrCursor& cursor) {
    constexpr std::size_t least_text_bytes = 4;
    std::vector<std::string> names(cursor.take_count(least_text_bytes));
    for (std::string& name : names) name = cursor.take_text();
    for (const auto& [quantity, unit] :
         {std::pair{"position", "rad"}, std::pair{"velocity", "rad/s"}, std::pair{"effort", "N m"}}) {
      const std::vector<double> values = cursor.take_doubles();
      if (!cursor.ok()) return;
      for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i) {
        add({topic, names[i], quantity}, unit, time_ns, values[i]);
      }
    }
  }

  void add(Key key, const char* unit, std::int64_t time_ns, double value) {
    const auto [place, is_new] = index_.emplace(key, signals_.size());
    if (is_new) {
      signals_.push_back({BagSignal{.topic = std::move(key.topic),
                                    .joint = std::move(key.joint),
                                    .quantity = std::move(key.quantity),
                                    .unit = unit},
                          {}});
    }
    Filling& filling = signals_[place->second];
    filling.times_ns.push_back(time_ns);
    filling.signal.values.push_back(value);
    numbers_ += 2;
  }

  std::vector<Filling> signals_;
  std::map<Key, std::size_t> index_;
  std::map<std::pair<std::string, std::string>, std::uint64_t> others_;
  std::map<std::string, std::uint64_t> number_of_;
  std::size_t numbers_ = 0;
};

}  // namespace

std::string BagSignal::name() const { return topic + "/" + (joint.empty() ? quantity : joint + "." + quantity); }

Result<Bag> read_bag(const std::filesystem::path& file_or_folder) {
  const auto files = log_files(file_or_folder);
  if (!files) return files.error();
  BagReading reading;
  LogSummary all;
  all.complete = true;
  for (const auto& file : *files) {
    const auto part = scan_log(
        file, [&](const LogChannel& channel, const LogMessage& message) { return reading.take(channel, message); });
    if (!part) return part.error();
    all.complete = all.complete && part->complete;
    all.damaged_chunks += part->damaged_chunks;
  }
  auto bag = std::move(reading).finish(all);
  if (bag) return bag;
  Error error = bag.error();
  error.place = file_or_folder.string();
  return error;
}

}  // namespace tactus::telemetry
