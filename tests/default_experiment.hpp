// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/document.hpp>

#include <stdexcept>
#include <string>

namespace tactus {

/// The parameters that `experiments/NAME.toml` of this repository describes, so that the tests judge what a user runs.
template <class Params>
Params experiment_file(const std::string& name) {
  const auto document = configuration::Document::load(std::string(TACTUS_EXPERIMENT_FOLDER) + "/" + name + ".toml");
  if (!document) throw std::runtime_error(describe(document.error()));
  const auto params = document->read<Params>();
  if (!params) throw std::runtime_error(describe(params.error()));
  return *params;
}

}  // namespace tactus
