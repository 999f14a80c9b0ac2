#include <tactus/arm_identification/data.hpp>
#include <tactus/arm_identification/fit.hpp>
#include <tactus/core/parameters.hpp>
#include <tactus/identification/refusal.hpp>
#include <tactus/signal/random.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include <Eigen/Dense>

namespace tactus::arm_identification {
namespace {

using identification::inconsistent;

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double most_rows = 12'000.0;
constexpr double rows_per_cutoff = 4.0;
constexpr double normal_95 = 1.96;
constexpr int rounds = 4;
constexpr int folds = 4;
constexpr double worthwhile = 0.98;      ///< of the error: what a further friction term must bring it to
constexpr double usual_torque = 0.4;     ///< scales from here to its inverse are those of torques
constexpr double scale_deviation = 0.1;  ///< of the logarithm of a torque's scale, where it is not known
constexpr double current_deviation = 0.7;
constexpr double worth_a_scale = 0.97;
constexpr double least_explained = 0.75;  ///< relative residual beyond which a model is refused
constexpr double threshold_margin = 1.25;

double rms(const VectorXd& values) { return std::sqrt(values.squaredNorm() / static_cast<double>(values.size())); }

std::string short_text(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.2g", value);
  return buffer.data();
}

/// Which rows: from, and how many.
struct Span {
  Index first;
  Index count;
};

struct Fit {
  ConsistentFit found;
  std::vector<FrictionShape> shapes;
};

JointSums sums_of(const MatrixXd& bodies, const MatrixXd& local, const VectorXd& effort) {
  const Index own = bodies.cols();
  JointSums sums;
  sums.normal.resize(own + local.cols(), own + local.cols());
  sums.normal.topLeftCorner(own, own) = bodies.transpose() * bodies;
  sums.normal.topRightCorner(own, local.cols()) = bodies.transpose() * local;
  sums.normal.bottomLeftCorner(local.cols(), own) = sums.normal.topRightCorner(own, local.cols()).transpose();
  sums.normal.bottomRightCorner(local.cols(), local.cols()) = local.transpose() * local;
  sums.right.resize(own + local.cols());
  sums.right << bodies.transpose() * effort, local.transpose() * effort;
  sums.squares = effort.squaredNorm();
  sums.rows = static_cast<double>(effort.size());
  return sums;
}

/// How many rows in a row say about the same: 1 + 2·(sum of the autocorrelation), as long as that is there.
double correlation_of(const VectorXd& residual) {
  const double squares = residual.squaredNorm();
  double sum = 1.0;
  for (Index lag = 1; lag < residual.size() / 20 && squares > 0.0; ++lag) {
    const double rho = residual.head(residual.size() - lag).dot(residual.tail(residual.size() - lag)) / squares;
    if (rho < 0.05) break;
    sum += 2.0 * rho;
  }
  return sum;
}

VectorXd least_squares(const MatrixXd& columns, const VectorXd& right) {
  return Eigen::ColPivHouseholderQR<MatrixXd>(columns).solve(right);
}

/// What is left of `right` where each of four blocks is judged by the fit of the other three.
double cross_validated(const MatrixXd& columns, const VectorXd& right) {
  double squares = 0.0;
  const Index rows = right.size();
  for (Index fold = 0; fold < folds; ++fold) {
    const Index first = rows * fold / folds;
    const Index count = rows * (fold + 1) / folds - first;
    MatrixXd others(rows - count, columns.cols());
    VectorXd others_right(rows - count);
    others << columns.topRows(first), columns.bottomRows(rows - first - count);
    others_right << right.head(first), right.tail(rows - first - count);
    const VectorXd found = least_squares(others, others_right);
    squares += (right.segment(first, count) - columns.middleRows(first, count) * found).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(rows));
}

FrictionShape choose_shape(const ArmData& data, int joint, const ConsistentFit& fit, Span span) {
  const VectorXd rigid = data.rigid_torque(joint, fit);
  const VectorXd left =
      (data.effort.col(joint) / fit.scales[static_cast<std::size_t>(joint)] - rigid).segment(span.first, span.count);
  const auto error_of = [&](const FrictionShape& shape) {
    const MatrixXd all = data.local(joint, shape, rigid).middleRows(span.first, span.count);
    std::vector<Index> used{1, 2, 3};
    if (shape.load) used.push_back(4);
    if (shape.stribeck >= 0) used.push_back(5);
    MatrixXd columns(span.count, static_cast<Index>(used.size()));
    for (std::size_t i = 0; i < used.size(); ++i) columns.col(static_cast<Index>(i)) = all.col(used[i]);
    return cross_validated(columns, left);
  };
  FrictionShape best;
  double least = error_of(best);
  const auto consider = [&](const FrictionShape& shape, double margin) {
    const double error = error_of(shape);
    if (error >= margin * least) return;
    least = error;
    best = shape;
  };
  for (std::size_t d = 0; d < ArmData::directions.size(); ++d) consider({.direction = d}, 1.0);
  FrictionShape with_load = best;
  with_load.load = true;
  consider(with_load, worthwhile);
  const FrictionShape so_far = best;
  for (int s = 0; s < static_cast<int>(ArmData::slownesses.size()); ++s) {
    FrictionShape with_excess = so_far;
    with_excess.stribeck = s;
    consider(with_excess, worthwhile);
  }
  return best;
}

/// The whole fit on some of the rows, none of which sees the others.
Fit fit_rows(const ArmData& data, Span span, std::vector<JointPrior> priors, bool scales_known) {
  const int count = data.joints();
  Fit fit{.found = {}, .shapes = std::vector<FrictionShape>(static_cast<std::size_t>(count))};
  std::vector<double> noise;
  std::vector<double> correlation(static_cast<std::size_t>(count), 1.0);
  for (int j = 0; j < count; ++j) {
    noise.push_back(0.1 * rms(data.effort.col(j).segment(span.first, span.count)) + 1e-12);
  }
  if (scales_known) {
    for (JointPrior& prior : priors) prior.scale_deviation = 0.0;
  }
  std::vector<VectorXd> rigid(static_cast<std::size_t>(count), VectorXd::Zero(data.rows()));
  for (int round = 0; round < rounds; ++round) {
    std::vector<JointSums> sums;
    for (int j = 0; j < count; ++j) {
      const auto at = static_cast<std::size_t>(j);
      const MatrixXd local = data.local(j, fit.shapes[at], rigid[at]);
      priors[at].load = fit.shapes[at].load;
      priors[at].stribeck = fit.shapes[at].stribeck >= 0;
      sums.push_back(sums_of(data.bodies[at].middleRows(span.first, span.count),
                             local.middleRows(span.first, span.count),
                             data.effort.col(j).segment(span.first, span.count)));
    }
    fit.found = fit_consistently(sums, priors, noise, correlation);
    for (int j = 0; j < count; ++j) {
      const auto at = static_cast<std::size_t>(j);
      rigid[at] = data.rigid_torque(j, fit.found);
      const VectorXd left =
          (data.effort.col(j) - data.predicted(j, fit.found, fit.shapes[at])).segment(span.first, span.count);
      noise[at] = std::max(rms(left), 1e-6 * rms(data.effort.col(j)) + 1e-12);
      correlation[at] = correlation_of(left);
      if (round < 2) fit.shapes[at] = choose_shape(data, j, fit.found, span);
    }
  }
  return fit;
}

VectorXd residual_of(const ArmData& data, const Fit& fit, int joint, Span span) {
  return (data.effort.col(joint) - data.predicted(joint, fit.found, fit.shapes[static_cast<std::size_t>(joint)]))
      .segment(span.first, span.count);
}

/// Of each joint, what ordinary least squares leaves over `judged` when it has seen `seen`: all joints together, base
/// parameters by leaving out what the data do not tell, friction with the sign of the velocity.
std::vector<double> ordinary_least_squares(const ArmData& data, Span seen, Span judged) {
  const Index count = data.joints();
  const Index body = data.bodies.front().cols();
  const Index own = 4;
  const FrictionShape shape{.direction = 0};
  MatrixXd normal = MatrixXd::Zero(body + own * count, body + own * count);
  VectorXd right = VectorXd::Zero(normal.rows());
  std::vector<MatrixXd> locals;
  for (Index j = 0; j < count; ++j) {
    const auto at = static_cast<std::size_t>(j);
    locals.push_back(data.local(static_cast<int>(j), shape, VectorXd::Zero(data.rows())).leftCols(own));
    const JointSums sums =
        sums_of(data.bodies[at].middleRows(seen.first, seen.count), locals.back().middleRows(seen.first, seen.count),
                data.effort.col(j).segment(seen.first, seen.count));
    const Index place = body + own * j;
    normal.topLeftCorner(body, body) += sums.normal.topLeftCorner(body, body);
    normal.block(0, place, body, own) = sums.normal.topRightCorner(body, own);
    normal.block(place, 0, own, body) = sums.normal.bottomLeftCorner(own, body);
    normal.block(place, place, own, own) = sums.normal.bottomRightCorner(own, own);
    right.head(body) += sums.right.head(body);
    right.segment(place, own) = sums.right.tail(own);
  }
  VectorXd lengths = normal.diagonal().cwiseSqrt();
  for (double& length : lengths) length = length > 0.0 ? 1.0 / length : 0.0;
  const MatrixXd scaled = lengths.asDiagonal() * normal * lengths.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(scaled);
  const double least = 1e-9 * solver.eigenvalues().maxCoeff();
  const VectorXd inverse = solver.eigenvalues().unaryExpr([=](double v) { return v > least ? 1.0 / v : 0.0; });
  const VectorXd found =
      lengths.asDiagonal() * (solver.eigenvectors() * (inverse.asDiagonal() * (solver.eigenvectors().transpose() *
                                                                               (lengths.asDiagonal() * right))));
  std::vector<double> relative;
  for (Index j = 0; j < count; ++j) {
    const auto at = static_cast<std::size_t>(j);
    const VectorXd effort = data.effort.col(j).segment(judged.first, judged.count);
    const VectorXd left = effort - data.bodies[at].middleRows(judged.first, judged.count) * found.head(body) -
                          locals[at].middleRows(judged.first, judged.count) * found.segment(body + own * j, own);
    relative.push_back(rms(left) / rms(effort));
  }
  return relative;
}

/// What one joint's effort says of the URDF's bodies before anything is fitted.
struct FirstLook {
  double scale = 0.0;         ///< effort for a N m
  double share = 0.0;         ///< of the effort that the URDF's bodies make, by their rms and this scale
  double friction_share = 0;  ///< the same of Coulomb friction, negative where it would give energy
  double explained = 0.0;     ///< share of the effort's squares about zero
};

FirstLook look(const ArmData& data, const VectorXd& bodies, int joint, int effort_of) {
  const auto at = static_cast<std::size_t>(joint);
  const VectorXd torque = data.bodies[at] * bodies;
  const VectorXd effort = data.effort.col(effort_of);
  MatrixXd columns(data.rows(), 5);
  columns << torque, data.local(joint, {}, torque).leftCols(4);
  const VectorXd found = least_squares(columns, effort);
  FirstLook result;
  const double size = rms(effort);
  if (!(size > 0.0)) return result;
  result.scale = found[0];
  result.share = found[0] * rms(torque) / size;
  result.friction_share = found[2] * rms(columns.col(2)) / size;
  result.explained = 1.0 - (effort - columns * found).squaredNorm() / effort.squaredNorm();
  return result;
}

Check check_efforts(const ArmData& data, const VectorXd& bodies, const std::vector<std::string>& joints,
                    const ArmRecording& recording) {
  const int count = data.joints();
  constexpr double clearly = 0.3;
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (!(rms(data.effort.col(i)) > 0.0)) {
      return inconsistent("effort", "the effort of joint '" + joints[at] + "' (column '" + recording.effort_names[at] +
                                        "') is 0 throughout; name another column");
    }
    for (int k = i + 1; k < count; ++k) {
      const double left = 2.0 - look(data, bodies, i, i).explained - look(data, bodies, k, k).explained;
      const double exchanged = 2.0 - look(data, bodies, i, k).explained - look(data, bodies, k, i).explained;
      if (left < 0.1 || left < 3.0 * exchanged) continue;
      return inconsistent("effort", "the efforts of joints '" + joints[at] + "' and '" +
                                        joints[static_cast<std::size_t>(k)] + "' (columns '" +
                                        recording.effort_names[at] + "' and '" +
                                        recording.effort_names[static_cast<std::size_t>(k)] +
                                        "') look swapped: each fits the other joint; exchange them");
    }
    const FirstLook own = look(data, bodies, i, i);
    if (own.share < -clearly || own.friction_share < -clearly) {
      return inconsistent("effort", "the effort of joint '" + joints[at] + "' (column '" + recording.effort_names[at] +
                                        "') has the wrong sign: it must push toward +position as the URDF has it; turn "
                                        "the column round");
    }
  }
  return {};
}

std::vector<JointPrior> priors_of(const ArmData& data, const arm::Chain& chain, const arm::Chain::Params& urdf,
                                  const VectorXd& bodies, bool& scaled) {
  const int count = data.joints();
  std::vector<FirstLook> looks;
  scaled = false;
  for (int j = 0; j < count; ++j) {
    looks.push_back(look(data, bodies, j, j));
    const bool clear = looks.back().share > 0.3;
    scaled = scaled || (clear && (looks.back().scale < usual_torque || looks.back().scale > 1.0 / usual_torque));
  }
  const arm::JointMatrix mass = chain.mass_matrix(arm::JointVector::Zero(count));
  std::vector<JointPrior> priors;
  for (int j = 0; j < count; ++j) {
    const auto at = static_cast<std::size_t>(j);
    const arm::JointParams& joint = urdf.joints[at];
    const FirstLook& seen = looks[at];
    JointPrior prior;
    prior.body = joint.body;
    if (scaled) {
      const double by_size = rms(data.effort.col(j)) / std::max(rms(data.bodies[at] * bodies), 1e-9);
      prior.scale = seen.share > 0.3 ? seen.scale : by_size;
      prior.scale_deviation = current_deviation;
    } else {
      prior.scale_deviation = scale_deviation;
    }
    prior.torque = rms(data.effort.col(j)) / prior.scale;
    const double armature = joint.drive.reflected_kg_m2();
    prior.armature = armature > 0.0 ? armature : std::max(0.1 * mass(j, j), 1e-6);
    prior.coulomb = joint.friction.coulomb_N_m > 0.0 ? joint.friction.coulomb_N_m : 0.1 * prior.torque;
    prior.viscous = joint.friction.viscous_N_m_s_per_rad > 0.0 ? joint.friction.viscous_N_m_s_per_rad
                                                               : 0.1 * prior.torque / data.speed[at];
    priors.push_back(prior);
  }
  return priors;
}

/// How many combinations of parameters torques depend on, from the singular values of the regressor at random states.
int base_parameters_of(const arm::Chain& chain) {
  signal::Random random(1);
  const Index joints = chain.joints();
  constexpr Index states = 60;
  MatrixXd rows(states * joints, (arm::joint_parameters - 3) * joints);
  const auto draw = [&] {
    arm::JointVector v(joints);
    for (double& value : v) value = 6.0 * random.uniform() - 3.0;
    return v;
  };
  for (Index i = 0; i < states; ++i) {
    const arm::JointVector q = draw();
    const arm::JointVector v = draw();
    const arm::Regressor regressor = chain.regressor(q, v, draw());
    for (Index j = 0; j < joints; ++j) {
      // Bodies and armatures.
      rows.block(i * joints, (arm::joint_parameters - 3) * j, joints, arm::joint_parameters - 3) =
          regressor.middleCols(arm::joint_parameters * j, arm::joint_parameters - 3);
    }
  }
  Eigen::ColPivHouseholderQR<MatrixXd> qr(rows);
  qr.setThreshold(1e-9);
  return static_cast<int>(qr.rank());
}

/// Directions of the coordinates in which the data leave at most half of the prior's variance.
int told_of(const ConsistentFit& fit) {
  const VectorXd firmness = fit.prior_deviations.cwiseInverse();
  const MatrixXd whitened = firmness.asDiagonal() * fit.covariance * firmness.asDiagonal();
  const VectorXd left = Eigen::SelfAdjointEigenSolver<MatrixXd>(whitened, Eigen::EigenvaluesOnly).eigenvalues();
  return static_cast<int>((left.array() < 0.5).count());
}

void add_parameters(const ConsistentFit& fit, const ConsistentFit& nothing, int joint, const FrictionShape& shape,
                    std::vector<ArmParameter>& into) {
  struct Row {
    const char* name;
    const char* unit;
    int place;
  };
  static constexpr std::array<Row, 16> rows{{{"mass", "kg", 0},
                                             {"first_moment_x", "kg m", 1},
                                             {"first_moment_y", "kg m", 2},
                                             {"first_moment_z", "kg m", 3},
                                             {"inertia_xx", "kg m^2", 4},
                                             {"inertia_xy", "kg m^2", 5},
                                             {"inertia_xz", "kg m^2", 6},
                                             {"inertia_yy", "kg m^2", 7},
                                             {"inertia_yz", "kg m^2", 8},
                                             {"inertia_zz", "kg m^2", 9},
                                             {"armature", "kg m^2", 10},
                                             {"coulomb", "N m", 11},
                                             {"viscous", "N m s/rad", 12},
                                             {"offset", "N m", 13},
                                             {"load", "", 14},
                                             {"stribeck", "N m", 15}}};
  for (const Row& row : rows) {
    if ((row.place == 14 && !shape.load) || (row.place == 15 && shape.stribeck < 0)) continue;
    const bool own = row.place >= arm::body_parameters;
    const double value =
        own ? fit.local[static_cast<std::size_t>(joint)][static_cast<std::size_t>(row.place - arm::body_parameters)]
            : fit.bodies[arm::body_parameters * joint + row.place];
    const double deviation = fit.deviation(joint, row.place);
    const double before = nothing.deviation(joint, row.place);
    ArmParameter parameter{.name = row.name, .unit = row.unit, .value = value};
    const bool exponential = own && row.place != 13 && row.place != 15;
    const double factor = exponential && value > 0.0 ? std::exp(normal_95 * deviation / value) : 1.0;
    parameter.lower = exponential ? value / factor : value - normal_95 * deviation;
    parameter.upper = exponential ? value * factor : value + normal_95 * deviation;
    parameter.told =
        exponential ? deviation / value <= 0.5 * before /
                                               nothing.local[static_cast<std::size_t>(joint)]
                                                            [static_cast<std::size_t>(row.place - arm::body_parameters)]
                    : deviation <= 0.5 * before;
    into.push_back(parameter);
  }
}

ArmModel model_of(const ArmData& data, const Fit& fit, const std::vector<std::string>& joints,
                  const arm::Chain::Params& urdf, double cutoff_Hz, const std::vector<double>& thresholds) {
  ArmModel model{
      .head = {.joints = static_cast<std::int64_t>(joints.size()), .cutoff_Hz = cutoff_Hz, .gravity = urdf.gravity},
      .joints = Joints<ArmJointModel>(joints.size())};
  for (std::size_t j = 0; j < joints.size(); ++j) {
    ArmJointModel& joint = model.joints[j];
    const FrictionShape& shape = fit.shapes[j];
    const auto& local = fit.found.local[j];
    joint.name = joints[j];
    joint.effort_per_N_m = fit.found.scales[j];
    joint.residual_rms_N_m = fit.found.residual_rms[j] / fit.found.scales[j];
    joint.contact_threshold_N_m = thresholds[j] / fit.found.scales[j];
    joint.arm = urdf.joints[j];
    joint.arm.body =
        arm::body_of(fit.found.bodies.segment<arm::body_parameters>(arm::body_parameters * static_cast<Index>(j)));
    joint.arm.drive = {.armature_kg_m2 = local[0], .rotor_inertia_kg_m2 = 0.0, .gear_ratio = 1.0};
    joint.arm.friction = {.coulomb_N_m = local[1],
                          .viscous_N_m_s_per_rad = local[2],
                          .offset_N_m = local[3],
                          .load = shape.load ? local[4] : 0.0,
                          .stribeck_N_m = shape.stribeck >= 0 ? local[5] : 0.0,
                          .velocity_scale_rad_per_s = ArmData::directions[shape.direction] * data.speed[j]};
    if (shape.stribeck >= 0) {
      joint.arm.friction.stribeck_velocity_rad_per_s =
          ArmData::slownesses[static_cast<std::size_t>(shape.stribeck)] * data.speed[j];
    }
  }
  return model;
}

}  // namespace

