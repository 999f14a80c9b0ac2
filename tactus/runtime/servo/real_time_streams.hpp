// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/recorder.hpp>
#include <tactus/kernel/station/teleoperator_record.hpp>
#include <tactus/runtime/servo/servo_record.hpp>
#include <tactus/runtime/servo/sites_record.hpp>

#include <cstdint>
#include <string>

namespace tactus::runtime {

/// Where a run in real time goes while it runs.
struct RealTimeStreams {
  using Teleoperator = telemetry::RecordStream<station::TeleoperatorRecord>;
  using Servo = telemetry::RecordStream<ServoRecord>;
  using Sites = telemetry::RecordStream<SitesRecord>;
  Teleoperator* teleoperator = nullptr;
  Servo* servo = nullptr;
  Sites* sites = nullptr;      ///< what `replay` needs
  std::int64_t tap = 0;        ///< number of the tap, for the log
  std::int64_t origin_ns = 0;  ///< of the times in the log, on CLOCK_MONOTONIC
  std::string prefix{};        ///< of the topics: `/run_1`, or nothing

  /// Calls `visit(topic, type_name, stream)` for each stream there is.
  template <class Visit>
  void for_each(const Visit& visit) const {
    if (teleoperator != nullptr) visit(prefix + "/teleoperator", "tactus_msgs/msg/TeleoperatorRecord", *teleoperator);
    if (servo != nullptr) visit(prefix + "/servo", "tactus_msgs/msg/ServoRecord", *servo);
    if (sites != nullptr) visit(prefix + "/sites", "tactus_msgs/msg/SitesRecord", *sites);
  }
};

}  // namespace tactus::runtime
