// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/servo_options.hpp>

#include <CLI/CLI.hpp>

namespace tactus::cli {

void add_servo_options(CLI::App& verb, runtime::ServoThreadParams& params) {
  verb.add_option("--priority", params.priority, "SCHED_FIFO priority of the servo thread, 1 to 99")->type_name("N");
  verb.add_option("--core", params.core, "Core of the servo thread; -1: any")->type_name("N");
  verb.add_option("--spin-s", params.spin_s,
                  "Time before each deadline in which the thread polls the clock instead of sleeping; at most half a "
                  "control cycle")
      ->type_name("S");
}

}  // namespace tactus::cli
