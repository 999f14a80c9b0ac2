#include <tactus/control/agreed_parameters.hpp>

#include <bit>
#include <cmath>
#include <cstring>

namespace tactus::control {

namespace {

/// Of a text so many cells are told; its digest counts whole.
constexpr std::size_t text_cells = 4;

template <class Value>
constexpr std::size_t cells_of() {
  if constexpr (Described<Value>) {
    std::size_t cells = 0;
    for_each_field<Value>(
        [&cells](const auto& f) { cells += cells_of<typename std::remove_cvref_t<decltype(f)>::value_type>(); });
    return cells;
  } else {
    return std::is_same_v<Value, std::string> ? text_cells : 1;
  }
}
static_assert(cells_of<AgreedParams>() <= Agreement::most_cells, "every value finds a cell");

/// Calls `visit(key, value, unit)` for each value of `params`, in order.
template <Described T, class Visit>
void for_each_value(const T& params, const std::string& group, const Visit& visit) {
  for_each_field<T>([&](const auto& f) {
    const auto& value = params.*f.member;
    if constexpr (Described<std::remove_cvref_t<decltype(value)>>) {
      for_each_value(value, group + f.name + ".", visit);
    } else {
      visit(group + f.name, value, f.unit);
    }
  });
}

std::uint64_t bits_of(double value) { return std::bit_cast<std::uint64_t>(value); }
template <class Whole>
std::uint64_t bits_of(Whole value) {
  return static_cast<std::uint64_t>(value);
}

std::string written(double, std::uint64_t bits, const Unit& unit) {
  const std::string number = format_number(std::bit_cast<double>(bits));
  return unit.symbol[0] == '\0' ? number : number + " " + unit.symbol;
}
template <class Whole>
std::string written(Whole, std::uint64_t bits, const Unit&) {
  if constexpr (NamedEnum<Whole>) {
    return name_of(static_cast<Whole>(bits));
  } else {
    return std::to_string(static_cast<Whole>(bits));
  }
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

AgreedParams agreed(const ControlParams& params, Seconds dt) {
  const SupervisionParams& supervision = params.supervision;
  return {.architecture = params.architecture,
          .rate_Hz = std::round(1e6 / dt.value) / 1e6,
          .position_scale = params.position_scale,
          .force_gain = params.force_gain,
          .force_limit_N = params.force_limit_N,
          .slave = params.slave,
          .gate = params.gate,
          .handle_gate = params.handle_gate,
          .slave_gate = params.slave_gate,
          .four_channel = params.four_channel,
          .projection = params.projection,
          .compliance = params.compliance,
          .wave = params.wave,
          .passivity = params.passivity,
          .tank = params.tank,
          .packets = supervision.packets,
          .silence = supervision.silence,
          .watchdog = supervision.watchdog,
          .answer_within_s = supervision.answer_within_s,
          .blend_s = supervision.blend_s};
}

}  // namespace

Agreement agreement_of(const ControlParams& params, Seconds dt) {
  Agreement agreement;
  for_each_value(agreed(params, dt), {}, [&](const std::string& key, const auto& value, const Unit&) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, std::string>) {
      agreement.add_to_digest(value);
      for (std::size_t cell = 0; cell < text_cells; ++cell) {
        std::uint64_t letters = 0;
        for (std::size_t i = 0; i < 8 && 8 * cell + i < value.size(); ++i) {
          letters |= std::uint64_t{static_cast<unsigned char>(value[8 * cell + i])} << (8 * i);
        }
        agreement.add(key, letters);
      }
    } else {
      agreement.add(key, bits_of(value));
    }
  });
  return agreement;
}

std::optional<Disagreement> first_disagreement(const AgreementCheck& check) {
  if (!check.disagrees() || check.first_difference() == 0) return std::nullopt;
  const std::size_t differing = check.first_difference() - 1;
  const auto own_at = [&check](std::size_t cell) { return check.own()[cell]; };
  const auto other_at = [&check](std::size_t cell) { return check.other(cell); };
  std::optional<Disagreement> found;
  std::size_t cell = 0;
  for_each_value(AgreedParams(), {}, [&](const std::string& key, const auto& value, const Unit& unit) {
    using Value = std::remove_cvref_t<decltype(value)>;
    const bool here = differing >= cell && differing < cell + cells_of<Value>();
    if constexpr (std::is_same_v<Value, std::string>) {
      if (here) found = {key, text_at(own_at, cell), text_at(other_at, cell)};
    } else {
      if (here) found = {key, written(value, own_at(cell), unit), written(value, other_at(cell), unit)};
    }
    cell += cells_of<Value>();
  });
  return found;
}

}  // namespace tactus::control
