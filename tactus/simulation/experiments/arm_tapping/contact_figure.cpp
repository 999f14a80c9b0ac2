// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/simulation/experiments/arm_tapping/contact_figure.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace tactus::experiments {

namespace {

using arm::Vector3;
using report::Line;

constexpr int of_follower = 0, of_leader = 1, of_force = 2, of_induced = 3, of_surface = 7;  // colours
constexpr double longest_arrow_share = 0.3;                                                  // of what the arms reach
constexpr double head_share = 0.25;                                                          // of an arrow

/// The plane of the picture: upright, and along the tap where that is level, else along the arm.
struct SideView {
  Vector3 across;
  [[nodiscard]] double x_mm(const Vector3& at) const { return 1e3 * across.dot(at); }
  [[nodiscard]] double z_mm(const Vector3& at) const { return 1e3 * at.z(); }
  void add(Line& line, const Vector3& at) const {
    line.x.push_back(x_mm(at));
    line.y.push_back(z_mm(at));
  }
};

SideView side_view(const ArmPairSetup& setup, const Vector3& tool) {
  const Vector3 along_tap(setup.outward.x(), setup.outward.y(), 0.0);
  if (along_tap.norm() > 0.5) return {along_tap.normalized()};
  const Vector3 along_arm(tool.x(), tool.y(), 0.0);
  return {along_arm.norm() > 0.0 ? Vector3(along_arm.normalized()) : Vector3(Vector3::UnitX())};
}

/// From the base over each joint to the tool.
std::vector<Vector3> links_of(const DescribedArm& of, const arm::JointVector& position, const Vector3& tool) {
  std::vector<Vector3> points{Vector3::Zero()};
  for (const arm::LinkPose& pose : arm::Chain::make(of.arm.chain)->poses(position)) points.push_back(pose.position_m);
  points.push_back(tool);
  return points;
}

Line line_of(const SideView& view, std::string name, const std::vector<Vector3>& points, int colour, double width_px) {
  Line line{.name = std::move(name), .x = {}, .y = {}, .colour = colour, .width_px = width_px};
  for (const Vector3& point : points) view.add(line, point);
  return line;
}

/// With its head, in the plane of the picture.
Line arrow(const SideView& view, std::string name, const Vector3& from, const Vector3& vector, int colour) {
  const Vector3 seen = view.across.dot(vector) * view.across + vector.z() * Vector3::UnitZ();
  const Vector3 aside = view.across.dot(seen) * Vector3::UnitZ() - seen.z() * view.across;
  const Vector3 tip = from + seen;
  const Vector3 back = tip - head_share * seen;
  return line_of(view, std::move(name),
                 {from, tip, back + 0.5 * head_share * aside, tip, back - 0.5 * head_share * aside}, colour, 2.0);
}

double reach_of(const std::vector<Vector3>& points) {
  double farthest = 0.0;
  for (const Vector3& point : points) farthest = std::max(farthest, point.norm());
  return farthest;
}

report::Panel panel_of(std::string title, std::vector<Line> lines) {
  return {.title = std::move(title),
          .x = {.label = "along the base", .unit = "mm"},
          .y = {.label = "height over the base", .unit = "mm"},
          .lines = std::move(lines),
          .rules = {},
          .equal_scales = true};
}

}  // namespace

report::Figure contact_figure(const ArmPairSetup& setup, const ArmTrace::Contact& contact,
                              const std::string& settings) {
  const ArmSnapshot& snapshot = contact.snapshot;
  const double contact_N = contact.force_N;
  const double displayed_N = snapshot.displayed_N.norm();
  const double most_N = std::max({contact_N, displayed_N, std::numeric_limits<double>::min()});

  const SideView view = side_view(setup, snapshot.follower_m);
  const auto leader = links_of(setup.leader, snapshot.leader_rad, snapshot.leader_m);
  const auto follower = links_of(setup.follower, snapshot.follower_rad, snapshot.follower_m);
  const auto force = [&](const std::string& name, double newtons, const std::vector<Vector3>& arm,
                         const Vector3& along) {
    const double length = longest_arrow_share * reach_of(arm) / most_N;
    return arrow(view, name + ", " + report::number(newtons, 3) + " N", arm.back(), length * along, of_force);
  };
  const Vector3 level = std::fabs(setup.outward.z()) > 0.5 ? view.across : Vector3(Vector3::UnitZ());
  const double half_m = 0.5 * longest_arrow_share * reach_of(follower);
  const Line surface = line_of(
      view, "surface", {snapshot.follower_m - half_m * level, snapshot.follower_m + half_m * level}, of_surface, 3.0);
  const double induced_m = snapshot.induced_m.norm();
  const double magnified =
      induced_m > 0.0 ? std::pow(10.0, std::floor(std::log10(longest_arrow_share * reach_of(leader) / induced_m)))
                      : 1.0;
  Line induced = arrow(
      view, "induced motion × " + report::number(magnified, 1) + ", " + report::number(1e3 * induced_m, 2) + " mm",
      snapshot.leader_m, magnified * snapshot.induced_m, of_induced);
  return {
      .title = "Both arms on the surface",
      .caption =
          "From the side, " + report::number(1e3 * pressing_after_s, 2) +
          " ms after the first touch of the first tap: the surface pushes the follower's tool, the motors of the "
          "leader display that at the hand, and move it. Forces are drawn to one scale. " +
          settings,
      .columns = 2,
      .panels = {panel_of("Leader, in the hand",
                          {line_of(view, "leader", leader, of_leader, 4.0),
                           force("displayed force", displayed_N, leader, snapshot.displayed_N), std::move(induced)}),
                 panel_of("Follower, on the surface",
                          {surface, line_of(view, "follower", follower, of_follower, 4.0),
                           force("contact force", contact_N, follower, contact_N * setup.outward)})}};
}

}  // namespace tactus::experiments
