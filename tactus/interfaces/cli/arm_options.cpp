// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/identification/arm/rig_log.hpp>
#include <tactus/interfaces/cli/arm_options.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/kernel/arm/chain.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include <CLI/CLI.hpp>

namespace tactus::cli {
namespace {

std::string joined_by_commas(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ",") + word;
  return all;
}

/// Says which joints cannot hold the arm's own weight in every posture. Postures are spread evenly over the ranges.
void warn_of_weight(const urdf::Arm& arm) {
  const auto chain = arm::Chain::make(arm.params);
  if (!chain) return;
  constexpr int postures = 500;
  constexpr double unlimited = 1e6;
  const auto count = static_cast<Eigen::Index>(arm.joints.size());
  const arm::JointVector still = arm::JointVector::Zero(count);
  arm::JointVector most = still;
  for (int i = 0; i < postures; ++i) {
    arm::JointVector position(count);
    for (Eigen::Index j = 0; j < count; ++j) {
      const arm::JointLimits& limits = arm.params.joints[static_cast<std::size_t>(j)].limits;
      const bool turns = arm.params.joints[static_cast<std::size_t>(j)].kind == arm::JointKind::revolute;
      const double reach = turns ? std::numbers::pi : 1.0;
      const double lower = std::max(limits.lower_rad, -reach), upper = std::min(limits.upper_rad, reach);
      // Multiples of the roots of primes, modulo 1, fill a box evenly.
      constexpr std::array<double, 8> primes{2, 3, 5, 7, 11, 13, 17, 19};
      const double share = i * std::sqrt(primes[static_cast<std::size_t>(j) % primes.size()]);
      position[j] = lower + (share - std::floor(share)) * (upper - lower);
    }
    most = most.cwiseMax(chain->inverse_dynamics(position, still, still).cwiseAbs());
  }
  for (Eigen::Index j = 0; j < count; ++j) {
    const auto at = static_cast<std::size_t>(j);
    const double limit = arm.params.joints[at].limits.effort_N_m;
    const char* const unit = arm.params.joints[at].kind == arm::JointKind::revolute ? " N m" : " N";
    if (limit >= unlimited || most[j] <= limit) continue;
    message_stream() << "Warning: joint '" << arm.joints[at] << "' takes up to " << report::number(most[j], 3) << unit
                     << " to hold the arm's own weight, more than its effort limit of " << report::number(limit, 3)
                     << unit << "\n";
  }
}

}  // namespace

arm_identification::ArmColumns ArmOptions::columns() const {
  return {.time = joined_by_commas(time),
          .time_unit = time_unit,
          .position = joined_by_commas(position),
          .velocity = joined_by_commas(velocity),
          .effort = joined_by_commas(effort)};
}

Result<std::vector<arm_identification::ArmRecording>> read_recordings(const std::string& file,
                                                                      const ArmOptions& options,
                                                                      const std::vector<std::string>& joints) {
  const bool log = arm_identification::is_log(file);
  for (const auto& [name, given, needed] :
       {std::tuple{"--time", &options.time, true}, std::tuple{"--position", &options.position, true},
        std::tuple{"--velocity", &options.velocity, false}, std::tuple{"--effort", &options.effort, true}}) {
    if (!log && needed && given->empty()) {
      return Error{.code = ErrorCode::missing,
                   .parameter = {},
                   .message = "it is required for a table, as " + file + " is: name its columns",
                   .place = name};
    }
    if (log && !given->empty()) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = {},
                   .message = "the log " + file + " names its own columns: leave it out",
                   .place = name};
    }
  }
  if (log) return arm_identification::read_rig_log(file, joints);
  auto recording = arm_identification::read_arm(file, options.columns(), joints);
  if (!recording) return recording.error();
  return std::vector{*std::move(recording)};
}

namespace {

/// Three numbers; none of what is something else.
std::optional<arm::Gravity> gravity_of(const std::vector<std::string>& words) {
  std::array<double, 3> numbers{};
  if (words.size() != numbers.size()) return std::nullopt;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const char* const end = words[i].data() + words[i].size();
    const char* const from = words[i].data() + (words[i].starts_with('+') ? 1 : 0);
    const auto read = std::from_chars(from, end, numbers[i]);
    if (read.ec != std::errc{} || read.ptr != end) return std::nullopt;
  }
  return arm::Gravity{numbers[0], numbers[1], numbers[2]};
}

/// The joint counts the other way: its axis, its limits.
Check reverse(urdf::Arm& arm, const std::string& name) {
  const auto found = std::find(arm.joints.begin(), arm.joints.end(), name);
  if (found == arm.joints.end()) {
    return Error{.code = ErrorCode::unknown_key,
                 .parameter = {},
                 .message = "'" + name + "' is no moving joint of the arm; it has " + joined_by_commas(arm.joints),
                 .place = "--reverse"};
  }
  arm::JointParams& joint = arm.params.joints[static_cast<std::size_t>(found - arm.joints.begin())];
  joint.axis = {-joint.axis.x, -joint.axis.y, -joint.axis.z};
  joint.limits.lower_rad = -std::exchange(joint.limits.upper_rad, -joint.limits.lower_rad);
  return {};
}

