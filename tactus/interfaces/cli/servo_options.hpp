// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/runtime/servo/servo_thread.hpp>

namespace CLI {  // NOLINT: the name is not ours
class App;
}

namespace tactus::cli {

/// Adds how a servo thread keeps time to a command: `--priority`, `--core`, `--spin-s`.
void add_servo_options(CLI::App& verb, runtime::ServoThreadParams& params);

}  // namespace tactus::cli
