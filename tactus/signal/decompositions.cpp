#include <tactus/signal/decompositions.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

namespace tactus::signal {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd solve_least_squares(const MatrixXd& a, const VectorXd& b) {
  return Eigen::ColPivHouseholderQR<MatrixXd>(a).solve(b);
}

VectorXd solve_definite(const MatrixXd& a, const VectorXd& b) { return Eigen::LDLT<MatrixXd>(a).solve(b); }

MatrixXd inverse_of_definite(const MatrixXd& a) {
  return Eigen::LDLT<MatrixXd>(a).solve(MatrixXd::Identity(a.rows(), a.cols()));
}

MatrixXd inverse(const MatrixXd& a) { return a.inverse(); }

SymmetricEigen symmetric_eigen(const MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(a);
  return {.values = solver.eigenvalues(), .vectors = solver.eigenvectors()};
}

VectorXd symmetric_eigenvalues(const MatrixXd& a) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(a, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace tactus::signal
