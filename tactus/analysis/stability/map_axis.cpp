// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/map_axis.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace tactus::stability {

namespace {

constexpr std::size_t most_values = 1'000'000;

std::string option(std::string_view text) { return "--vary " + std::string(text); }

Error bad_axis(std::string_view text, const std::string& why) {
  return {.code = ErrorCode::syntax,
          .parameter = {},
          .message = why +
                     ": write key=from:to:count, key=from:to:count[log] or key=a,b,c, for instance "
                     "control.force_gain=0.5:30:400",
          .place = option(text)};
}

std::optional<double> to_number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::vector<std::string_view> split(std::string_view text, char at) {
  std::vector<std::string_view> parts;
  for (;;) {
    const auto found = text.find(at);
    parts.push_back(text.substr(0, found));
    if (found == std::string_view::npos) return parts;
    text.remove_prefix(found + 1);
  }
}

/// What all points of a map must share, for they run side by side on one clock.
bool is_shared(std::string_view key) {
  return key.starts_with("servo.") || key.starts_with("plant.") || key == "task.observation_s" ||
         key == "task.speed_m_per_s" || key == "task.depth_m";
}

Result<std::vector<double>> read_range(std::string_view text, std::string_view values, bool logarithmic) {
  const auto parts = split(values, ':');
  if (parts.size() != 3) return bad_axis(text, "a range has three parts");
  const auto from = to_number(parts[0]), to = to_number(parts[1]), count = to_number(parts[2]);
  if (!from || !to || !count) return bad_axis(text, "a part of the range is not a number");
  if (!(*count >= 2.0 && *count <= static_cast<double>(most_values)) || *count != std::floor(*count)) {
    return bad_axis(text, "the count must be a whole number from 2 to 1000000");
  }
  if (!(*from < *to) || (logarithmic && !(*from > 0.0))) {
    return bad_axis(text, logarithmic ? "a logarithmic range ascends from above 0" : "a range ascends");
  }
  std::vector<double> axis;
  const auto steps = static_cast<std::size_t>(*count);
  for (std::size_t i = 0; i < steps; ++i) {
    const double share = static_cast<double>(i) / (*count - 1.0);
    axis.push_back(i + 1 == steps ? *to
                   : logarithmic  ? *from * std::pow(*to / *from, share)
                                  : *from + (*to - *from) * share);
  }
  return axis;
}

}  // namespace

Result<MapAxis> parse_axis(std::string_view text) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos || equals == 0) return bad_axis(text, "there is no key and '='");
  MapAxis axis;
  axis.key = text.substr(0, equals);
  std::string_view values = text.substr(equals + 1);

  MapParams params;
  const auto bindings = bind(params);
  const auto binding =
      std::find_if(bindings.begin(), bindings.end(), [&](const Binding& b) { return b.path == axis.key; });
  if (binding == bindings.end()) {
    return Error{ErrorCode::unknown_key, axis.key, "a map has no such key: `tactus run` names what there is",
                 option(text)};
  }
  if (is_shared(axis.key)) {
    return Error{ErrorCode::inconsistent, axis.key,
                 "is the same for all points of a map, which run side by side: write it in the file, one map for each "
                 "value",
                 option(text)};
  }
  if (const auto* choice = std::get_if<Choice>(&binding->target)) {
    for (const std::string_view word : split(values, ',')) {
      const auto known = std::find(choice->words.begin(), choice->words.end(), word);
      if (known == choice->words.end()) {
        return Error{ErrorCode::out_of_bounds, axis.key, "'" + std::string(word) + "' is no word of this key",
                     option(text)};
      }
      axis.values.push_back(static_cast<double>(known - choice->words.begin()));
      axis.words.emplace_back(word);
    }
    return axis;
  }
  if (!std::holds_alternative<double*>(binding->target)) {
    return Error{ErrorCode::wrong_type, axis.key, "is neither a number nor a choice: vary another key", option(text)};
  }
  axis.unit = binding->unit.symbol;
  if (constexpr std::string_view log = "[log]"; values.ends_with(log)) {
    axis.logarithmic = true;
    values.remove_suffix(log.size());
  }
  if (values.find(':') != std::string_view::npos) {
    auto range = read_range(text, values, axis.logarithmic);
    if (!range) return range.error();
    axis.values = *std::move(range);
  } else {
    for (const std::string_view part : split(values, ',')) {
      const auto value = to_number(part);
      if (!value) return bad_axis(text, "'" + std::string(part) + "' is not a number");
      if (!axis.values.empty() && *value <= axis.values.back()) return bad_axis(text, "the values must ascend");
      axis.values.push_back(*value);
    }
  }
  for (const double end : {axis.values.front(), axis.values.back()}) {
    if (binding->bounds.contain(end)) continue;
    Error error = out_of_bounds(axis.key, end, binding->bounds, binding->unit);
    error.place = option(text);
    return error;
  }
  return axis;
}

PointParams::PointParams(const MapParams& base, const std::vector<MapAxis>& axes) : params_(base), axes_(axes) {
  const auto all = bind(params_);
  for (const MapAxis& axis : axes) {
    for (const Binding& binding : all) {
      if (binding.path == axis.key) bindings_.push_back(binding);
    }
  }
}

const MapParams& PointParams::at(std::size_t point) {
  for (std::size_t i = axes_.size(); i-- > 0;) {
    const double value = axes_[i].values[point % axes_[i].values.size()];
    point /= axes_[i].values.size();
    if (auto* const* number = std::get_if<double*>(&bindings_[i].target)) **number = value;
    if (const auto* choice = std::get_if<Choice>(&bindings_[i].target)) {
      choice->assign(choice->member, static_cast<std::size_t>(value));
    }
  }
  return params_;
}

}  // namespace tactus::stability
