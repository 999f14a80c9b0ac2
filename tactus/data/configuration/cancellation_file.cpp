// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/cancellation_file.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tactus::configuration {

namespace {

using control::Cancellation;

/// The keys of an experiment file that concern a cancellation alone.
struct CancellationFile {
  struct Control {
    control::MasterModel model;
    control::ModelFidelity cancellation_model = control::ModelFidelity::sixth_order;
    control::CancellationStep cancellation_step = control::CancellationStep::exact;
    control::ModelFriction cancellation_friction = control::ModelFriction::total_velocity;
    static constexpr auto fields() {
      return List{
          field("model", &Control::model, "The controller's model of master and hand."),
          field("cancellation_model", &Control::cancellation_model,
                "How much detail of master and hand the model of cancellation has."),
          field("cancellation_step", &Control::cancellation_step, "Integration method of the model of cancellation."),
          field("cancellation_friction", &Control::cancellation_friction,
                "Velocity from which the sixth-order model computes its Coulomb friction: induced motion only "
                "(at-rest), or with the intended motion (total-velocity).")};
    }
  };
  Control control;
  static constexpr auto fields() { return List{field("control", &CancellationFile::control, "The controllers.")}; }
};

constexpr std::string_view model_section = "control.model";
/// Keys of the model that do not describe a device: their defaults suit any.
constexpr std::array<std::string_view, 2> of_the_method{"control.model.linear_hand_stiffening",
                                                        "control.model.hand.guard_m"};

/// The key of the file that a parameter of `Cancellation::Params` is.
std::string key_in_file(std::string_view parameter) {
  if (parameter == "model.fidelity") return "control.cancellation_model";
  if (parameter == "model.step") return "control.cancellation_step";
  if (parameter == "model.friction") return "control.cancellation_friction";
  constexpr std::string_view master = "model.master";
  if (parameter.starts_with(master)) return std::string(model_section) + std::string(parameter.substr(master.size()));
  return std::string(parameter);
}

}  // namespace

Result<Cancellation::Params> read_cancellation(const std::filesystem::path& file) {
  const auto document = Document::load(file);
  if (!document) return document.error();
  auto params = read_cancellation(*document);
  if (!params) return params;
  if (Check missing = check_model_is_complete(*document)) return *std::move(missing);
  return params;
}

Result<Cancellation::Params> read_cancellation(const Document& document) {
  const auto file = document.read<CancellationFile>();
  if (!file) return file.error();
  return Cancellation::Params{.model = {.master = file->control.model,
                                        .fidelity = file->control.cancellation_model,
                                        .step = file->control.cancellation_step,
                                        .friction = file->control.cancellation_friction}};
}

Check check_model_is_complete(const Document& document) {
  control::MasterModel model;
  const std::vector<std::string> written = document.keys();
  for (const Binding& binding : bind(model, model_section)) {
    if (binding.is_section() || std::ranges::find(of_the_method, binding.path) != of_the_method.end()) continue;
    if (std::ranges::find(written, binding.path) != written.end()) continue;
    return Error{.code = ErrorCode::missing,
                 .parameter = std::string(binding.path),
                 .message =
                     "the model lacks it: write every key of [control.model.motor], cable, drum, linkage, handle and "
                     "hand, because the default belongs to another leader",
                 .place = document.name()};
  }
  return std::nullopt;
}

Error locate_cancellation(const Document& document, Error error) {
  error.parameter = key_in_file(error.parameter);
  return document.locate(std::move(error));
}

}  // namespace tactus::configuration
