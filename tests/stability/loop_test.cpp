// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/angle.hpp>
#include <tactus/analysis/stability/margins.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <tests/oracle_table.hpp>
#include <tests/stability/linear_rig.hpp>

namespace tactus::stability {
namespace {

/// Closed-loop poles that oscillate faster than 20 Hz, the slowest to decay first, of each pair the upper one.
std::vector<std::complex<double>> ringing(const Loop& loop) {
  std::vector<std::complex<double>> found;
  for (const std::complex<double> pole : poles(loop.closed(loop.force_gain))) {
    if (std::arg(pole) > turn * 20.0 * loop.tick_s) found.push_back(pole);
  }
  std::sort(found.begin(), found.end(), [](auto a, auto b) { return std::abs(a) > std::abs(b); });
  return found;
}

TEST(Loop, AgreesWithOctaveControlOnResponsesMarginsAndPolesToOneInAMillion) {
  const OracleTable oracle("stability_loop");
  const auto column = [&oracle](const std::string& name) { return oracle.column(name); };
  const auto near = [](double ours, double theirs, const char* what) {
    if (std::isinf(theirs)) {
      EXPECT_EQ(ours, theirs) << what;
    } else {
      EXPECT_NEAR(ours, theirs, 1e-6 * std::max(1.0, std::fabs(theirs))) << what;
    }
  };
  const auto delay = column("delay_ticks");
  for (std::size_t row = 0; row < delay.size(); ++row) {
    SCOPED_TRACE(row);
    const auto value = [&](const std::string& name) { return column(name)[row]; };
    simulation::Teleoperator::Params params = linear_rig();
    params.channel.to_slave.delay_s = 2e-4 * std::floor(delay[row] / 2.0);
    params.channel.to_master.delay_s = 2e-4 * std::ceil(delay[row] / 2.0);
    params.control.force_gain = value("mu");
    params.control.cancellation =
        value("cancellation") > 0.0 ? control::CancellationMode::on : control::CancellationMode::off;
    misjudge_mass(params, value("mass"));
    if (value("filter_Hz") > 0.0) {
      params.control.force_filter = {.kind = control::Shaping::low_pass, .frequency_Hz = value("filter_Hz")};
    }
    params.control.crossover.frequency_Hz = value("crossover_Hz");
    params.control.hand_compensation_Hz = value("compensation_Hz");
    const auto loop = make_loop(params);
    ASSERT_TRUE(loop) << describe(loop.error());
    const LoopCurve curve = trace(*loop);

    const double frequencies_Hz[] = {0.5, 20.0, 74.0, 200.0, 900.0};
    for (std::size_t i = 0; i < std::size(frequencies_Hz); ++i) {
      const std::complex<double> theirs{value("re" + std::to_string(i + 1)), value("im" + std::to_string(i + 1))};
      EXPECT_LE(std::abs(loop->at(turn * frequencies_Hz[i]) - theirs), 1e-6 * std::abs(theirs)) << frequencies_Hz[i];
    }
    const GainMargin gain = gain_margin(curve);
    near(gain.factor, value("gain_factor"), "gain margin");
    near(gain.frequency_rad_per_s / turn, value("gain_Hz"), "its frequency");
    near(gain_limit(*loop).force_gain, value("mu") * value("gain_factor"), "gain limit");
    const PhaseMargin phase = phase_margin(curve);
    near(phase.phase_rad, value("phase_rad"), "phase margin");
    near(phase.delay_s, value("delay_s"), "delay margin");
    near(modulus_margin(curve).distance, value("modulus"), "modulus margin");
    near(disk_margin(curve).alpha, value("disk"), "disk margin");
    const auto rings = ringing(*loop);
    ASSERT_GE(rings.size(), 2U);
    EXPECT_LE(std::abs(rings[0] - std::complex<double>(value("pole_re"), value("pole_im"))), 1e-6);
    EXPECT_LE(std::abs(rings[1] - std::complex<double>(value("pole2_re"), value("pole2_im"))), 1e-6);
  }
}

TEST(Loop, AtTheGainLimitAPoleLiesOnTheUnitCircleAndBeyondItThereAreTwoUnstableOnes) {
  simulation::Teleoperator::Params params = linear_rig();
  for (const double delay_s : {0.0, 0.005}) {
    for (const double mass : {0.7, 0.9, 1.1, 1.3}) {
      params = linear_rig();
      params.channel.to_slave.delay_s = delay_s;
      misjudge_mass(params, mass);
      Loop loop = *make_loop(params);
      const GainLimit limit = gain_limit(loop);
      EXPECT_NEAR(poles(loop.closed(limit.force_gain)).cwiseAbs().maxCoeff(), 1.0, 1e-7);
      loop.force_gain = 0.999 * limit.force_gain;
      EXPECT_EQ(unstable_poles(trace(loop)), 0);
      EXPECT_LT(poles(loop.closed(loop.force_gain)).cwiseAbs().maxCoeff(), 1.0);
      loop.force_gain = 1.001 * limit.force_gain;
      EXPECT_EQ(unstable_poles(trace(loop)), 2);
    }
  }
}

TEST(Loop, NeedsNoForceGainOfItsOwn) {
  simulation::Teleoperator::Params params = linear_rig();
  params.control.force_gain = 0.0;
  EXPECT_GT(gain_limit(*make_loop(params)).force_gain, 1.0);
}

TEST(Loop, RefusesWhatItCannotSeeAndNamesIt) {
  simulation::Teleoperator::Params params = linear_rig();
  params.control.architecture = "wave-variables";
  EXPECT_EQ(make_loop(params).error().parameter, "control.architecture");
  params = linear_rig();
  params.control.slave_force.source = control::SlaveForceSource::kalman;
  EXPECT_EQ(make_loop(params).error().parameter, "control.slave_force.source");
  params = linear_rig();
  params.control.operator_estimate = control::OperatorEstimate::online;
  EXPECT_EQ(make_loop(params).error().parameter, "control.operator_estimate");
}

TEST(Loop, ServoThatIsUnstableAloneAllowsNoForceGainAtAll) {
  simulation::Teleoperator::Params params = linear_rig();
  params.control.slave.derivative_N_s_per_m = 200.0;
  const Loop loop = *make_loop(params);
  EXPECT_FALSE(stable_without_force(loop));
  EXPECT_EQ(gain_limit(loop).force_gain, 0.0);
}

}  // namespace
}  // namespace tactus::stability
