#pragma once

#include <tactus/experiments/experiment.hpp>
#include <tactus/experiments/gain_limit.hpp>
#include <tactus/report/page.hpp>
#include <tactus/report/table.hpp>
#include <tactus/report/text.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What the results of every experiment have in common when they are shown.
namespace tactus::experiments {

/// The key's last part as words with its unit where the name ends with one: `stiffness` in `N/m`.
report::Axis axis_of(std::string_view key);
/// A column for each varied key.
std::vector<report::Column> settings_columns(const Settings& settings);
std::vector<std::string> settings_cells(const Settings& settings);
/// `{"control.force_gain": 1, "control.cancellation": "off"}` as text: numbers as numbers, words as words.
std::string settings_json(const Settings& settings);
/// The settings in a few words for a picture: `force gain 3`.
std::string settings_caption(const Settings& settings);
/// The value of a setting if it is a finite number.
std::optional<double> as_number(std::string_view text);

/// A limit with `≥` where the search ended there, and `<` where not even its `lowest_gain` settled.
std::string gain_limit_text(const GainLimit& limit, double lowest_gain);

/// Ends a page with what is needed to repeat the run: the command, the configuration of its first combination, the
/// version.
void add_provenance(report::Page& page, const Request& request, std::string_view configuration);

}  // namespace tactus::experiments
