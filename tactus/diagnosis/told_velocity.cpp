#include <tactus/diagnosis/told_velocity.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <string_view>

namespace tactus::diagnosis {

std::string find_velocity(bool of_master, const std::vector<recording::Entry>& entries) {
  using TwoWords = std::array<std::string_view, 2>;
  const TwoWords who = of_master ? TwoWords{"master", "leader"} : TwoWords{"slave", "follower"};
  const auto mentions = [](const std::string& text, const TwoWords& words) {
    return text.find(words[0]) != std::string::npos || text.find(words[1]) != std::string::npos;
  };
  std::string found;
  for (const recording::Entry& entry : entries) {
    std::string name = entry.name;
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const bool unit_fits = entry.unit.empty() || entry.unit == "rad/s" || entry.unit == "m/s";
    const bool is_column = entry.readable && (entry.columns == 1 || entry.rows == 1);
    if (!is_column || !unit_fits || !mentions(name, who) || !mentions(name, {"vel", "speed"})) continue;
    if (mentions(name, {"command", "desired"}) || mentions(name, {"target", "goal"})) continue;
    if (!found.empty()) return {};
    found = entry.name;
  }
  return found;
}

std::optional<double> told_scale(std::span<const double> position, std::span<const double> velocity, Seconds dt) {
  constexpr double stretch_s = 0.05, most_left = 0.1;
  const auto stretch = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(stretch_s / dt.value)));
  const std::size_t samples = std::min(position.size(), velocity.size());
  double squares = 0.0, product = 0.0, told_squares = 0.0;
  for (std::size_t from = 0; from + stretch < samples; from += stretch) {
    const double way = position[from + stretch] - position[from];
    double told = 0.5 * (velocity[from] + velocity[from + stretch]);
    for (std::size_t i = from + 1; i < from + stretch; ++i) told += velocity[i];
    told *= dt.value;
    squares += way * way;
    product += told * way;
    told_squares += told * told;
  }
  if (!(squares > 0.0 && told_squares > 0.0)) return std::nullopt;
  const double explained = product * product / (squares * told_squares);
  if (!(explained > 1.0 - most_left)) return std::nullopt;
  return std::fabs(product / squares);
}

}  // namespace tactus::diagnosis
