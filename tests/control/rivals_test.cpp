#include <tactus/control/architecture.hpp>
#include <tactus/control/position_force.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

// The remedies of paper A, Sec. IV, as stages of the position-force master, all seen from outside the site.
namespace tactus::control {
namespace {

static_assert(Element<ShapingFilter>);
static_assert(Element<LocalDamping>);
static_assert(Element<Crossover>);

using Complex = std::complex<double>;
using Params = PositionForceMaster::Params;

constexpr double tick_s = 200e-6;
constexpr double half_power = std::numbers::sqrt2 / 2.0;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

PositionForceMaster master(const Params& params) { return PositionForceMaster::make(params, Seconds{tick_s}).value(); }

MasterInput input(double position_m, double tip_force_N) {
  return {.motor_position_m = position_m, .arrival = {.message = {.force_N = tip_force_N}, .fresh = true}};
}

/// Without cancellation, and with no limit near.
Params plain() {
  Params params;
  params.cancellation = CancellationMode::off;
  params.force_limit_N = 100.0;
  return params;
}

/// A site with every stage at work.
Params everything() {
  Params params;
  params.force_gain = 3.0;
  params.damping.damping_N_s_per_m = 5.0;
  params.command_filter = {.kind = Shaping::low_pass, .frequency_Hz = 30.0};
  params.force_filter = {.kind = Shaping::notch, .frequency_Hz = 75.0, .notch_width_Hz = 50.0};
  params.crossover.frequency_Hz = 40.0;
  return params;
}

double angle_of(double frequency_Hz) { return 2.0 * std::numbers::pi * frequency_Hz * tick_s; }

/// What a site makes of a sine, once settled: `drive(sample)` is the site's input, `read(output)` what is looked at.
/// Fits sine and cosine over a window of whole periods of every multiple of 5 Hz.
template <class Drive, class Read>
Complex response(PositionForceMaster site, double frequency_Hz, Drive drive, Read read) {
  constexpr int settling = 10000, window = 5000;
  Complex sum = 0.0;
  for (int n = 0; n < settling + window; ++n) {
    const MasterOutput out = site.step(drive(1e-3 * std::cos(angle_of(frequency_Hz) * n)));
    if (n >= settling) sum += read(out) * std::polar(1.0, -angle_of(frequency_Hz) * n);
  }
  return sum * (2.0 / (window * 1e-3));
}

Complex command_response(const Params& params, double frequency_Hz) {
  return response(
      master(params), frequency_Hz, [](double sample) { return input(sample, 0.0); },
      [](const MasterOutput& out) { return out.message.position_m; });
}

/// Positive when it pushes the hand back, as the force from the slave is.
Complex motor_response(const Params& params, double frequency_Hz) {
  return response(
      master(params), frequency_Hz, [](double sample) { return input(0.0, sample); },
      [](const MasterOutput& out) { return -out.motor_force_N; });
}

Complex handle_response(const Params& params, double frequency_Hz) {
  return response(
      master(params), frequency_Hz, [](double sample) { return input(0.0, sample); },
      [](const MasterOutput& out) { return -out.handle_force_N; });
}

/// The analogue low-pass at the frequency that the bilinear transform makes of this one.
Complex butterworth(double frequency_Hz, double corner_Hz) {
  const Complex s(0.0, std::tan(0.5 * angle_of(frequency_Hz)) / std::tan(0.5 * angle_of(corner_Hz)));
  return 1.0 / (s * s + std::numbers::sqrt2 * s + 1.0);
}

void expect_near(Complex actual, Complex expected, double tolerance, double frequency_Hz) {
  EXPECT_NEAR(actual.real(), expected.real(), tolerance) << frequency_Hz << " Hz";
  EXPECT_NEAR(actual.imag(), expected.imag(), tolerance) << frequency_Hz << " Hz";
}

constexpr double frequencies_Hz[] = {5.0, 20.0, 40.0, 75.0, 150.0, 400.0, 1000.0, 2000.0};

TEST(CommandFilter, ALowPassShapesTheCommandAsButterworthAndLosesThreeDecibelsAtItsFrequency) {
  Params params = plain();
  params.position_scale = 0.5;
  params.command_filter = {.kind = Shaping::low_pass, .frequency_Hz = 40.0};
  for (const double f : frequencies_Hz) {
    expect_near(command_response(params, f), 0.5 * butterworth(f, 40.0), 1e-9, f);
  }
  EXPECT_NEAR(std::abs(command_response(params, 40.0)), 0.5 * half_power, 1e-9);
}

TEST(ForceFilter, ALowPassShapesTheDisplayedForceAsButterworthAndLosesThreeDecibelsAtItsFrequency) {
  Params params = plain();
  params.force_gain = 4.0;
  params.force_filter = {.kind = Shaping::low_pass, .frequency_Hz = 40.0};
  for (const double f : frequencies_Hz) {
    expect_near(motor_response(params, f), 4.0 * butterworth(f, 40.0), 1e-9, f);
    EXPECT_EQ(std::abs(handle_response(params, f)), 0.0);
  }
  EXPECT_NEAR(std::abs(motor_response(params, 40.0)), 4.0 * half_power, 1e-9);
}

/// The edges of a band of `width_Hz` around a centre of a digital notch: cos ω₀ = cos(middle) / cos(half the width).
struct Edges {
  double lower_Hz, upper_Hz;
};
Edges edges(double centre_Hz, double width_Hz) {
  const double middle = std::acos(std::cos(angle_of(centre_Hz)) * std::cos(0.5 * angle_of(width_Hz)));
  const double middle_Hz = middle / angle_of(1.0);
  return {middle_Hz - 0.5 * width_Hz, middle_Hz + 0.5 * width_Hz};
}

TEST(ShapingFilters, ANotchSilencesItsFrequencyInCommandAndForceAndHasItsEdgesWhereItSays) {
  Params params = plain();
  const ShapingFilter::Params notch{.kind = Shaping::notch, .frequency_Hz = 75.0, .notch_width_Hz = 50.0};
  params.command_filter = notch;
  params.force_filter = notch;
  for (auto* look : {&command_response, &motor_response}) {
    EXPECT_LT(std::abs(look(params, 75.0)), 1e-9);
    EXPECT_NEAR(std::abs(look(params, 5.0)), 1.0, 2e-3);
    EXPECT_NEAR(std::abs(look(params, 2000.0)), 1.0, 2e-3);
  }
  // An edge falls between the frequencies that the window holds whole, so it is put there: 50 and 110 Hz.
  const double width_Hz = 60.0;
  double centre_Hz = 75.0;
  for (int i = 0; i < 60; ++i) centre_Hz += 50.0 - edges(centre_Hz, width_Hz).lower_Hz;
  const ShapingFilter::Params placed{.kind = Shaping::notch, .frequency_Hz = centre_Hz, .notch_width_Hz = width_Hz};
  params.command_filter = placed;
  params.force_filter = placed;
  for (auto* look : {&command_response, &motor_response}) {
    EXPECT_NEAR(std::abs(look(params, 50.0)), half_power, 1e-9);
    EXPECT_NEAR(std::abs(look(params, 110.0)), half_power, 1e-9);
  }
}

TEST(ShapingFilters, StartFromTheFirstSampleWithoutATransientWhereverThatIs) {
  for (const Shaping kind : {Shaping::low_pass, Shaping::notch}) {
    Params params = plain();
    params.command_filter.kind = kind;
    params.force_filter.kind = kind;
    PositionForceMaster site = master(params);
    for (const double start : {0.3, -0.2}) {
      site.reset();
      for (int tick = 0; tick < 200; ++tick) {
        const auto out = site.step(input(start, start));
        ASSERT_NEAR(out.message.position_m, start, 1e-12) << name_of(kind) << " at tick " << tick;
        ASSERT_NEAR(out.motor_force_N, -start, 1e-12) << name_of(kind) << " at tick " << tick;
      }
    }
  }
}

/// By how much the command lags a steady motion, in s.
double lag_s(const ShapingFilter::Params& filter) {
  Params params = plain();
  params.command_filter = filter;
  PositionForceMaster site = master(params);
  constexpr double speed_m_per_s = 0.1;
  double position_m = 0.0, command_m = 0.0;
  for (int tick = 0; tick < 5000; ++tick) {
    position_m = 0.2 + speed_m_per_s * tick_s * tick;
    command_m = site.step(input(position_m, 0.0)).message.position_m;
  }
  return (position_m - command_m) / speed_m_per_s;
}

TEST(CommandFilter, LagsASteadyMotionByTheSlopeOfItsPhase) {
  // Of the analogue filters √2 / (2π f) and width / (2π f²). The bilinear transform changes the second by its warping.
  const auto warped = [](double frequency_Hz) { return std::tan(0.5 * angle_of(frequency_Hz)); };
  const double low_pass_s = lag_s({.kind = Shaping::low_pass, .frequency_Hz = 30.0});
  EXPECT_NEAR(low_pass_s, std::numbers::sqrt2 / warped(30.0) * 0.5 * tick_s, 1e-9);
  EXPECT_NEAR(low_pass_s, std::numbers::sqrt2 / (2.0 * std::numbers::pi * 30.0), 1e-3 * low_pass_s);
  const double notch_s = lag_s({.kind = Shaping::notch, .frequency_Hz = 75.0, .notch_width_Hz = 50.0});
  const double centre2 = std::pow(warped(75.0), 2);
  EXPECT_NEAR(notch_s, warped(50.0) * (1.0 + centre2) / centre2 * 0.5 * tick_s, 1e-9);
  EXPECT_NEAR(notch_s, 50.0 / (2.0 * std::numbers::pi * 75.0 * 75.0), 1e-2 * notch_s);
}

TEST(Crossover, ThePartsOfMotorAndHandleSumToTheWholeForceAtEveryInstant) {
  Params params = plain();
  params.force_gain = 2.0;
  params.crossover.frequency_Hz = 60.0;
  PositionForceMaster site = master(params);
  for (int tick = 0; tick < 5000; ++tick) {
    const double tip_force_N = 0.5 + std::sin(0.3 * tick) + (tick % 700 < 20 ? 3.0 : 0.0);
    const auto out = site.step(input(0.0, tip_force_N));
    // Two roundings of numbers no larger than these.
    const double round_off = std::numeric_limits<double>::epsilon() * (std::fabs(out.motor_force_N) + 10.0);
    ASSERT_NEAR(out.motor_force_N + out.handle_force_N, -2.0 * tip_force_N, round_off) << tick;
  }
}

TEST(Crossover, TheMotorGetsTheLowPassAndTheHandleWhatIsMissing) {
  Params params = plain();
  params.crossover.frequency_Hz = 40.0;
  for (const double f : frequencies_Hz) {
    expect_near(motor_response(params, f), butterworth(f, 40.0), 1e-9, f);
    expect_near(handle_response(params, f), 1.0 - butterworth(f, 40.0), 1e-9, f);
  }
  EXPECT_NEAR(std::abs(motor_response(params, 40.0)), half_power, 1e-9);
  EXPECT_NEAR(std::abs(handle_response(params, 40.0)), std::sqrt(3.0) / std::numbers::sqrt2, 1e-9);
}

TEST(Crossover, AForceThatIsThereFromTheFirstSampleIsTheMotorsAlone) {
  Params params = plain();
  params.crossover.frequency_Hz = 10.0;
  PositionForceMaster site = master(params);
  for (int tick = 0; tick < 200; ++tick) {
    const auto out = site.step(input(0.0, 0.8));
    ASSERT_NEAR(out.motor_force_N, -0.8, 1e-14);
    ASSERT_NEAR(out.handle_force_N, 0.0, 1e-14);
  }
}

TEST(Crossover, NothingOfItEntersTheCommand) {
  Params split = plain();
  split.crossover.frequency_Hz = 40.0;
  PositionForceMaster with = master(split), without = master(plain());
  for (int tick = 0; tick < 500; ++tick) {
    const MasterInput in = input(1e-3 * std::sin(0.1 * tick), std::cos(0.2 * tick));
    ASSERT_EQ(with.step(in).message.position_m, without.step(in).message.position_m);
  }
}

TEST(LocalDamping, ASteadyMotionMeetsDampingTimesVelocityAndTheStartNone) {
  for (const double speed_m_per_s : {0.1, -0.25}) {
    Params params = plain();
    params.damping.damping_N_s_per_m = 7.0;
    PositionForceMaster site = master(params);
    double force_N = 0.0;
    for (int tick = 0; tick < 1000; ++tick) {
      const auto out = site.step(input(0.3 + speed_m_per_s * tick_s * tick, 0.5));
      if (tick == 0) {
        EXPECT_EQ(out.motor_force_N, -0.5);
      }
      EXPECT_EQ(out.message.position_m, 0.3 + speed_m_per_s * tick_s * tick);
      force_N = out.motor_force_N;
    }
    EXPECT_NEAR(force_N, -0.5 - 7.0 * speed_m_per_s, 1e-9);
  }
}

TEST(LocalDamping, LosesThreeDecibelsOfAnIdealDamperAtItsCutoff) {
  Params params = plain();
  params.damping = {.damping_N_s_per_m = 7.0, .velocity = {.cutoff_Hz = 200.0}};
  const Complex force = response(
      master(params), 200.0, [](double sample) { return input(sample, 0.0); },
      [](const MasterOutput& out) { return out.motor_force_N; });
  EXPECT_NEAR(std::abs(force), 7.0 * 2.0 * std::numbers::pi * 200.0 * half_power, 1e-6);
}

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

TEST(Rivals, SwitchedOffTheyChangeNoBitWhateverElseIsSetOfThem) {
  Params params;
  params.cancellation = CancellationMode::off;
  params.position_scale = 0.3;
  params.force_gain = 2.0;
  // None of these could run at this servo rate.
  params.damping.velocity.cutoff_Hz = 1e6;
  params.command_filter.frequency_Hz = 1e6;
  params.force_filter.notch_width_Hz = 1e6;
  PositionForceMaster site = master(params);
  for (int tick = 0; tick < 1000; ++tick) {
    const double position_m = tick % 7 == 0 ? -0.0 : 0.02 * std::sin(0.01 * tick);
    const double tip_force_N = tick % 5 == 0 ? -0.0 : std::cos(0.02 * tick);
    const auto out = site.step(input(position_m, tip_force_N));
    ASSERT_EQ(bits(out.message.position_m), bits(0.3 * position_m));
    ASSERT_EQ(bits(out.motor_force_N), bits(-std::clamp(2.0 * tip_force_N, -1.0, 1.0)));
    ASSERT_EQ(out.handle_force_N, 0.0);
  }
}

TEST(Rivals, TheCommandFilterComesAfterCancellation) {
  Params params;
  params.force_limit_N = 100.0;
  params.damping.damping_N_s_per_m = 4.0;
  PositionForceMaster unfiltered = master(params);
  params.command_filter = {.kind = Shaping::low_pass, .frequency_Hz = 25.0};
  PositionForceMaster filtered = master(params);

  // The same low-pass as a difference equation over the commands of the other site.
  const double k = std::tan(0.5 * angle_of(25.0));
  const double scale = 1.0 / (1.0 + std::numbers::sqrt2 * k + k * k);
  std::vector<double> x{0.05, 0.05}, y{0.05, 0.05};
  for (int tick = 0; tick < 2000; ++tick) {
    const MasterInput in = input(0.05 + 1e-3 * std::sin(0.02 * tick), tick % 400 < 200 ? 0.7 : 0.0);
    x.push_back(unfiltered.step(in).message.position_m);
    const std::size_t n = x.size() - 1;
    y.push_back(scale * (k * k * (x[n] + 2.0 * x[n - 1] + x[n - 2]) - 2.0 * (k * k - 1.0) * y[n - 1] -
                         (1.0 - std::numbers::sqrt2 * k + k * k) * y[n - 2]));
    if (tick == 0) {
      // The first sample stands for all before it.
      x = {x[n], x[n], x[n]};
      y = {x[n], x[n], x[n]};
    }
    ASSERT_NEAR(filtered.step(in).message.position_m, y.back(), 1e-12) << tick;
  }
}

TEST(Rivals, TheForceFilterComesBeforeTheCrossoverSoNeitherActuatorGetsWhatItTakesOut) {
  Params params = plain();
  params.force_filter = {.kind = Shaping::notch, .frequency_Hz = 100.0, .notch_width_Hz = 50.0};
  params.crossover.frequency_Hz = 100.0;
  EXPECT_LT(std::abs(motor_response(params, 100.0)), 1e-9);
  EXPECT_LT(std::abs(handle_response(params, 100.0)), 1e-9);
}

TEST(Rivals, DampingComesAfterForceFilterAndCrossover) {
  Params damped = plain();
  damped.damping.damping_N_s_per_m = 3.0;
  Params all = damped;
  all.force_filter = {.kind = Shaping::low_pass, .frequency_Hz = 10.0};
  all.crossover.frequency_Hz = 10.0;
  PositionForceMaster with = master(all), without = master(damped);
  for (int tick = 0; tick < 500; ++tick) {
    const MasterInput in = input(1e-3 * std::sin(0.3 * tick), 0.0);
    const auto out = with.step(in);
    ASSERT_EQ(out.motor_force_N, without.step(in).motor_force_N);
    ASSERT_EQ(out.handle_force_N, 0.0);
  }
}

TEST(Rivals, SaturationComesLastAndBoundsMotorAndHandleEach) {
  Params params = plain();
  params.force_limit_N = 0.6;
  params.damping.damping_N_s_per_m = 50.0;
  params.crossover.frequency_Hz = 50.0;
  PositionForceMaster site = master(params);
  double motor_N = 0.0, handle_N = 0.0;
  for (int tick = 0; tick < 2000; ++tick) {
    const auto out = site.step(input(0.01 * std::sin(0.1 * tick), 20.0 * std::sin(0.03 * tick)));
    motor_N = std::max(motor_N, std::fabs(out.motor_force_N));
    handle_N = std::max(handle_N, std::fabs(out.handle_force_N));
  }
  EXPECT_EQ(motor_N, 0.6);
  EXPECT_EQ(handle_N, 0.6);
}

TEST(Rivals, TheModelOfCancellationIsDrivenByTheDampingAndNotByTheHandle) {
  Params params;
  params.model.linkage.hysteretic_fraction = 0.0;
  params.cancellation_friction = ModelFriction::at_rest;
  params.damping.damping_N_s_per_m = 4.0;
  params.crossover.frequency_Hz = 50.0;
  PositionForceMaster site = master(params);
  InducedMotionModel reference =
      InducedMotionModel::make({.master = params.model, .friction = ModelFriction::at_rest}, Seconds{tick_s}).value();
  double largest_m = 0.0;
  for (int tick = 0; tick < 1000; ++tick) {
    const auto out = site.step(input(1e-3 * std::sin(0.05 * tick), tick % 200 < 100 ? 0.5 : 0.0));
    ASSERT_EQ(out.induced_position_m, reference.motor_position_m());
    reference.step({.motor_force_N = out.motor_force_N});
    largest_m = std::max(largest_m, std::fabs(out.induced_position_m));
  }
  EXPECT_GT(largest_m, 1e-4);
}

MasterSite gated(const Params& params, const SafetyGate::Params& handle = {}) {
  ControlParams control;
  static_cast<Params&>(control) = params;
  control.handle_gate = handle;
  return make_sites(control, Seconds{tick_s}).value().master;
}

TEST(Rivals, ANumberLostAnywhereReleasesMotorAndHandleAtTheRateLimitUntilReset) {
  for (const MasterInput& bad : {input(not_a_number, 0.2), input(0.01, not_a_number)}) {
    MasterSite site = gated(everything());
    MasterOutput before;
    for (int tick = 0; tick < 60; ++tick) before = site.step(input(0.01, tick < 55 ? 0.0 : 0.25));
    ASSERT_GT(std::fabs(before.handle_force_N), 0.1);
    EXPECT_EQ(site.fault(), GateFault::none);
    for (int tick = 0; tick < 10; ++tick) {
      const auto out = site.step(tick == 0 ? bad : input(0.01, 0.25));
      EXPECT_EQ(out.motor_force_N, 0.0);
      EXPECT_EQ(out.handle_force_N, 0.0);
      EXPECT_EQ(site.fault(), GateFault::not_finite);
    }
    site.reset();
    EXPECT_EQ(site.fault(), GateFault::none);
    MasterSite fresh = gated(everything());
    for (int tick = 0; tick < 100; ++tick) {
      const MasterInput in = input(0.01 + 1e-5 * tick, 0.1);
      const auto out = site.step(in), expected = fresh.step(in);
      ASSERT_EQ(out.motor_force_N, expected.motor_force_N);
      ASSERT_EQ(out.handle_force_N, expected.handle_force_N);
      ASSERT_EQ(out.message.position_m, expected.message.position_m);
    }
  }
}

TEST(Rivals, APositionThatIsNoNumberBehindTheCommandFilterIsCaughtByTheSlavesGate) {
  Params params = plain();
  params.command_filter.kind = Shaping::low_pass;
  MasterSite site = gated(params);
  auto slave = make_sites({}, Seconds{tick_s}).value().slave;
  slave.step({.arrival = {.message = site.step(input(0.01, 0.0)).message, .fresh = true}});
  EXPECT_EQ(slave.fault(), GateFault::none);
  for (const double position_m : {not_a_number, 0.01}) {
    const auto sent = site.step(input(position_m, 0.0)).message;
    EXPECT_TRUE(std::isfinite(slave.step({.arrival = {.message = sent, .fresh = true}}).motor_force_N));
    EXPECT_EQ(slave.fault(), GateFault::not_finite);
  }
}

TEST(Rivals, TheHandlesForceStaysWithinTheLimitsOfItsOwnGate) {
  Params params = plain();
  params.crossover.frequency_Hz = 20.0;
  MasterSite site = gated(params, {.force_limit_N = 0.25, .rate_limit_N_per_s = 250.0});
  double before_N = 0.0, largest_N = 0.0;
  for (int tick = 0; tick < 3000; ++tick) {
    const double handle_N = site.step(input(0.0, tick % 300 < 150 ? 5.0 : -5.0)).handle_force_N;
    ASSERT_LE(std::fabs(handle_N - before_N), 0.05 + 1e-12);
    largest_N = std::max(largest_N, std::fabs(handle_N));
    before_N = handle_N;
  }
  EXPECT_EQ(largest_N, 0.25);
}

/// A master that answers with what the test says.
struct Scripted {
  double motor_N, handle_N;
  MasterOutput respond(const MasterInput&) noexcept {
    MasterOutput output;
    output.motor_force_N = motor_N;
    output.handle_force_N = handle_N;
    return output;
  }
  void reset() noexcept {}
};

TEST(MasterSite, WithOneGateGivenTheHandleGetsTheSameLimits) {
  const auto gate = SafetyGate::make({.force_limit_N = 0.5, .rate_limit_N_per_s = 1000.0}, Seconds{tick_s}).value();
  MasterSite site(master_controller(Scripted{.motor_N = 0.1, .handle_N = -900.0}), gate);
  for (const double expected_N : {-0.2, -0.4, -0.5, -0.5}) {
    const auto out = site.step({});
    EXPECT_DOUBLE_EQ(out.motor_force_N, 0.1);
    EXPECT_DOUBLE_EQ(out.handle_force_N, expected_N);
  }
}

TEST(MasterSite, AFaultOfEitherActuatorReleasesBoth) {
  const auto gate = SafetyGate::make({}, Seconds{tick_s}).value();
  for (const double bad : {not_a_number, std::numeric_limits<double>::infinity()}) {
    for (const Scripted& script : {Scripted{.motor_N = 0.1, .handle_N = bad}, Scripted{bad, 0.1}}) {
      MasterSite site(master_controller(script), gate);
      const auto out = site.step({});
      EXPECT_EQ(out.motor_force_N, 0.0);
      EXPECT_EQ(out.handle_force_N, 0.0);
      EXPECT_EQ(site.fault(), GateFault::not_finite);
    }
  }
}

TEST(Rivals, WhatThisServoRateCannotCarryIsRefusedByName) {
  const auto refused = [](auto&& change) {
    ControlParams params;
    change(params);
    const auto sites = make_sites(params, Seconds{tick_s});
    return sites ? std::string("was made") : sites.error().parameter;
  };
  EXPECT_EQ(refused([](auto& p) { p.command_filter = {.kind = Shaping::low_pass, .frequency_Hz = 2500.0}; }),
            "command_filter.frequency_Hz");
  EXPECT_EQ(refused([](auto& p) { p.force_filter = {.kind = Shaping::notch, .notch_width_Hz = 2500.0}; }),
            "force_filter.notch_width_Hz");
  EXPECT_EQ(refused([](auto& p) { p.crossover.frequency_Hz = 2500.0; }), "crossover.frequency_Hz");
  EXPECT_EQ(refused([](auto& p) { p.damping = {.damping_N_s_per_m = 1.0, .velocity = {.cutoff_Hz = 2400.0}}; }),
            "damping.velocity.cutoff_Hz");
  EXPECT_EQ(refused([](auto& p) { p.handle_gate.force_limit_N = 1e3; }), "handle_gate.force_limit_N");
}

}  // namespace
}  // namespace tactus::control