Result<ArmIdentification> identify_arm(std::span<const ArmRecording> recordings, const std::vector<std::string>& joints,
                                       const arm::Chain::Params& urdf, std::optional<double> cutoff_Hz) {
  const auto chain = arm::Chain::make(urdf);
  if (!chain) return chain.error();
  ArmIdentification result;
  double slowest_s = 0.0;
  for (const ArmRecording& recording : recordings) {
    slowest_s = std::max(slowest_s, recording.sample_time.value);
    result.duration_s += recording.sample_time.value * static_cast<double>(recording.samples());
  }
  result.cutoff_Hz = cutoff_Hz.value_or(std::min(default_arm_cutoff_Hz, 0.1 / slowest_s));
  std::vector<ArmMotion> motions;
  const double rows_per_s = std::min(rows_per_cutoff * result.cutoff_Hz, most_rows / result.duration_s);
  for (const ArmRecording& recording : recordings) {
    auto motion = ArmMotion::make(recording, result.cutoff_Hz, rows_per_s, joints);
    if (!motion) return motion.error();
    motions.push_back(*std::move(motion));
  }
  const ArmData data(*chain, motions);
  result.base_parameters = base_parameters_of(*chain);
  const auto in_file = [&](Error error) {
    error.place = recordings.front().file.string();
    return error;
  };
  // Half of the rows say something new at this rate, half are held out, and a number needs two.
  if (static_cast<double>(data.rows() * data.joints()) < 8.0 * (result.base_parameters + 3 * data.joints())) {
    return in_file(inconsistent(short_text(result.duration_s) + " s are too short to tell " +
                                std::to_string(result.base_parameters) +
                                " parameters and friction, and to hold half of it out; record more motion"));
  }
  VectorXd bodies(arm::body_parameters * data.joints());
  for (Index j = 0; j < data.joints(); ++j) {
    bodies.segment<arm::body_parameters>(arm::body_parameters * j) =
        arm::linear_parameters(urdf.joints[static_cast<std::size_t>(j)].body);
  }
  if (Check wrong = check_efforts(data, bodies, joints, recordings.front())) return in_file(*std::move(wrong));

  const std::vector<JointPrior> priors = priors_of(data, *chain, urdf, bodies, result.scaled_efforts);
  const Span all{0, data.rows()};
  const Span seen{0, data.rows() / 2};
  const Span judged{seen.count, data.rows() - seen.count};
  if (!result.scaled_efforts) {
    const Fit as_torques = fit_rows(data, seen, priors, true);
    const Fit free = fit_rows(data, seen, priors, false);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const bool better = free.found.residual_rms[j] < worth_a_scale * as_torques.found.residual_rms[j];
      result.scaled_efforts = result.scaled_efforts || better;
    }
  }
  const Fit half = fit_rows(data, seen, priors, !result.scaled_efforts);
  const Fit whole = fit_rows(data, all, priors, !result.scaled_efforts);
  const std::vector<double> ordinary = ordinary_least_squares(data, seen, judged);
  std::vector<JointSums> no_sums;
  const Index columns = bodies.size() + local_parameters;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    no_sums.push_back({MatrixXd::Zero(columns, columns), VectorXd::Zero(columns), 0.0, 1.0});
  }
  std::vector<JointPrior> used = priors;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    used[j].load = whole.shapes[j].load;
    used[j].stribeck = whole.shapes[j].stribeck >= 0;
  }
  const ConsistentFit nothing = fit_consistently(no_sums, used, std::vector<double>(joints.size(), 1.0), {});

  std::vector<double> thresholds;
  for (int j = 0; j < data.joints(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    const VectorXd left = residual_of(data, whole, j, all);
    const VectorXd held_out = residual_of(data, half, j, judged);
    ArmJointFit fit{.name = joints[at]};
    fit.effort_rms = rms(data.effort.col(j));
    fit.residual_rms = rms(left);
    fit.relative = fit.residual_rms / fit.effort_rms;
    fit.held_out_relative = rms(held_out) / rms(data.effort.col(j).segment(judged.first, judged.count));
    fit.least_squares_relative = ordinary[at];
    const double bound = normal_95 * half.found.residual_rms[at];
    fit.held_out_coverage = (held_out.array().abs() <= bound).cast<double>().mean();
    fit.effort_per_N_m = whole.found.scales[at];
    if (fit.relative > least_explained) {
      return in_file(inconsistent(
          "effort", "the model leaves " + short_text(100.0 * fit.relative) + " % of the effort of joint '" +
                        joints[at] + "' (column '" + recordings.front().effort_names[at] +
                        "'): are columns swapped, was something touched, or is this the URDF of another arm?"));
    }
    add_parameters(whole.found, nothing, j, whole.shapes[at], fit.parameters);
    thresholds.push_back(threshold_margin * std::max(left.cwiseAbs().maxCoeff(), held_out.cwiseAbs().maxCoeff()));
    result.joints.push_back(std::move(fit));
  }
  result.told_combinations = told_of(whole.found);
  result.model = model_of(data, whole, joints, urdf, result.cutoff_Hz, thresholds);
  return result;
}

}  // namespace tactus::arm_identification
