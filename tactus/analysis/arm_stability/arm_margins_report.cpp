// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/arm_stability/arm_margins_report.hpp>
#include <tactus/analysis/arm_stability/arm_point.hpp>
#include <tactus/analysis/arm_stability/internal/mode_json.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <cmath>
#include <numbers>
#include <utility>

#include <nlohmann/json.hpp>

namespace tactus::arm_stability {
namespace {

using experiments::GainLimit;
using Json = nlohmann::ordered_json;

/// The options of one axis that arms have no use for.
Check refuse_options(const stability::ReportOptions& options, experiments::SurfaceLaw law) {
  const stability::ReportOptions unset;
  const auto refused = [](const char* option, const char* instead) {
    return Error{.code = ErrorCode::inconsistent, .parameter = {}, .message = instead, .place = option};
  };
  if (options.linearisation.linkage_amplitude_m != unset.linearisation.linkage_amplitude_m) {
    return refused("--linkage-amplitude", "two arms have no linkages: leave it out");
  }
  if (law == experiments::SurfaceLaw::kelvin_voigt &&
      options.linearisation.preload_N != unset.linearisation.preload_N) {
    return refused("--preload", "the surface is linear, by wall.law = kelvin-voigt: leave it out");
  }
  if (options.uncertainty != unset.uncertainty) {
    return refused("--uncertainty", "the model of two arms errs by task.model_error: write that with --set");
  }
  return std::nullopt;
}

struct ArmAnalysis {
  ArmPoint point;
  std::optional<double> preload_N;  ///< of a surface whose law is curved
  ArmLimit limit;
  ArmMode slowest;
  stability::DiskMargin disk;
  [[nodiscard]] bool is_stable() const { return std::abs(slowest.pole) < 1.0; }
  /// Of the exact model; below 1 beyond the limit.
  [[nodiscard]] double gain_margin() const { return limit.exact.gain / point.force_gain; }
};

std::string text_of(const GainLimit& limit) { return experiments::gain_limit_text(limit, lowest_arm_gain); }

std::string wrong_models(const ArmPoint& point) {
  return "the worst of " + std::to_string(models_drawn) + " models wrong by up to " +
         report::number(100.0 * point.model_error, 3) + " %";
}

std::string verdict_of(const ArmAnalysis& a) {
  std::string text = std::string(a.is_stable() ? "Stable" : "Unstable") + " at a force gain of " +
                     report::number(a.point.force_gain, 3) + "; the limit is " + text_of(a.limit.exact);
  if (a.point.loops.size() > 1)
    text += " with the exact model, " + text_of(a.limit.drawn) + " with " + wrong_models(a.point);
  return text + ".";
}

report::Table table_of(const ArmAnalysis& a) {
  report::Table table({{"quantity", "", report::Column::Align::left},
                       {"value"},
                       {"at", "Hz"},
                       {"moves most", "", report::Column::Align::left}},
                      "Loop of two arms, linear, in contact");
  const auto row = [&](const char* what, const std::string& value, const std::optional<ArmMode>& mode) {
    table.add_row(
        {what, value, mode ? report::number(mode->frequency_Hz, 3) : "", mode ? words_of(*mode, a.point.joints) : ""});
  };
  row("gain limit", text_of(a.limit.exact), a.limit.beyond_exact);
  if (a.point.loops.size() > 1) row("limit, worst of the drawn models", text_of(a.limit.drawn), a.limit.beyond_drawn);
  row("gain margin", std::isfinite(a.gain_margin()) ? report::number(a.gain_margin(), 3) : "none", std::nullopt);
  table.add_row({"disk margin, every joint by itself", report::number(a.disk.alpha, 3),
                 a.disk.alpha > 0.0 ? report::number(a.disk.frequency_rad_per_s / (2.0 * std::numbers::pi), 3) : "",
                 ""});
  table.add_row({"  in gain, a factor", report::number(a.disk.gain_factor(), 3), "", ""});
  table.add_row({"  in phase, degrees", report::number(a.disk.phase_rad() * 180.0 / std::numbers::pi, 3), "", ""});
  row("slowest pole, size", report::number(std::abs(a.slowest.pole), 6), a.slowest);
  row("follower's drives at the tool into the wall, N/m", report::number(a.point.follower_stiffness_N_per_m, 3),
      std::nullopt);
  if (a.preload_N) {
    row(("surface about " + report::number(*a.preload_N, 3) + " N, N/m").c_str(),
        report::number(a.point.loops.front().wall_stiffness_N_per_m(), 3), std::nullopt);
  }
  row("drift left to the operator, 1/s", report::number(a.slowest.drift_per_s, 3), std::nullopt);
  return table;
}

std::string json_of(const experiments::Request& request, const ArmAnalysis& a, double friction_speed_rad_per_s) {
  const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  Json document{{"experiment", request.name},
                {"friction_speed_rad_per_s", friction_speed_rad_per_s},
                {"force_gain", a.point.force_gain},
                {"stable", a.is_stable()},
                {"gain_limit", a.limit.exact.gain},
                {"gain_limit_censored", a.limit.exact.censored()},
                {"at_limit", mode_json(a.limit.beyond_exact, a.point.joints)},
                {"drawn_models", a.point.loops.size() - 1},
                {"drawn_limit", a.limit.drawn.gain},
                {"drawn_limit_censored", a.limit.drawn.censored()},
                {"at_drawn_limit", mode_json(a.limit.beyond_drawn, a.point.joints)},
                {"gain_margin", number(a.gain_margin())},
                {"disk_margin", a.disk.alpha},
                {"disk_margin_at_Hz", a.disk.frequency_rad_per_s / (2.0 * std::numbers::pi)},
                {"disk_gain_factor", number(a.disk.gain_factor())},
                {"disk_phase_rad", number(a.disk.phase_rad())},
                {"spectral_radius", std::abs(a.slowest.pole)},
                {"slowest", mode_json(a.slowest, a.point.joints)},
                {"drift_per_s", a.slowest.drift_per_s},
                {"follower_stiffness_N_per_m", a.point.follower_stiffness_N_per_m},
                {"preload_N", a.preload_N ? Json(*a.preload_N) : Json(nullptr)},
                {"wall_stiffness_N_per_m", a.point.loops.front().wall_stiffness_N_per_m()}};
  return report::json_text(document);
}

}  // namespace

Result<experiments::Outcome> report_arm_margins(const experiments::Request& request,
                                                const stability::ReportOptions& options) {
  const auto params = request.document.read<experiments::ArmTappingParams>();
  if (!params) return params.error();
  const experiments::SurfaceLaw law = params->wall.law;
  if (Check refused = refuse_options(options, law)) return *std::move(refused);
  const std::filesystem::path folder = std::filesystem::path(request.document.name()).parent_path();
  const double friction_speed = options.linearisation.friction_speed_m_per_s;
  const double preload_N = options.linearisation.preload_N;
  auto point = make_arm_point(*params, folder, {.friction_speed_rad_per_s = friction_speed, .preload_N = preload_N});
  if (!point) return request.document.locate(point.error());
  ArmAnalysis analysis{.point = *std::move(point), .preload_N = {}, .limit = {}, .slowest = {}, .disk = {}};
  if (law != experiments::SurfaceLaw::kelvin_voigt) analysis.preload_N = preload_N;
  const ArmLoop& exact = analysis.point.loops.front();
  analysis.limit = limit_of(analysis.point);
  analysis.slowest = slowest_mode(exact, params->control.force_gain);
  analysis.disk = disk_margin(exact, params->control.force_gain);
  const report::Table table = table_of(analysis);
  const std::string verdict = verdict_of(analysis);
  report::Page page(request.name + ": stability margins of two arms");
  page.paragraph(verdict);
  page.paragraph(
      "The torque that the follower sends moves the leader in the hand, and that motion goes to the follower as a "
      "command. This loop, linear and sampled, is judged here with the follower's tool on the wall. It does not see "
      "contact that breaks, steps, saturation, dead bands, the operator's slow correction, or friction that sticks.");
  page.table(table);
  return experiments::outcome_of({.text = verdict + "\n\n" + table.to_text(),
                                  .json = json_of(request, analysis, friction_speed),
                                  .page = std::move(page),
                                  .figures = {}},
                                 request, configuration::to_toml(*params));
}

}  // namespace tactus::arm_stability
