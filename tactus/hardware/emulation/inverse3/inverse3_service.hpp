// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/emulation/inverse3/faults.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::emulation::inverse3 {

/// How commands name what they hold: `values` until 3.4; `vector` and the like from 3.5 on, where `values` still
/// counts.
enum class Dialect : std::int64_t { v3_1, v3_5 };
constexpr auto enumerators(Dialect) {
  return std::array{Enumerator{Dialect::v3_1, "3.1"}, Enumerator{Dialect::v3_5, "3.5"}};
}

/// An emulated Inverse Service of Haply, without its sockets: which JSON it reports to which. A snapshot at the start,
/// then exactly one state for each message, whatever that holds; a device's state is fresh only where something was
/// asked of it. Each device is a free mass in three axes, pushed by `set_cursor_force`, which acts until the next
/// message and at most for `silence_ns`, 10 N an axis at most. Where it is not calibrated there is no force. Commands
/// of positions and angles are taken and do nothing; so do the filters, which are reported. Times never go back.
///
/// Source: Haply, Inverse SDK pages of the WebSocket protocol and of the migration to 3.5. What the service reports to
/// invalid JSON is on no page: here it reports its state.
class Inverse3Service {
 public:
  struct Params {
    std::int64_t devices = 1;
    Dialect dialect = Dialect::v3_5;
    bool calibrated = true;
    bool partial = false;                  ///< leaves out what equals the identity
    std::int64_t silence_ns = 20'000'000;  ///< without a message for so long, no force
    std::int64_t late_ns = 0;              ///< each answer comes so much later
    double garbage = 0.0;                  ///< share of answers that are cut off
    std::int64_t closes_after = 0;         ///< closes in place of that answer; 0: never
    bool keeps_force = false;              ///< a message without a command does not end a force
    std::optional<std::string> mode = {};  ///< that each state reports in place of its own; "": no mode
    std::int64_t seed = 1;
  };
  /// `out_of_bounds` for a number of devices outside 1 to 4.
  static Result<Inverse3Service> make(const Params& params);

  struct Answer {
    std::string text;
    std::int64_t after_ns = 0;
    bool closes = false;
  };
  /// What a client receives when it has connected.
  [[nodiscard]] std::string snapshot(std::int64_t now_ns);
  Answer answer(std::string_view message, std::int64_t now_ns);
  /// The body of the answer to an HTTP request, and whether it went well.
  struct HttpAnswer {
    bool ok = true;
    std::string body;
  };
  [[nodiscard]] HttpAnswer http(std::string_view method, std::string_view target, std::string_view body);

  /// Injects a fault, of every device, until another of its kind. Its time counts from now.
  void inject(Fault fault, std::int64_t now_ns);
  [[nodiscard]] std::size_t devices() const noexcept { return devices_.size(); }
  /// Whether a force other than zero acts at this time. Of a device below `devices()`.
  [[nodiscard]] bool gives_force(std::size_t device, std::int64_t now_ns);

  // The truth.
  using Vector = std::array<double, 3>;
  [[nodiscard]] const Vector& position_m(std::size_t device) const { return devices_[device].position_m; }
  [[nodiscard]] const Vector& force_N(std::size_t device) const { return devices_[device].force_N; }
  void calibrate() { params_.calibrated = true; }

 private:
  struct Device {
    std::string id;
    Vector position_m{}, velocity_m_per_s{}, force_N{};
    Vector told_position_m{}, told_velocity_m_per_s{}, told_force_N{};
    bool driven = false;  ///< by the last message
    bool gravity_compensation = true;
  };
  explicit Inverse3Service(const Params& params);
  void advance(std::int64_t now_ns);
  void begin_faults(std::int64_t now_ns);
  void obey(std::string_view message, std::int64_t now_ns);
  [[nodiscard]] std::string told(bool with_config) const;

  Params params_;
  signal::Random random_;
  std::vector<Device> devices_;
  std::vector<Fault> faults_;                              ///< that have not begun
  std::optional<bool> calibrated_, power_supply_, ready_;  ///< that states report in place of what is so
  std::int64_t now_ns_ = 0, message_ns_ = 0, messages_ = 0;
};

}  // namespace tactus::emulation::inverse3
