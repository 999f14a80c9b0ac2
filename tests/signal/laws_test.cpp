// SPDX-License-Identifier: Apache-2.0
#include "tests/laws.hpp"

#include <tactus/kernel/signal/delay_line.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>
#include <tactus/kernel/signal/low_pass.hpp>
#include <tactus/kernel/signal/predictor.hpp>
#include <tactus/kernel/signal/rational_filter.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>

#include <cstdlib>
#include <memory>

namespace tactus::laws {

using signal::FilterKind;
using signal::SecondOrderFilter;

template <>
struct Subject<SecondOrderFilter> : Subject<signal::LowPass> {
  static std::vector<SecondOrderFilter::Params> parameters() {
    return {{.kind = FilterKind::notch}, {.kind = FilterKind::low_pass}, {.kind = FilterKind::high_pass}};
  }
  static void admit(double&) {}
};

template <std::size_t Capacity>
struct Subject<signal::DelayLine<double, Capacity>> {
  static constexpr double dt_s = 200e-6;
  static std::vector<typename signal::DelayLine<double, Capacity>::Params> parameters() {
    return {{.delay_s = 0.0}, {.delay_s = dt_s}, {.delay_s = dt_s * static_cast<double>(Capacity)}};
  }
  static void admit(double&) {}
};

template <>
struct Subject<signal::PolynomialPredictor> {
  static constexpr double dt_s = 200e-6;
  static std::vector<signal::PolynomialPredictor::Params> parameters() {
    return {{}, {.samples = 1, .degree = 0}, {.samples = 128, .degree = 3}};
  }
  static void admit(double&) {}
};

template <>
struct Subject<signal::KalmanPredictor> {
  static constexpr double dt_s = 200e-6;
  static std::vector<signal::KalmanPredictor::Params> parameters() {
    return {{}, {.kinematics = signal::Kinematics::constant_velocity}};
  }
  static void admit(double&) {}
};

template <>
struct Subject<signal::Predictor> {
  static constexpr double dt_s = 200e-6;
  static std::vector<signal::Predictor::Params> parameters() {
    return {{}, {.kind = signal::PredictionKind::polynomial}, {.kind = signal::PredictionKind::kalman}};
  }
  static void admit(double&) {}
};

using SignalElements =
    ::testing::Types<signal::LowPass, SecondOrderFilter, signal::FilteredDerivative, signal::PredictionBlock,
                     signal::PredictionCascade, signal::PolynomialPredictor, signal::KalmanPredictor, signal::Predictor,
                     signal::RationalFilter, signal::DelayLine<double, 1>, signal::DelayLine<double, 64>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Signal, ElementLaws, SignalElements);

namespace laws_test {

/// A sound element, the base of the broken ones: an integrator with a leak.
template <class Self>
struct Leaky {
  struct Params {
    double leak = 0.5;
    std::int64_t order = 1;
    static constexpr auto fields() {
      return List{field("leak", &Params::leak, units::none, between(0.0, 0.9), "Share that is kept."),
                  field("order", &Params::order, between(1, 3), "How often.")};
    }
  };
  using Input = double;
  using Output = double;
  static Result<Self> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    Self element;
    element.leak = params.leak;
    return element;
  }
  double step(double input) noexcept { return state = leak * state + input; }
  void reset() noexcept { state = 0.0; }
  double leak = 0.0;
  double state = 0.0;
};

struct Sound : Leaky<Sound> {};
struct Forgetful : Leaky<Forgetful> {
  void reset() noexcept {}
};
struct Sharing : Leaky<Sharing> {
  double step(double input) noexcept { return shared = leak * shared + input; }
  void reset() noexcept { shared = 0.0; }
  static inline double shared = 0.0;
};
struct Dividing : Leaky<Dividing> {
  double step(double input) noexcept { return 1.0 / input; }
};
struct WithNew : Leaky<WithNew> {
  double step(double input) noexcept {
    const std::unique_ptr<volatile double> kept(new volatile double(input));
    return *kept;
  }
};
struct WithMalloc : Leaky<WithMalloc> {
  double step(double input) noexcept {
    void* volatile memory = std::malloc(64);
    std::free(memory);
    return input;
  }
};
struct Trusting : Leaky<Trusting> {
  static Result<Trusting> make(const Params&, Seconds dt) {
    if (Check error = signal::check_sample_time(dt)) return *std::move(error);
    return Trusting{};
  }
};
struct Timeless : Leaky<Timeless> {
  static Result<Timeless> make(const Params& params, Seconds) {
    if (Check error = validate(params)) return *std::move(error);
    return Timeless{};
  }
};
struct Misnaming : Leaky<Misnaming> {
  static Result<Misnaming> make(const Params& params, Seconds dt) {
    if (Check error = signal::check_sample_time(dt)) return *std::move(error);
    if (validate(params)) return Error{.parameter = "something", .message = "is wrong", .place = {}};
    return Misnaming{};
  }
};

TEST(TheLaws, PassASoundElement) {
  EXPECT_EQ(reset_equals_new<Sound>(), std::nullopt);
  EXPECT_EQ(a_copy_continues_identically<Sound>(), std::nullopt);
  EXPECT_EQ(finite_in_gives_finite_out<Sound>(), std::nullopt);
  EXPECT_EQ(the_hot_calls_do_not_allocate<Sound>(), std::nullopt);
  EXPECT_EQ(the_parameters_are_described<Sound::Params>(), std::nullopt);
  EXPECT_EQ(invalid_parameters_are_refused_by_name<Sound>(), std::nullopt);
}