/// A point mass on the last link.
Check load(urdf::Arm& arm, const std::vector<double>& payload) {
  const auto refused = [](ErrorCode code, std::string message) {
    return Error{.code = code, .parameter = {}, .message = std::move(message), .place = "--payload"};
  };
  if (payload.size() != 1 && payload.size() != 4) {
    return refused(ErrorCode::syntax, std::to_string(payload.size()) +
                                          " numbers are neither a mass nor a mass and its place: write KG or KG,X,Y,Z");
  }
  const double mass_kg = payload.front();
  constexpr double heaviest_kg = 1e4, farthest_m = 10.0;
  if (!(mass_kg > 0.0) || mass_kg > heaviest_kg) {
    return refused(ErrorCode::out_of_bounds,
                   rounded_number(mass_kg) + " kg must be above 0 and at most " + rounded_number(heaviest_kg) + " kg");
  }
  arm::Vector3 at = arm.frames.back().back().origin_m;
  if (payload.size() == 4) at = {payload[1], payload[2], payload[3]};
  if (!(at.norm() <= farthest_m)) {
    return refused(ErrorCode::out_of_bounds, "a place " + rounded_number(at.norm()) +
                                                 " m from the last link must be at most " + rounded_number(farthest_m) +
                                                 " m away: write metres");
  }
  arm::Body& body = arm.params.joints[arm.params.joints.size() - 1].body;
  arm::BodyVector sums = arm::linear_parameters(body);
  sums[0] += mass_kg;
  sums.segment<3>(1) += mass_kg * at;
  const arm::Matrix3 inertia = mass_kg * (at.squaredNorm() * arm::Matrix3::Identity() - at * at.transpose());
  sums.tail<6>() += (arm::BodyVector() << 0, 0, 0, 0, inertia(0, 0), inertia(0, 1), inertia(0, 2), inertia(1, 1),
                     inertia(1, 2), inertia(2, 2))
                        .finished()
                        .tail<6>();
  body = arm::body_of(sums);
  return {};
}

}  // namespace

Result<urdf::Arm> read_arm_urdf(const ArmUrdfOptions& options) {
  arm::Gravity gravity;
  if (!options.gravity.empty() && !options.gravity_is_free()) {
    const auto stated = gravity_of(options.gravity);
    if (!stated) {
      return Error{.code = ErrorCode::syntax,
                   .parameter = {},
                   .message = "'" + joined_by_commas(options.gravity) +
                              "' is not three numbers in m/s^2; write for instance --gravity 9.81,0,0",
                   .place = "--gravity"};
    }
    gravity = *stated;
  }
  if (Check wrong = validate(gravity)) {
    Error error = *std::move(wrong);
    error.place = "--gravity";
    return error;
  }
  auto arm = urdf::read(options.file, options.tip);
  if (!arm) return arm;
  for (const auto* warnings : {&arm->warnings, &arm->doubtful_limits}) {
    for (const std::string& warning : *warnings) message_stream() << "Warning: " << warning << "\n";
  }
  arm->params.gravity = gravity;
  for (const std::string& joint : options.reversed) {
    if (Check wrong = reverse(*arm, joint)) return *std::move(wrong);
  }
  if (!options.payload.empty()) {
    if (Check wrong = load(*arm, options.payload)) return *std::move(wrong);
  }
  warn_of_weight(*arm);
  return arm;
}

void add_arm_urdf_options(CLI::App& verb, ArmUrdfOptions& options, bool finds_gravity) {
  verb.add_option("--urdf", options.file, "URDF of the arm")->required()->type_name("FILE");
  verb.add_option("--tip", options.tip, "Last link of the arm, if the URDF continues or branches")->type_name("LINK");
  auto* gravity = verb.add_option("--gravity", options.gravity,
                                  std::string("Gravity in the frame of the base, in m/s^2; 0,0,-9.81 by default") +
                                      (finds_gravity ? "; 'free' finds its direction" : ""))
                      ->type_name(finds_gravity ? "X,Y,Z|free" : "X,Y,Z")
                      ->delimiter(',');
  if (finds_gravity) {
    gravity->expected(1, 3);
  } else {
    gravity->expected(3);
  }
  verb.add_option("--reverse", options.reversed, "Joint that counts the other way than the URDF; may be given again")
      ->type_name("JOINT")
      ->delimiter(',')
      ->allow_extra_args(false);
  verb.add_option(
          "--payload", options.payload,
          "Mass on the last link that the URDF lacks, in kg, and its place in m in the frame of the last moving "
          "link; at the tip by default")
      ->type_name("KG[,X,Y,Z]")
      ->delimiter(',')
      ->allow_extra_args(false);
}

void add_arm_options(CLI::App& verb, ArmOptions& options, const std::string& command, const std::string& out_help) {
  const auto add = [&](const char* name, std::vector<std::string>& into, const char* help) {
    return verb.add_option(name, into, help)->type_name("COLUMNS")->allow_extra_args(false);
  };
  add("--time", options.time, "Time column of a table: its name, its number from 1, or two as sec,nanosec");
  verb.add_option("--time-unit", options.time_unit, "Unit of the times, if the file does not state it")
      ->type_name("UNIT")
      ->check(CLI::IsMember({"s", "ms", "us", "ns"}));
  add("--position", options.position, "Position columns: q1,q2,... or a range such as q1:q6 or 2:7");
  add("--velocity", options.velocity, "Velocity columns; by default derived from the positions");
  add("--effort", options.effort, "Columns of the motor torques or currents");
  add_output_options(verb, options.output, command, out_help);
}

}  // namespace tactus::cli
