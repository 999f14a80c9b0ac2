// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>

#include <string>

/// How a servo thread kept time, for every reader.
namespace tactus::runtime {

/// Lateness and duration in us: median, p90, p99, p99.9, worst.
report::Table timing_table(const ServoReport& report);

/// Late ticks by cause, ours and the machine's.
report::Table late_ticks_table(const ServoReport& report);

/// What was asked of the system, and what is lost where it was refused.
report::Table rights_table(const ServoReport& report);

/// How many ticks began, and how many steps took, how long: both histograms on logarithmic axes.
report::Figure timing_figure(const ServoReport& report);

/// The section of a page on all of that; `figure` is that of `timing_figure`.
void add_timing(report::Page& page, const ServoReport& report, const report::Figure& figure);

/// Both tables of times for a terminal.
std::string timing_text(const ServoReport& report);

/// All of it as one JSON object.
std::string servo_json(const ServoReport& report);

}  // namespace tactus::runtime
