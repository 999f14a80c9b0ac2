// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/document.hpp>
#include <tactus/kernel/control/stages/cancellation.hpp>

#include <filesystem>

namespace tactus::configuration {

/// Parameters of a `control::Cancellation` from a model file, such as `tactus identify quick --out` writes:
/// `read_cancellation("model.toml")`.
///
/// The file has every key of the tables `[control.model.motor]`, `cable`, `drum`, `linkage`, `handle` and `hand`,
/// because a default would be the value of another leader. `hand.guard_m` and `[control.model] linear_hand_stiffening`
/// may be missing. The file may also have `control.cancellation_model`, `control.cancellation_step` and
/// `control.cancellation_friction`. Quantities are in SI units, at the hand.
///
/// Errors: as those of `Document::load` and `Document::read`; `missing` for a key that the tables lack. Allocates.
Result<control::Cancellation::Params> read_cancellation(const std::filesystem::path& file);

/// The same from a document. Keys that it lacks keep the defaults, which are those of paper A's leader.
Result<control::Cancellation::Params> read_cancellation(const Document& document);

/// `missing` for the first key that the document lacks and a model file must have.
Check check_model_is_complete(const Document& document);

/// An error of `control::Cancellation::make` with the key and the place that the parameter has in the document.
Error locate_cancellation(const Document& document, Error error);

}  // namespace tactus::configuration
