// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

/// What fits and analyses need of decomposed matrices. Compiled once, because the templates behind them take the
/// compiler long. Cold: all of these allocate. Every number must be finite.
namespace tactus::signal {

/// The x of least |a·x − b|, by QR with pivoted columns; columns that the others explain get what the pivots leave.
/// `a` has as many rows as `b`.
Eigen::VectorXd solve_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
/// The shortest of the x of least |a·x − b|, for each column of `b`, by a complete orthogonal decomposition.
Eigen::MatrixXd solve_shortest(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// Results of least squares, by QR with pivoted columns.
struct Regression {
  std::optional<Eigen::Index> idle;  ///< a column that the others explain: then there is no more
  Eigen::VectorXd x;
  Eigen::VectorXd spread;  ///< the diagonal of (aᵀa)⁻¹
};
/// `smallest_pivot`: over the largest; a column with less is idle.
Regression regress(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double smallest_pivot);
/// How many columns the others do not explain.
Eigen::Index rank(const Eigen::MatrixXd& a, double smallest_pivot);

/// The x of a·x = b for a symmetric, positive definite `a`, by LDLᵀ.
Eigen::VectorXd solve_definite(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
/// The inverse of a symmetric, positive definite matrix, by LDLᵀ.
Eigen::MatrixXd inverse_of_definite(const Eigen::MatrixXd& a);

/// The x of a·x = b for a square `a`, by LU with pivoted rows.
Eigen::MatrixXd solve(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
Eigen::MatrixXcd complex_solve(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b);
/// The inverse of a square matrix, by the same.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< the least first
  Eigen::MatrixXd vectors;  ///< a column each, of length 1
};
/// Of a symmetric matrix, of which the lower half is read.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);
/// The same without vectors.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a);

struct ComplexEigen {
  Eigen::VectorXcd values;   ///< in no order
  Eigen::MatrixXcd vectors;  ///< a column each, of length 1
};
/// Of a square matrix.
ComplexEigen complex_eigen(const Eigen::MatrixXcd& a);
/// The same without vectors.
Eigen::VectorXcd complex_eigenvalues(const Eigen::MatrixXcd& a);

}  // namespace tactus::signal
