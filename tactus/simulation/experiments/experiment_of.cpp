// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/reference.hpp>
#include <tactus/simulation/experiments/experiment_of.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

namespace tactus::experiments {

std::string reference_page(std::span<const Binding> bindings, std::string_view kind) {
  const std::string name = "`" + std::string(kind) + "`";
  const std::string title =
      "Experiment " + name + "\n\nThis page lists every key of an experiment file of the kind " + name +
      ", with its unit, bounds, default and meaning. A key that a file leaves out keeps its default.";
  TappingParams of_tapping{};
  const auto shared = bind(of_tapping);
  const std::string_view other = name_of(of_tapping.task.kind);
  if (kind == other) return configuration::reference_markdown(bindings, title);
  return configuration::reference_markdown(bindings, title, {.kind = other, .bindings = shared});
}

}  // namespace tactus::experiments
