// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/nonlinear_fit.hpp>
#include <tactus/identification/axis/refusal.hpp>
#include <tactus/kernel/signal/decompositions.hpp>

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Dense>
#include <unsupported/Eigen/NonLinearOptimization>

namespace tactus::identification {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double difference = 1e-3;
constexpr Index score_blocks = 20;
/// A variable whose column, less what the others explain, is shorter than this part of the longest tells nothing.
constexpr double smallest_column = 1e-7;
constexpr double beyond_any = 1e100;

/// Residuals and Jacobian of the first `free` variables, as Eigen's solver asks for them: those of the problem, then
/// one for each variable with a prior.
class Functor {
 public:
  Functor(const NonlinearProblem& problem, Index free, Index rows)
      : problem_(problem), variables_(problem.start), free_(free), rows_(rows + priors(problem)) {}
  static Index priors(const NonlinearProblem& problem) {
    return std::count_if(problem.prior_deviation.begin(), problem.prior_deviation.end(),
                         [](double deviation) { return deviation > 0.0; });
  }
  [[nodiscard]] Index values() const { return rows_; }
  [[nodiscard]] Index inputs() const { return free_; }

  /// Where the model is no model the residuals are beyond any: a step there is taken back, and the fit goes on.
  int operator()(const VectorXd& x, VectorXd& residuals) {
    residuals = at(x);
    if (!residuals.allFinite()) residuals.setConstant(beyond_any);
    return 0;
  }
  int df(const VectorXd& x, MatrixXd& jacobian) {
    jacobian = columns(x, at(x), 0, free_);
    return jacobian.allFinite() ? 0 : -1;
  }
  /// Derivatives with respect to the variables from `first` to before `end`.
  MatrixXd columns(const VectorXd& x, const VectorXd& here, Index first, Index end) {
    MatrixXd jacobian(rows_, end - first);
    for (Index column = first; column < end; ++column) {
      auto& variable = variables_[static_cast<std::size_t>(column)];
      put(x);
      const double before = variable;
      variable = before + difference;
      jacobian.col(column - first) = (evaluate() - here) / difference;
      variable = before;
    }
    return jacobian;
  }
  VectorXd at(const VectorXd& x) {
    put(x);
    return evaluate();
  }
  [[nodiscard]] int evaluations() const { return evaluations_; }

 private:
  void put(const VectorXd& x) {
    for (Index i = 0; i < free_; ++i) variables_[static_cast<std::size_t>(i)] = x[i];
  }
  VectorXd evaluate() {
    ++evaluations_;
    std::vector<double> residuals = problem_.residuals(variables_);
    for (std::size_t i = 0; i < problem_.prior_deviation.size(); ++i) {
      const double deviation = problem_.prior_deviation[i];
      if (deviation > 0.0) residuals.push_back((variables_[i] - problem_.prior_middle[i]) / deviation);
    }
    return Eigen::Map<const VectorXd>(residuals.data(), static_cast<Index>(residuals.size()));
  }

  const NonlinearProblem& problem_;
  std::vector<double> variables_;
  Index free_, rows_;
  int evaluations_ = 0;
};

/// Σ over blocks of (Jᵀr)(Jᵀr)ᵀ, corrected for the degrees of freedom that the fit has used up.
MatrixXd scatter(const MatrixXd& jacobian, const VectorXd& residuals) {
  const Index count = std::min(score_blocks, residuals.size());
  MatrixXd sum = MatrixXd::Zero(jacobian.cols(), jacobian.cols());
  for (Index block = 0; block < count; ++block) {
    const Index first = block * residuals.size() / count, end = (block + 1) * residuals.size() / count;
    const VectorXd score = jacobian.middleRows(first, end - first).transpose() * residuals.segment(first, end - first);
    sum += score * score.transpose();
  }
  const auto freedom = static_cast<double>(std::max<Index>(1, count - jacobian.cols()));
  return sum * (static_cast<double>(count) / freedom);
}

}  // namespace

Result<NonlinearFit> fit_nonlinear(const NonlinearProblem& problem) {
  const auto all = static_cast<Index>(problem.start.size());
  const auto given = static_cast<Index>(problem.given);
  const Index free = all - given;
  const std::vector<double> first = problem.residuals(problem.start);
  const auto rows = static_cast<Index>(first.size());
  if (free <= 0 || rows <= free) {
    return inconsistent(std::to_string(rows) + " residuals cannot determine " + std::to_string(free) + " variables");
  }
  Functor functor(problem, free, rows);
  VectorXd x = Eigen::Map<const VectorXd>(problem.start.data(), free);
  if (!functor.at(x).allFinite()) {
    return inconsistent("the model is no model where the fit starts: start nearer to the device");
  }
  Eigen::LevenbergMarquardt<Functor> solver(functor);
  solver.parameters.factor = 0.5;  // the longest first step, in units of the variables
  solver.parameters.xtol = 1e-6;
  solver.parameters.ftol = 1e-9;
  solver.parameters.maxfev = 40;
  solver.useExternalScaling = true;
  solver.diag = VectorXd::Ones(free);
  solver.minimize(x);

  const VectorXd residuals = functor.at(x);
  const MatrixXd jacobian = functor.columns(x, residuals, 0, free);
  if (!residuals.allFinite() || !jacobian.allFinite()) return inconsistent("the fit ran away from the data");
  Eigen::ColPivHouseholderQR<MatrixXd> qr;
  qr.setThreshold(smallest_column);
  qr.compute(jacobian);
  if (qr.rank() < free) {
    return Error{ErrorCode::inconsistent,
                 std::to_string(qr.colsPermutation().indices()[qr.rank()]),
                 "the data do not distinguish it from the others: excite the device more richly",
                 {}};
  }
  const MatrixXd inverse = signal::inverse(jacobian.transpose() * jacobian);
  const Index priors = Functor::priors(problem);
  MatrixXd open = scatter(jacobian.topRows(rows), residuals.head(rows));
  open += jacobian.bottomRows(priors).transpose() * jacobian.bottomRows(priors);
  const MatrixXd own = inverse * open * inverse;

  RowMajor covariance = RowMajor::Zero(all, all);
  covariance.topLeftCorner(free, free) = own;
  if (given > 0) {
    const Eigen::Map<const RowMajor> known(problem.given_covariance.data(), given, given);
    const MatrixXd of_given = functor.columns(x, residuals, free, all);
    const MatrixXd sensitivity = -inverse * (jacobian.transpose() * of_given);
    covariance.topLeftCorner(free, free) += sensitivity * known * sensitivity.transpose();
    covariance.topRightCorner(free, given) = sensitivity * known;
    covariance.bottomLeftCorner(given, free) = (sensitivity * known).transpose();
    covariance.bottomRightCorner(given, given) = known;
  }

  NonlinearFit fit;
  fit.found.assign(x.begin(), x.end());
  fit.covariance.assign(covariance.data(), covariance.data() + covariance.size());
  for (Index i = 0; i < free; ++i) fit.own_deviation.push_back(std::sqrt(own(i, i)));
  fit.residual_rms = std::sqrt(residuals.head(rows).squaredNorm() / static_cast<double>(rows));
  fit.evaluations = functor.evaluations();
  return fit;
}

}  // namespace tactus::identification
