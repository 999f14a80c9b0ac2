// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/unit_words.hpp>
#include <tactus/kernel/core/units.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace tactus::recording {
namespace {

using Word = std::pair<std::string_view, std::string_view>;

/// Spellings whose letters must be exactly these, for `mN` is not `MN`.
constexpr std::array exact_words{
    Word{"Nm", "N m"},    Word{"mNm", "mN m"},      Word{"kNm", "kN m"},     Word{"Ncm", "N cm"},
    Word{"°", "deg"},     Word{"º", "deg"},         Word{"°/s", "deg/s"},    Word{"µs", "us"},
    Word{"μs", "us"},     Word{"µm", "um"},         Word{"μm", "um"},        Word{"um", "um"},
    Word{"cm", "cm"},     Word{"km", "km"},         Word{"mA", "mA"},        Word{"uA", "uA"},
    Word{"kA", "kA"},     Word{"mV", "mV"},         Word{"kV", "kV"},        Word{"MN", "MN"},
    Word{"mrad", "mrad"}, Word{"urad", "urad"},     Word{"g", "g"},          Word{"kg", "kg"},
    Word{"kgf", "kgf"},   Word{"gf", "gf"},         Word{"lbf", "lbf"},      Word{"lb", "lbf"},
    Word{"oz", "oz"},     Word{"in", "in"},         Word{"ft", "ft"},        Word{"psi", "psi"},
    Word{"MPa", "MPa"},   Word{"kPa", "kPa"},       Word{"°C", "degC"},      Word{"C", "degC"},
    Word{"degC", "degC"}, Word{"K", "K"},           Word{"%", "%"},          Word{"h", "h"},
    Word{"hr", "h"},      Word{"min", "min"},       Word{"rpm", "rpm"},      Word{"dps", "deg/s"},
    Word{"mps", "m/s"},   Word{"kHz", "kHz"},       Word{"MHz", "MHz"},      Word{"cm/s", "cm/s"},
    Word{"lx", "lx"},     Word{"dB", "dB"},         Word{"kN", "kN"},        Word{"mN", "mN"},
    Word{"N", "N"},       Word{"rev", "rev"},       Word{"W", "W"},          Word{"mW", "mW"},
    Word{"Ohm", "Ohm"},   Word{"counts", "counts"}, Word{"ticks", "counts"}, Word{"count", "counts"}};

/// Words in small letters.
constexpr std::array loose_words{
    Word{"newton", "N"},        Word{"newtons", "N"},        Word{"kilonewton", "kN"},   Word{"kilonewtons", "kN"},
    Word{"millinewton", "mN"},  Word{"millinewtons", "mN"},  Word{"newtonmeter", "N m"}, Word{"newtonmeters", "N m"},
    Word{"newtonmetre", "N m"}, Word{"newtonmetres", "N m"}, Word{"meter", "m"},         Word{"meters", "m"},
    Word{"metre", "m"},         Word{"metres", "m"},         Word{"millimeter", "mm"},   Word{"millimeters", "mm"},
    Word{"millimetre", "mm"},   Word{"millimetres", "mm"},   Word{"centimeter", "cm"},   Word{"centimeters", "cm"},
    Word{"centimetre", "cm"},   Word{"centimetres", "cm"},   Word{"micrometer", "um"},   Word{"micrometers", "um"},
    Word{"micrometre", "um"},   Word{"micrometres", "um"},   Word{"micron", "um"},       Word{"microns", "um"},
    Word{"radian", "rad"},      Word{"radians", "rad"},      Word{"rads", "rad"},        Word{"degree", "deg"},
    Word{"degrees", "deg"},     Word{"degs", "deg"},         Word{"grad", "deg"},        Word{"sec", "s"},
    Word{"secs", "s"},          Word{"second", "s"},         Word{"seconds", "s"},       Word{"sekunden", "s"},
    Word{"msec", "ms"},         Word{"msecs", "ms"},         Word{"millis", "ms"},       Word{"millisecond", "ms"},
    Word{"milliseconds", "ms"}, Word{"usec", "us"},          Word{"usecs", "us"},        Word{"micros", "us"},
    Word{"microsecond", "us"},  Word{"microseconds", "us"},  Word{"nsec", "ns"},         Word{"nsecs", "ns"},
    Word{"nanos", "ns"},        Word{"nanosec", "ns"},       Word{"nanosecs", "ns"},     Word{"nanosecond", "ns"},
    Word{"nanoseconds", "ns"},  Word{"minutes", "min"},      Word{"hours", "h"},         Word{"amp", "A"},
    Word{"amps", "A"},          Word{"ampere", "A"},         Word{"amperes", "A"},       Word{"milliamp", "mA"},
    Word{"milliamps", "mA"},    Word{"milliampere", "mA"},   Word{"milliamperes", "mA"}, Word{"volt", "V"},
    Word{"volts", "V"},         Word{"hertz", "Hz"},         Word{"hz", "Hz"},           Word{"kilogram", "kg"},
    Word{"kilograms", "kg"},    Word{"watt", "W"},           Word{"watts", "W"},         Word{"inch", "in"},
    Word{"inches", "in"}};

std::string in_small_letters(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

/// One spelling, as it stands.
std::string one_word(const std::string& text) {
  for (const Unit& unit : units::known) {
    if (text == unit.symbol) return text;
  }
  for (const auto& [spelling, symbol] : exact_words) {
    if (text == spelling) return std::string(symbol);
  }
  const std::string small = in_small_letters(text);
  for (const auto& [spelling, symbol] : loose_words) {
    if (small == spelling) return std::string(symbol);
  }
  return {};
}

/// Words between blanks, dots, stars and the like, which multiply.
std::string product(const std::string& text) {
  if (std::string whole = one_word(text); !whole.empty()) return whole;
  std::string joined;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find_first_of(" .*-_", start), text.size());
    const std::string factor = one_word(text.substr(start, end - start));
    if (factor.empty()) return {};
    joined += (joined.empty() ? "" : " ") + factor;
    start = end + 1;
  }
  return joined;
}

