#include <tactus/cli/servo_options.hpp>

#include <CLI/CLI.hpp>

namespace tactus::cli {

void add_servo_options(CLI::App& verb, runtime::ServoThreadParams& params) {
  verb.add_option("--priority", params.priority, "Priority of the servo thread under SCHED_FIFO, 1 to 99")
      ->type_name("N");
  verb.add_option("--core", params.core, "The one core of the servo thread; -1 leaves the choice open")->type_name("N");
  verb.add_option("--spin-s", params.spin_s,
                  "The last part of each wait, spent asking the clock instead of asleep; at most half a tick")
      ->type_name("S");
}

}  // namespace tactus::cli
