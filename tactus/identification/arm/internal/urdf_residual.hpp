// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/urdf_check.hpp>

#include <vector>

#include <Eigen/Dense>

/// What a URDF's bodies leave of the efforts of a recording.
namespace tactus::arm_identification {

/// Inner products of torques, of the columns that a joint has of its own, and of its effort.
Eigen::MatrixXd products(const ArmData& data, const Eigen::MatrixXd& torques, int motion_of, int effort_of);

/// The share of the effort's squares that is left if torques are mixed by `mix`. `products_of_all`: as `products`
/// computes them. `offset`: whether the effort may have one.
double left_of(const Eigen::MatrixXd& products_of_all, const Eigen::VectorXd& mix, double sign, bool torques,
               bool offset = true);

/// Torques that the URDF's bodies need in what was recorded, a column for each joint. [N m]
Eigen::MatrixXd torques_of(const ArmData& data, const arm::Chain::Params& urdf, const std::vector<int>& position_of);

/// The same arm without the inertias of its motors, which each joint fits by itself.
arm::Chain::Params without_armatures(arm::Chain::Params urdf);

/// The sum of the squares of shares.
double total(const std::vector<double>& shares);

/// By joint: the share of the effort that the torques `needed` leave.
std::vector<double> left_with(const ArmData& data, const Eigen::MatrixXd& needed, const Assumption& assumption,
                              bool torques, bool offset = true);

}  // namespace tactus::arm_identification
