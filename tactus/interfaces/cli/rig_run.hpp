// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/cli/observers.hpp>
#include <tactus/interfaces/cli/output_folder.hpp>
#include <tactus/interfaces/cli/supervised_run.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/link/endpoint.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tactus::cli {

/// Whether a `--device` names a rig file: `FILE.toml`, or `FILE.toml:PAIR`.
bool names_a_rig(const std::string& device);

/// Whether an experiment of that kind states how a rig is driven.
bool drives_a_rig(std::string_view kind);

/// Drives a pair of a rig under supervision until it is over: what `tactus run EXPERIMENT --realtime --device
/// FILE.toml` is. Each joint by the controller of an experiment of the kind `tapping`; two arms by the sites of one of
/// the kind `arm-tapping`, which carry them. Nothing gets power before the rig is clean. With a `link` only the side of
/// its site is driven, the leader by the master: that is `--site`, and the rig file needs no more than that side.
Check run_rig(const SupervisedOptions& options, const ObserverOptions& observer_options,
              runtime::ServoThreadParams servo, const experiments::Request& request, OutputFolder& folder,
              std::uint64_t log_limit_bytes, const std::optional<link::EndpointSettings>& link = {});

}  // namespace tactus::cli
