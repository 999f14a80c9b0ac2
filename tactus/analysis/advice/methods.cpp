// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/methods.hpp>
#include <tactus/kernel/control/stages/hand_force_compensation.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <numbers>

namespace tactus::advice {

namespace {

constexpr const char* cancellation_words = "cancellation";
constexpr double notch_without_a_mode_Hz = 75.0;

Choice without(const std::string& key, const std::string& value) { return {.settings = {{key, value}}}; }

Choice with_number(const std::string& key, double value, std::string words) {
  return {.settings = {{key, format_number(value)}}, .words = std::move(words), .tuned = key};
}

Choice filter(const std::string& section, const std::string& kind, double frequency_Hz, std::string words) {
  Choice choice{.settings = {{section + ".kind", kind}, {section + ".frequency_Hz", format_number(frequency_Hz)}},
                .words = std::move(words),
                .tuned = section + ".frequency_Hz"};
  if (kind == "notch") choice.settings.emplace_back(section + ".notch_width_Hz", format_number(frequency_Hz));
  return choice;
}

bool is_filter(const Choice& choice) { return choice.tuned.ends_with("_filter.frequency_Hz"); }

}  // namespace

double rounded(double value) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value, std::chars_format::scientific, 2);
  double result = value;
  if (error == std::errc{}) std::from_chars(text, end, result);
  return result;
}

experiments::Settings Method::settings() const {
  experiments::Settings all;
  for (const Choice& choice : choices) all.insert(all.end(), choice.settings.begin(), choice.settings.end());
  return all;
}

bool Method::has(std::string_view words) const {
  return std::any_of(choices.begin(), choices.end(), [words](const Choice& choice) { return choice.words == words; });
}

std::size_t Method::stages() const {
  return static_cast<std::size_t>(std::count_if(choices.begin(), choices.end(), [](const Choice& choice) {
    return !choice.words.empty() && !choice.tuned.empty();
  }));
}

std::string Method::words() const {
  std::vector<std::string> parts;
  for (const Choice& choice : choices) {
    if (choice.words.empty()) continue;
    std::string part = choice.words;
    if (const auto place = part.find("{}"); place != std::string::npos) {
      const auto setting = std::find_if(choice.settings.begin(), choice.settings.end(),
                                        [&choice](const auto& one) { return one.first == choice.tuned; });
      part.replace(place, 2, setting->second);
    }
    parts.push_back(std::move(part));
  }
  if (parts.empty()) return "no stage";
  std::string all = parts.front();
  for (std::size_t i = 1; i < parts.size(); ++i) all += (i + 1 < parts.size() ? ", " : " and ") + parts[i];
  return all;
}

std::vector<Dimension> position_force_dimensions(const control::MasterModel& model) {
  const std::string cancellation = "control.cancellation", estimate = "control.operator_estimate";
  const std::string damping = "control.damping.damping_N_s_per_m", compensation = "control.hand_compensation_Hz";
  const std::string command = "control.command_filter", force = "control.force_filter";
  const double mode_rad_per_s = std::abs(control::linkage_mode(model).imag());
  const double mode_Hz =
      mode_rad_per_s > 0.0 ? rounded(mode_rad_per_s / (2.0 * std::numbers::pi)) : notch_without_a_mode_Hz;
  return {{{.settings = {{"control.architecture", "position-force"}}}},
          {without(cancellation, "off"), {.settings = {{cancellation, "on"}}, .words = cancellation_words}},
          {without(estimate, "off"),
           {.settings = {{estimate, "online"}}, .words = std::string(grip_estimate), .within = cancellation_words}},
          {without(damping, "0"), with_number(damping, 5.0, "local damping of {} N s/m"),
           with_number(damping, 10.0, "local damping of {} N s/m")},
          {without(compensation, "0"), with_number(compensation, 200.0, "hand compensation up to {} Hz")},
          {without(command + ".kind", "none"), filter(command, "notch", mode_Hz, "a notch in the command at {} Hz"),
           filter(command, "low-pass", 30.0, "a low-pass of the command at {} Hz")},
          {without(force + ".kind", "none"), filter(force, "notch", mode_Hz, "a notch in the force at {} Hz"),
           filter(force, "low-pass", 30.0, "a low-pass of the force at {} Hz")}};
}

std::vector<Dimension> other_dimensions() {
  Dimension architectures;
  for (const char* name : {"projection", "time-domain-passivity", "wave-variables", "position-position"}) {
    architectures.push_back(
        {.settings = {{"control.architecture", name}}, .words = std::string("the architecture ") + name});
  }
  return {architectures};
}

std::vector<Method> combine(const std::vector<Dimension>& dimensions, std::size_t stages) {
  struct Counted {
    Method method;
    std::size_t filters = 0;
  };
  std::vector<Counted> all(1);
  for (const Dimension& dimension : dimensions) {
    std::vector<Counted> longer;
    for (const Counted& before : all) {
      for (const Choice& choice : dimension) {
        if (!choice.within.empty() && !before.method.has(choice.within)) continue;
        Counted one = before;
        one.method.choices.push_back(choice);
        one.filters += !choice.words.empty() && is_filter(choice) ? 1U : 0U;
        if (one.method.stages() <= stages && one.filters <= 1) longer.push_back(std::move(one));
      }
    }
    all = std::move(longer);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Counted& a, const Counted& b) { return a.method.stages() < b.method.stages(); });
  std::vector<Method> methods;
  std::transform(all.begin(), all.end(), std::back_inserter(methods),
                 [](Counted& one) { return std::move(one.method); });
  return methods;
}

std::vector<Method> retuned(const Method& method) {
  std::vector<Method> methods;
  for (std::size_t i = 0; i < method.choices.size(); ++i) {
    if (method.choices[i].tuned.empty()) continue;
    for (const double factor : {0.7, 1.4}) {
      Method other = method;
      for (auto& [key, value] : other.choices[i].settings) {
        if (const auto number = experiments::as_number(value)) value = format_number(rounded(factor * *number));
      }
      methods.push_back(std::move(other));
    }
  }
  return methods;
}

}  // namespace tactus::advice
