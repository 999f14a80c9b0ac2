// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/cancellation_file.hpp>
#include <tactus/interfaces/c_api/internal/errors.hpp>
#include <tactus/interfaces/c_api/internal/handles.hpp>
#include <tactus/kernel/control/stages/cancellation.hpp>

#include <cmath>
#include <string>

namespace tactus::c_api {

namespace {

using control::Cancellation;

Result<Cancellation> make_cancellation(const tactus_cancellation_options& options) {
  using configuration::Document;
  auto document = options.file != nullptr ? Document::load(options.file) : Document::parse("", "the published leader");
  if (!document) return document.error();
  for (std::size_t i = 0; i < options.set_count; ++i) {
    if (auto error = document->set(options.set[i])) return *std::move(error);
  }
  const auto params = configuration::read_cancellation(*document);
  if (!params) return params.error();
  if (options.file != nullptr) {
    if (auto missing = configuration::check_model_is_complete(*document)) return *std::move(missing);
  }
  if (!(options.sample_time_s > 0.0 && options.sample_time_s <= 1.0)) {
    return out_of_bounds("sample_time_s", options.sample_time_s, positive_up_to(1.0), units::second);
  }
  auto made = Cancellation::make(*params, Seconds{options.sample_time_s});
  if (!made) return configuration::locate_cancellation(*document, made.error());
  return made;
}

/// Another number would stay in the model until it is reset.
bool is_finite(double value) { return std::isfinite(value); }

Handles<Cancellation, cancellation_kind>& cancellations() {
  static auto* const all = new Handles<Cancellation, cancellation_kind>;
  return *all;
}

tactus_status hand_out(const Cancellation& cancellation, tactus_cancellation* out, tactus_error* error) {
  *out = cancellations().add(cancellation);
  if (*out != 0) return TACTUS_OK;
  return leave({.code = ErrorCode::failed,
                .parameter = {},
                .message = "there are 65536 cancellations already: release those that are not used any more",
                .place = {}},
               error);
}

}  // namespace

}  // namespace tactus::c_api

using namespace tactus::c_api;

tactus_status tactus_cancellation_make(const tactus_cancellation_options* options, tactus_cancellation* made,
                                       tactus_error* error) {
  return guarded(error, [&]() -> tactus_status {
    if (made == nullptr) return bad_argument("`made` is NULL: pass where the handle is to be left", error);
    *made = 0;
    if (!has_known_size(options)) {
      return bad_argument("`options` is NULL or of another size: begin with TACTUS_CANCELLATION_OPTIONS_INIT", error);
    }
    for (std::size_t i = 0; i < options->set_count; ++i) {
      if (options->set == nullptr || options->set[i] == nullptr) {
        return bad_argument("`set` has fewer texts than `set_count`: pass as many", error);
      }
    }
    const auto cancellation = make_cancellation(*options);
    return cancellation ? hand_out(*cancellation, made, error) : leave(cancellation.error(), error);
  });
}

tactus_status tactus_cancellation_step(tactus_cancellation cancellation, double measured_position_m,
                                       double motor_force_N, double* intended_position_m) {
  auto* const found = cancellations().find(cancellation);
  if (found == nullptr) return TACTUS_BAD_HANDLE;
  if (intended_position_m == nullptr) return TACTUS_BAD_ARGUMENT;
  if (!is_finite(measured_position_m) || !is_finite(motor_force_N)) return TACTUS_OUT_OF_BOUNDS;
  *intended_position_m = found->step({.measured_position_m = measured_position_m, .motor_force_N = motor_force_N});
  return TACTUS_OK;
}

tactus_status tactus_cancellation_intended(tactus_cancellation cancellation, double measured_position_m,
                                           double* intended_position_m) {
  auto* const found = cancellations().find(cancellation);
  if (found == nullptr) return TACTUS_BAD_HANDLE;
  if (intended_position_m == nullptr) return TACTUS_BAD_ARGUMENT;
  if (!is_finite(measured_position_m)) return TACTUS_OUT_OF_BOUNDS;
  *intended_position_m = found->intended(measured_position_m);
  return TACTUS_OK;
}

tactus_status tactus_cancellation_advance(tactus_cancellation cancellation, double motor_force_N) {
  auto* const found = cancellations().find(cancellation);
  if (found == nullptr) return TACTUS_BAD_HANDLE;
  if (!is_finite(motor_force_N)) return TACTUS_OUT_OF_BOUNDS;
  found->advance(motor_force_N);
  return TACTUS_OK;
}

tactus_status tactus_cancellation_step_array(tactus_cancellation cancellation, size_t count,
                                             const double* measured_position_m, const double* motor_force_N,
                                             double* intended_position_m) {
  auto* const found = cancellations().find(cancellation);
  if (found == nullptr) return TACTUS_BAD_HANDLE;
  if (count == 0) return TACTUS_OK;
  if (measured_position_m == nullptr || motor_force_N == nullptr || intended_position_m == nullptr) {
    return TACTUS_BAD_ARGUMENT;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_finite(measured_position_m[i]) || !is_finite(motor_force_N[i])) return TACTUS_OUT_OF_BOUNDS;
  }
  for (std::size_t i = 0; i < count; ++i) {
    intended_position_m[i] =
        found->step({.measured_position_m = measured_position_m[i], .motor_force_N = motor_force_N[i]});
  }
  return TACTUS_OK;
}

tactus_status tactus_cancellation_induced(tactus_cancellation cancellation, double* induced_position_m) {
  const auto* const found = cancellations().find(cancellation);
  if (found == nullptr) return TACTUS_BAD_HANDLE;
  if (induced_position_m == nullptr) return TACTUS_BAD_ARGUMENT;
  *induced_position_m = found->model().motor_position_m();
  return TACTUS_OK;
}

tactus_status tactus_cancellation_reset(tactus_cancellation cancellation) {
  auto* const found = cancellations().find(cancellation);
  if (found == nullptr) return TACTUS_BAD_HANDLE;
  found->reset();
  return TACTUS_OK;
}

tactus_status tactus_cancellation_copy(tactus_cancellation cancellation, tactus_cancellation* copy,
                                       tactus_error* error) {
  return guarded(error, [&]() -> tactus_status {
    if (copy == nullptr) return bad_argument("`copy` is NULL: pass where the handle is to be left", error);
    *copy = 0;
    const auto* const found = cancellations().find(cancellation);
    if (found == nullptr)
      return leave_text("the cancellation was released, or never was one: make one", TACTUS_BAD_HANDLE, error);
    return hand_out(*found, copy, error);
  });
}

tactus_status tactus_cancellation_release(tactus_cancellation cancellation) {
  return guarded(nullptr, [&]() -> tactus_status {
    return cancellation == 0 || cancellations().release(cancellation) ? TACTUS_OK : TACTUS_BAD_HANDLE;
  });
}
