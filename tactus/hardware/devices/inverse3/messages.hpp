// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Haply's Inverse3 as its Inverse Service reports it and takes commands for it, in JSON. Source: Haply, Inverse SDK
/// 3.5, pages of the WebSocket protocol and of the migration to 3.5. No connection is made here. Not real-time safe.
namespace tactus::devices::inverse3 {

/// x, y, z. Right-handed, origin at the mounting plate.
using Vector = std::array<double, 3>;

/// How commands name what they hold.
enum class Dialect : std::int64_t {
  values,  ///< `values`, until 3.4; also what every open client reports
  named    ///< `vector` for a force, from 3.5 on
};
constexpr auto enumerators(Dialect) {
  return std::array{Enumerator{Dialect::values, "values"}, Enumerator{Dialect::named, "named"}};
}
/// That of a service which answers so to GET /version. No page shows the answer in full, so the first number of the
/// form 3.5 in it counts. Errors: `syntax` without a version.
Result<Dialect> dialect_of(std::string_view answer);

/// The message of a tick: so much force at the cursor, newtons, on this device. A force that is not a number is zero.
/// It asks for a fresh state too, and what is not sent again ends: the service keeps no command.
std::string force_message(std::string_view device_id, const Vector& force_N, Dialect dialect);
/// The message of a tick without force, which keeps states fresh.
std::string probe_message(std::string_view device_id);

/// A device as it was reported so far.
struct Device {
  std::string id;
  Vector position_m{}, velocity_m_per_s{};
  Vector force_N{};         ///< that the service reports to give
  bool calibrated = false;  ///< no force before it is
  bool ready = false;
  bool supplied = true;     ///< false only where the service reports that it has no supply of power
  bool told_force = false;  ///< in the latest message
  std::string mode;         ///< what drives it, as `idle` or `force`; empty if the latest message lacks it
  /// Filters of the service in the way of the force; empty if nothing was reported of them. What is not 0 belongs to
  /// the model or has to be switched off.
  std::optional<double> force_gate, damping;
};

/// Whether it reports, in the latest message, that it gives no force: its mode is `idle`, or, where the service reports
/// no mode, its force is. A mode that is not known counts as a force.
bool reports_off(const Device& device) noexcept;
/// The first seven letters of a mode as a number (`MotorReading::status`); `no_status` without a mode.
std::int64_t status_of(const Device& device) noexcept;
/// `mode 'force'`, for a user; `no mode` where that is negative. Not real-time safe.
std::string status_text(std::int64_t status);

/// All devices of a service. The first message has all, later ones what changed: what one leaves out stays as it was.
class Devices {
 public:
  /// Takes a message. Errors: `syntax` for what is not JSON, or no list of devices; `wrong_type` for a number, a flag
  /// or an unknown name. Then nothing changed.
  Check take(std::string_view message);
  [[nodiscard]] const std::vector<Device>& all() const noexcept { return devices_; }

 private:
  std::vector<Device> devices_;
};

}  // namespace tactus::devices::inverse3