/// A kind of quantity: the words that a column of it is called, and its units.
struct Quantity {
  std::vector<std::string_view> names;
  std::vector<std::string_view> units;
};

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all{
      {{"time", "t", "stamp", "timestamp", "clock", "zeit", "elapsed", "duration", "delay", "lag", "period"},
       {"s", "ms", "us", "ns", "min", "h", "cycles", "N m", "mN m"}},
      {{"x", "y", "z", "pos", "position", "displacement", "travel", "distance"},
       {"m", "mm", "cm", "um", "rad", "mrad", "deg", "V"}},
      {{"q", "theta", "phi", "psi", "angle"}, {"rad", "mrad", "deg", "mm", "cm", "um"}},
      {{"v", "vel", "velocity", "speed", "dx", "dy", "dz", "dq", "qd", "xd", "dtheta", "omega", "xdot", "qdot"},
       {"m/s", "mm/s", "cm/s", "rad/s", "deg/s", "rpm", "V"}},
      {{"f", "force", "fx", "fy", "fz"}, {"N", "mN", "kN", "MN", "kgf", "gf", "lbf", "Hz", "N m"}},
      {{"tau", "torque", "effort"}, {"N m", "mN m", "kN m", "N cm", "A", "mA", "N", "mN", "kN", "%"}},
      {{"i", "iq", "current"}, {"A", "mA", "uA", "kA"}},
      {{"u"}, {"V", "mV", "A", "mA", "N", "N m", "%"}}};
  return all;
}

/// Words that say which value of a quantity, after which the quantity is looked for further left.
bool is_attribute(std::string_view word) {
  constexpr std::array words{std::string_view{"des"},      std::string_view{"desired"}, std::string_view{"ref"},
                             std::string_view{"cmd"},      std::string_view{"meas"},    std::string_view{"measured"},
                             std::string_view{"act"},      std::string_view{"actual"},  std::string_view{"filt"},
                             std::string_view{"filtered"}, std::string_view{"raw"},     std::string_view{"d"},
                             std::string_view{"m"},        std::string_view{"s"}};
  return std::find(words.begin(), words.end(), word) != words.end();
}

const Quantity* quantity_of(std::string_view name) {
  const std::string small = in_small_letters(name);
  std::string_view rest = small;
  while (!rest.empty()) {
    const std::size_t cut = rest.find_last_of("_. /");
    std::string_view word = cut == std::string_view::npos ? rest : rest.substr(cut + 1);
    rest = cut == std::string_view::npos ? std::string_view{} : rest.substr(0, cut);
    while (word.size() > 1 && std::isdigit(static_cast<unsigned char>(word.back())) != 0) word.remove_suffix(1);
    for (const Quantity& quantity : quantities()) {
      if (std::find(quantity.names.begin(), quantity.names.end(), word) != quantity.names.end()) return &quantity;
    }
    if (!is_attribute(word)) return nullptr;
  }
  return nullptr;
}

}  // namespace

std::string unit_of(std::string_view text) {
  std::string plain(text);
  for (const char* const dot : {"·", "⋅", "•"}) replace_all(plain, dot, " ");
  replace_all(plain, "²", "^2");
  replace_all(plain, " per ", "/");
  replace_all(plain, "^-1", "-1");
  replace_all(plain, "⁻¹", "-1");
  for (const char* const blanks : {" /", "/ "}) replace_all(plain, blanks, "/");
  for (const char* const second : {" s-1", ".s-1", "*s-1"}) replace_all(plain, second, "/s");
  if (std::string whole = one_word(plain); !whole.empty()) return whole;
  const std::size_t over = plain.find('/');
  std::string above = product(plain.substr(0, over));
  if (over == std::string::npos || above.empty()) return above;
  std::string below = plain.substr(over + 1);
  std::string power;
  if (below == "s2") below = "s^2";
  if (const std::size_t hat = below.find('^'); hat != std::string::npos) {
    power = below.substr(hat);
    below.resize(hat);
  }
  below = product(below);
  return below.empty() ? std::string{} : above + "/" + below + power;
}

bool unit_fits_name(std::string_view name, std::string_view unit) {
  const Quantity* const quantity = quantity_of(name);
  if (quantity == nullptr) return true;
  return std::find(quantity->units.begin(), quantity->units.end(), unit) != quantity->units.end();
}

}  // namespace tactus::recording
