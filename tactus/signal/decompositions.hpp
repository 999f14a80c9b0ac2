#pragma once

#include <Eigen/Core>

/// What fits need of decomposed matrices. Compiled once, because the templates behind them take the compiler long.
/// Cold: all of these allocate. Every number must be finite.
namespace tactus::signal {

/// The x of least |a·x − b|, by QR with pivoted columns; columns that the others explain get what the pivots leave.
/// `a` has as many rows as `b`.
Eigen::VectorXd solve_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// The x of a·x = b for a symmetric, positive definite `a`, by LDLᵀ.
Eigen::VectorXd solve_definite(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
/// The inverse of a symmetric, positive definite matrix, by LDLᵀ.
Eigen::MatrixXd inverse_of_definite(const Eigen::MatrixXd& a);

/// The inverse of a square matrix, by LU with pivoted rows.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< the least first
  Eigen::MatrixXd vectors;  ///< a column each, of length 1
};
/// Of a symmetric matrix, of which the lower half is read.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);
/// The same without vectors.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a);

}  // namespace tactus::signal
