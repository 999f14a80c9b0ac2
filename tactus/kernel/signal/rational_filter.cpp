// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/rational_filter.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace tactus::signal {

namespace {

std::complex<double> evaluate(const RationalFunction::Coefficients& ascending, std::complex<double> s) {
  std::complex<double> value = 0.0;
  for (std::size_t i = ascending.size(); i-- > 0;) value = value * s + ascending[i];
  return value;
}

}  // namespace

std::complex<double> RationalFunction::operator()(std::complex<double> s) const {
  return evaluate(numerator(), s) / evaluate(denominator(), s);
}

std::size_t degree(std::span<const double> ascending) {
  std::size_t highest = ascending.size();
  while (highest > 1 && ascending[highest - 1] == 0.0) --highest;
  return highest == 0 ? 0 : highest - 1;
}

bool is_hurwitz(std::span<const double> ascending) {
  const std::size_t order = degree(ascending);
  if (ascending.empty() || ascending[order] == 0.0) return false;
  // Routh's array, the two newest rows, from the highest power down, scaled to a leading one.
  std::vector<double> upper(order / 2 + 2, 0.0), lower(order / 2 + 2, 0.0);
  for (std::size_t i = 0; i <= order; ++i) {
    (i % 2 == 0 ? upper : lower)[i / 2] = ascending[order - i] / ascending[order];
  }
  for (std::size_t row = 1; row <= order; ++row) {
    if (!(lower[0] > 0.0)) return false;
    std::vector<double> next(lower.size(), 0.0);
    for (std::size_t i = 0; i + 1 < next.size(); ++i) next[i] = upper[i + 1] - upper[0] / lower[0] * lower[i + 1];
    upper = std::move(lower);
    lower = std::move(next);
  }
  return true;
}

Result<RationalFilter> RationalFilter::make(const Params& params, Seconds dt) {
  if (Check error = check(params, dt)) return *std::move(error);
  const auto numerator = params.numerator();
  const auto denominator = params.denominator();
  const std::size_t order = degree(denominator);
  if (degree(numerator) > order) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "numerator_" + std::to_string(degree(numerator)),
                 .message = "the numerator's degree exceeds the denominator's, " + std::to_string(order) +
                            ": such a filter differentiates without bound; add a low-pass to the denominator",
                 .place = {}};
  }
  if (!is_hurwitz(denominator)) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "denominator_" + std::to_string(order),
                 .message =
                     "the denominator has a root that is not left of the imaginary axis (Routh), or is zero: "
                     "the filter would not be stable",
                 .place = {}};
  }
  RationalFilter filter;
  filter.order_ = order;
  filter.half_dt_ = 0.5 * dt.value;
  double reach = 1.0, loop = 1.0;
  bool finite = true;
  for (std::size_t i = order + 1; i-- > 0;) {
    filter.a_[i] = denominator[i] / denominator[order];
    filter.b_[i] = numerator[i] / denominator[order];
    filter.reach_[i] = reach;
    if (i < order) loop += filter.a_[i] * reach;
    reach *= filter.half_dt_;
    finite = finite && std::isfinite(filter.b_[i]) && std::isfinite(loop);
  }
  if (!finite) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "denominator_" + std::to_string(order),
                 .message = "is too small compared with the other coefficients",
                 .place = {}};
  }
  filter.loop_ = 1.0 / loop;
  return filter;
}

}  // namespace tactus::signal
