// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/bench.hpp>
#include <tactus/data/configuration/toml_writer.hpp>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

namespace tactus::advice {

namespace {

using experiments::TappingParams;

constexpr std::string_view model_section = "control.model.";
constexpr const char* stated_error_key = "task.model_error";

Check set_all(configuration::Document& document, const experiments::Settings& settings) {
  for (const auto& [key, value] : settings) {
    if (auto error = document.set(key + "=" + value)) return error;
  }
  return {};
}

/// Whether a choice is what was given, as far as that is about its first setting, which says what it is.
Result<bool> agrees(const Bench& bench, const Choice& choice, const std::string& as_given) {
  if (choice.settings.empty() || !bench.given.contains(choice.settings.front().first)) return true;
  configuration::Document document = bench.document;
  if (auto error = set_all(document, {choice.settings.front()})) return *std::move(error);
  const auto params = document.read<TappingParams>();
  if (!params) return params.error();
  return configuration::to_toml(*params) == as_given;
}

/// The choice without what was given of it.
Choice without_given(const Bench& bench, Choice choice) {
  std::erase_if(choice.settings, [&bench](const auto& setting) { return bench.given.contains(setting.first); });
  if (!bench.given.contains(choice.tuned)) return choice;
  choice.tuned.clear();
  if (const auto place = choice.words.find("{}"); place != std::string::npos)
    choice.words.replace(place, 2, "the given");
  return choice;
}

}  // namespace

Result<Bench> make_bench(configuration::Document document, const std::vector<std::string>& with,
                         const std::vector<std::string>& set) {
  const auto kind = document.text_at("task.kind");
  if (!kind) return kind.error();
  if (*kind != "tapping") {
    return document.locate({ErrorCode::inconsistent,
                            "task.kind",
                            "advice is given on experiments of the kinds tapping and arm-tapping, not " + *kind +
                                ": name one, as experiments/tapping.toml with your device in it",
                            {}});
  }
  const auto params = document.read<TappingParams>();
  if (!params) return params.error();
  Bench bench{.document = std::move(document), .given = {}, .knowledge = {}, .set = set};
  for (const std::string& assignment : set) {
    std::string key = assignment.substr(0, assignment.find('='));
    key.erase(0, key.find_first_not_of(" \t"));
    bench.given.insert(key.substr(0, key.find_last_not_of(" \t") + 1));
  }
  std::optional<std::filesystem::path> results;
  for (const std::string& name : with) {
    const auto file = configuration::Document::load(name);
    if (!file) return file.error();
    bool model = false;
    for (std::string& key : file->keys()) {
      model = model || key.starts_with(model_section);
      bench.given.insert(std::move(key));
    }
    const auto beside = std::filesystem::path(name).parent_path() / "results.json";
    std::error_code ignored;
    if (model && std::filesystem::is_regular_file(beside, ignored)) results = beside;
  }
  if (results) {
    auto knowledge = Knowledge::read(*results, bench.given);
    if (!knowledge) return knowledge.error();
    bench.knowledge = *std::move(knowledge);
    bench.results = *results;
    if (bench.given.contains(stated_error_key)) return bench;
  } else {
    bench.knowledge = Knowledge::wrong_model(params->task.model_error);
  }
  if (auto error = bench.document.set(std::string(stated_error_key) + "=0")) return *std::move(error);
  return bench;
}

Result<std::vector<Dimension>> allowed(const Bench& bench, const std::vector<Dimension>& dimensions) {
  const auto given = bench.document.read<TappingParams>();
  if (!given) return given.error();
  const std::string as_given = configuration::to_toml(*given);
  std::vector<Dimension> left;
  for (const Dimension& dimension : dimensions) {
    Dimension choices;
    for (const Choice& choice : dimension) {
      const auto agreed = agrees(bench, choice, as_given);
      if (!agreed) return agreed.error();
      if (*agreed) choices.push_back(without_given(bench, choice));
    }
    if (choices.empty()) choices.push_back({});
    left.push_back(std::move(choices));
  }
  return left;
}

Result<TappingParams> params_of(const Bench& bench, const Method& method, std::optional<double> force_limit_N) {
  configuration::Document document = bench.document;
  if (auto error = set_all(document, method.settings())) return *std::move(error);
  auto params = document.read<TappingParams>();
  if (params && force_limit_N) params->control.force_limit_N = *force_limit_N;
  return params;
}

}  // namespace tactus::advice
