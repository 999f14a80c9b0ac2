// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/agreed_parameters.hpp>
#include <tactus/kernel/core/binding.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <variant>

namespace tactus::control {

namespace {

/// Of a text so many cells are told; its digest counts whole.
constexpr std::size_t text_cells = 4;

std::size_t cells_of(const Binding& binding) {
  if (binding.is_section()) return 0;
  return std::holds_alternative<std::string*>(binding.target) ? text_cells : 1;
}

/// What a cell holds of a number, a flag or a word: its bits, or its place among the words.
std::uint64_t bits_of(const Binding& binding) {
  if (const auto* number = std::get_if<double*>(&binding.target)) return std::bit_cast<std::uint64_t>(**number);
  if (const auto* whole = std::get_if<std::int64_t*>(&binding.target)) return static_cast<std::uint64_t>(**whole);
  if (const auto* flag = std::get_if<bool*>(&binding.target)) return **flag ? 1 : 0;
  const auto& choice = std::get<Choice>(binding.target);
  const auto word = std::find(choice.words.begin(), choice.words.end(), choice.word_of(choice.member));
  return static_cast<std::uint64_t>(word - choice.words.begin());
}

/// The same as a person writes it. What came over a link may be anything.
std::string written(const Binding& binding, std::uint64_t bits) {
  if (std::holds_alternative<double*>(binding.target)) {
    const std::string number = format_number(std::bit_cast<double>(bits));
    return binding.unit.symbol[0] == '\0' ? number : number + " " + binding.unit.symbol;
  }
  if (std::holds_alternative<std::int64_t*>(binding.target)) return std::to_string(static_cast<std::int64_t>(bits));
  if (std::holds_alternative<bool*>(binding.target)) return bits == 0 ? "false" : "true";
  const auto& words = std::get<Choice>(binding.target).words;
  return bits < words.size() ? std::string(words[bits]) : "?";
}

std::string text_at(const auto& cell_at, std::size_t first) {
  std::string text;
  for (std::size_t i = 0; i < 8 * text_cells; ++i) {
    const auto letter = static_cast<char>(cell_at(first + i / 8) >> (8 * (i % 8)));
    // What came over a link may be anything.
    if (letter < ' ' || letter > '~') break;
    text += letter;
  }
  return text;
}

}  // namespace

AgreedParams agreed_params(const ControlParams& params, Seconds dt) {
  const SupervisionParams& supervision = params.supervision;
  AgreedParams all;
  all.architecture = params.architecture;
  all.rate_Hz = std::round(1e6 / dt.value) / 1e6;
  all.position_scale = params.position_scale;
  all.force_gain = params.force_gain;
  all.force_limit_N = params.force_limit_N;
  all.slave = params.slave;
  all.gate = params.gate;
  all.handle_gate = params.handle_gate;
  all.slave_gate = params.slave_gate;
  all.groups = params.groups;
  all.packets = supervision.packets;
  all.silence = supervision.silence;
  all.watchdog = supervision.watchdog;
  all.answer_within_s = supervision.answer_within_s;
  all.blend_s = supervision.blend_s;
  return all;
}

Agreement agreement_of(const ControlParams& params, Seconds dt) {
  AgreedParams all = agreed_params(params, dt);
  return agreement_of(bind(all));
}

Agreement agreement_of(std::span<const Binding> values) {
  Agreement agreement;
  for (const Binding& binding : values) {
    if (binding.is_section()) continue;
    if (const auto* const* text = std::get_if<std::string*>(&binding.target)) {
      const std::string& value = **text;
      agreement.add_to_digest(value);
      for (std::size_t cell = 0; cell < text_cells; ++cell) {
        std::uint64_t letters = 0;
        for (std::size_t i = 0; i < 8 && 8 * cell + i < value.size(); ++i) {
          letters |= std::uint64_t{static_cast<unsigned char>(value[8 * cell + i])} << (8 * i);
        }
        agreement.add(binding.path, letters);
      }
    } else {
      agreement.add(binding.path, bits_of(binding));
    }
  }
  return agreement;
}

Agreement agreement_of(const JointParams auto& params, Seconds dt) {
  Agreement agreement;
  for (const ControlParams& joint : params) agreement.add("joint", agreement_of(joint, dt).digest());
  return agreement;
}
template Agreement agreement_of(const Joints<ControlParams>&, Seconds);

std::optional<Disagreement> first_disagreement(const AgreementCheck& check) {
  AgreedParams any;
  return first_disagreement(check, bind(any));
}

std::optional<Disagreement> first_disagreement(const AgreementCheck& check, std::span<const Binding> values) {
  if (!check.disagrees() || check.first_difference() == 0) return std::nullopt;
  const std::size_t differing = check.first_difference() - 1;
  const auto own_at = [&check](std::size_t cell) { return check.own()[cell]; };
  const auto other_at = [&check](std::size_t cell) { return check.other(cell); };
  std::size_t cell = 0;
  for (const Binding& binding : values) {
    const std::size_t cells = cells_of(binding);
    if (differing >= cell && differing < cell + cells) {
      if (std::holds_alternative<std::string*>(binding.target)) {
        return Disagreement{binding.path, text_at(own_at, cell), text_at(other_at, cell)};
      }
      return Disagreement{binding.path, written(binding, own_at(cell)), written(binding, other_at(cell))};
    }
    cell += cells;
  }
  return std::nullopt;
}

}  // namespace tactus::control
