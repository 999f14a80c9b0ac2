#include <tactus/configuration/reference.hpp>
#include <tactus/experiments/experiment_of.hpp>
#include <tactus/experiments/tapping/tapping.hpp>

namespace tactus::experiments {

std::string reference_page(std::span<const configuration::Binding> bindings, std::string_view kind) {
  const std::string title = "Experiment `" + std::string(kind) + "`";
  TappingParams of_tapping{};
  const auto shared = configuration::bind(of_tapping);
  const std::string_view other = name_of(of_tapping.task.kind);
  if (kind == other) return configuration::reference_markdown(bindings, title);
  return configuration::reference_markdown(bindings, title, {.kind = other, .bindings = shared});
}

}  // namespace tactus::experiments