TEST(TheLaws, CatchAnElementWhoseResetForgetsItsState) { EXPECT_NE(reset_equals_new<Forgetful>(), std::nullopt); }

TEST(TheLaws, CatchAnElementThatSharesStateWithItsCopies) {
  EXPECT_NE(a_copy_continues_identically<Sharing>(), std::nullopt);
}

TEST(TheLaws, CatchAnElementThatTurnsFiniteIntoInfinite) {
  EXPECT_NE(finite_in_gives_finite_out<Dividing>(), std::nullopt);
}

TEST(TheLaws, CatchAnElementThatAllocatesByNewOrByMalloc) {
  EXPECT_NE(the_hot_calls_do_not_allocate<WithNew>(), std::nullopt);
  EXPECT_NE(the_hot_calls_do_not_allocate<WithMalloc>(), std::nullopt);
}

TEST(TheLaws, CatchAnElementThatDoesNotCheckItsParametersOrItsSampleTime) {
  EXPECT_EQ(invalid_parameters_are_refused_by_name<Trusting>().value_or(""), "make accepted leak = -5e-324");
  EXPECT_EQ(invalid_parameters_are_refused_by_name<Timeless>().value_or(""), "make accepted a sample time of 0 s");
}

TEST(TheLaws, CatchAnErrorThatNamesTheWrongParameter) {
  EXPECT_EQ(invalid_parameters_are_refused_by_name<Misnaming>().value_or(""),
            "for leak = -5e-324 the error names 'something'");
}

struct LoosePart {
  double mass_kg = 1.0;
  static constexpr auto fields() {
    return List{field("mass_kg", &LoosePart::mass_kg, units::kilogram, any_finite, "Mass.")};
  }
};
/// Its own bounds on the nested part are never looked at.
struct Nested {
  struct Params {
    LoosePart part;
    static constexpr auto fields() { return List{field("part", &Params::part, "A part.")}; }
  };
  using Input = double;
  using Output = double;
  static Result<Nested> make(const Params&, Seconds dt) {
    if (Check error = signal::check_sample_time(dt)) return *std::move(error);
    return Nested{};
  }
  double step(double input) noexcept { return input; }
  void reset() noexcept {}
};

TEST(TheLaws, LookIntoNestedGroups) {
  EXPECT_EQ(invalid_parameters_are_refused_by_name<Nested>().value_or(""), "make accepted part.mass_kg = -inf");
}

struct WrongSuffix {
  double mass_kg = 1.0;
  static constexpr auto fields() {
    return List{field("mass_kg", &WrongSuffix::mass_kg, units::newton, positive, "Mass.")};
  }
};
struct UnitInDisguise {
  double delay_s = 1.0;
  static constexpr auto fields() {
    return List{field("delay_s", &UnitInDisguise::delay_s, units::none, positive, "Delay.")};
  }
};
struct RareUnitInDisguise {
  double pressure_Pa = 1.0;
  static constexpr auto fields() {
    return List{field("pressure_Pa", &RareUnitInDisguise::pressure_Pa, units::none, positive, "Pressure.")};
  }
};
struct ShorterUnit {
  double torque_N_m = 1.0;
  static constexpr auto fields() {
    return List{field("torque_N_m", &ShorterUnit::torque_N_m, units::metre, positive, "Torque.")};
  }
};
struct Undocumented {
  double gain = 1.0;
  static constexpr auto fields() { return List{field("gain", &Undocumented::gain, units::none, positive, "")}; }
};
struct Incomplete {
  double gain = 1.0;
  double forgotten = 1.0;
  static constexpr auto fields() { return List{field("gain", &Incomplete::gain, units::none, positive, "Gain.")}; }
};
struct BadDefault {
  double gain = -1.0;
  static constexpr auto fields() { return List{field("gain", &BadDefault::gain, units::none, positive, "Gain.")}; }
};
struct Twice {
  double gain = 1.0;
  double other = 1.0;
  static constexpr auto fields() {
    return List{field("gain", &Twice::gain, units::none, positive, "Gain."),
                field("gain", &Twice::other, units::none, positive, "Gain.")};
  }
};

TEST(TheLaws, CatchAFaultyDescription) {
  EXPECT_EQ(the_parameters_are_described<WrongSuffix>().value_or(""),
            "mass_kg: the name does not end with the suffix of its unit");
  EXPECT_EQ(the_parameters_are_described<UnitInDisguise>().value_or(""),
            "delay_s: the name ends with a unit it does not have");
  EXPECT_EQ(the_parameters_are_described<RareUnitInDisguise>().value_or(""),
            "pressure_Pa: the name ends with a unit it does not have");
  EXPECT_EQ(the_parameters_are_described<ShorterUnit>().value_or(""),
            "torque_N_m: the name ends with a unit it does not have");
  EXPECT_EQ(the_parameters_are_described<Undocumented>().value_or(""), "gain: the doc is empty");
  EXPECT_EQ(the_parameters_are_described<Incomplete>().value_or(""), "2 members, but 1 fields");
  EXPECT_NE(the_parameters_are_described<BadDefault>(), std::nullopt);
  EXPECT_EQ(the_parameters_are_described<Twice>().value_or(""), "gain: the name stands twice");
}

}  // namespace laws_test
}  // namespace tactus::laws
