// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/servo/end_request.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <functional>

namespace tactus::real_time {

/// The table of faults in virtual time, and after it the first `task.real_time_seeds` plans of each row again at the
/// real clock: the same sites, devices and plans, stepped by a servo thread, several runs side by side in each tick.
/// Ticks that the machine misses are a stall of both sites in each of these runs, and are judged as such. No cut lasts
/// longer than a second.
///
/// `listen` is called between the two and returns where the end can be requested from then on. If it is requested, the
/// outcome has the runs that were over by then, and states that there should be more.
///
/// Errors: those of the experiment `faults`, of the servo thread and of `listen`.
Result<experiments::Outcome> run_faults_in_real_time(const experiments::Request& request,
                                                     const runtime::ServoThreadParams& servo,
                                                     const experiments::Progress& progress,
                                                     const std::function<Result<const runtime::EndRequest*>()>& listen);

}  // namespace tactus::real_time
