// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/identification/diagnosis/line.hpp>
#include <tactus/identification/diagnosis/report.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace tactus::diagnosis {

namespace {

std::string gain_text(const Finding& finding) {
  if (!finding.loop_gain) return "–";
  return report::number(finding.loop_gain->value, 2) + " (" + report::number(finding.loop_gain->lower, 2) + " to " +
         report::number(finding.loop_gain->upper, 2) + ")";
}

report::Table table_of(const Diagnosis& diagnosis) {
  using Align = report::Column::Align;
  report::Table table({{.title = "frequency", .unit = "Hz"},
                       {.title = "from", .unit = "s"},
                       {.title = "to", .unit = "s"},
                       {.title = "share", .unit = "%"},
                       {.title = "mechanism", .unit = "", .align = Align::left},
                       {.title = "confidence"},
                       {.title = "loop gain"}});
  for (const Finding& finding : diagnosis.findings) {
    table.add_row({report::number(finding.oscillation.frequency_Hz, 3), report::number(finding.oscillation.from_s, 3),
                   report::number(finding.oscillation.to_s, 3), report::number(100.0 * finding.oscillation.share, 2),
                   std::string(word_of(finding.decision.mechanism)), report::number(finding.decision.confidence, 2),
                   gain_text(finding)});
  }
  return table;
}

/// The signal to look at: where the strongest oscillation shows best.
Role shown_role(const Signals& signals, const Diagnosis& diagnosis) {
  for (const Role role : all_roles) {
    if (!diagnosis.findings.empty() && diagnosis.findings.front().oscillation.signal == words_of(role)) return role;
  }
  const Channel* slave = signals.find(Role::slave_position);
  return slave != nullptr && !slave->constant() ? Role::slave_position : Role::master_position;
}

std::string unit_of(const Signals& signals, Role role) {
  return is_position(role) ? (signals.rotary ? "mrad" : "mm") : (signals.rotary ? "N m" : "N");
}

std::string colour_of(double share) {
  constexpr std::array<double, 3> dark{0x2b, 0x1b, 0x4b}, pale{0xff, 0xf3, 0xb0};
  constexpr const char* digits = "0123456789abcdef";
  std::string text = "#";
  for (std::size_t i = 0; i < 3; ++i) {
    const auto mixed = static_cast<std::size_t>(std::lround(dark[i] + share * (pale[i] - dark[i])));
    text += digits[mixed / 16];
    text += digits[mixed % 16];
  }
  return text;
}

nlohmann::ordered_json json_of(const std::optional<Following>& following) {
  using Json = nlohmann::ordered_json;
  if (!following) return nullptr;
  const auto& lag = following->lag_s;
  Json one{{"lag_s", lag.value},
           {"lag_interval_95_s", {lag.lower, lag.upper}},
           {"moves_to_Hz", following->moves_to_Hz},
           {"constant_delay_s", nullptr},
           {"constant_delay_interval_s", nullptr},
           {"bandwidth_Hz", nullptr}};
  if (following->constant_s) {
    one["constant_delay_s"] = following->constant_s->value;
    one["constant_delay_interval_s"] = {following->constant_s->lower, following->constant_s->upper};
  }
  if (following->bandwidth_Hz) one["bandwidth_Hz"] = *following->bandwidth_Hz;
  return one;
}

}  // namespace

std::string to_text(const Signals& signals, const Diagnosis& diagnosis) {
  std::string text = diagnosis.verdict + "\n";
  if (!diagnosis.findings.empty()) text += table_of(diagnosis).to_text();
  for (const Finding& finding : diagnosis.findings) {
    text += report::number(finding.oscillation.frequency_Hz, 3) + " Hz, strongest in the " +
            finding.oscillation.signal + ":\n";
    for (const std::string& sentence : finding.decision.evidence) text += "  - " + sentence + "\n";
  }
  if (diagnosis.following) text += text_of(*diagnosis.following, signals) + "\n";
  if (!diagnosis.record_next.empty()) text += "Record next:\n";
  for (const std::string& next : diagnosis.record_next) text += "  - " + next + "\n";
  std::string read;
  for (const Role role : all_roles) {
    if (const Channel* channel = signals.find(role)) {
      read += (read.empty() ? "" : ", ") + std::string(words_of(role)) + " = " + channel->name;
    }
  }
  for (const auto* told : {&signals.master_velocity, &signals.slave_velocity}) {
    if (*told) read += ", " + (*told)->name + " (" + report::number((*told)->scale, 3) + " times its position's)";
  }
  text += "Read: " + read + "; every " + report::number(1e3 * signals.sample_time.value, 3) + " ms\n";
  for (const std::string& note : signals.notes) text += "Note: " + note + "\n";
  return text;
}

std::string to_json(const Signals& signals, const Diagnosis& diagnosis, const std::string& file) {
  using Json = nlohmann::ordered_json;
  Json document{
      {"oscillations", Json::array()}, {"verdict", diagnosis.verdict}, {"record_next", diagnosis.record_next}};
  for (const Finding& finding : diagnosis.findings) {
    Json one{{"frequency_Hz", finding.oscillation.frequency_Hz},
             {"from_s", finding.oscillation.from_s},
             {"to_s", finding.oscillation.to_s},
             {"share", finding.oscillation.share},
             {"signal", finding.oscillation.signal},
             {"mechanism", word_of(finding.decision.mechanism)},
             {"confidence", finding.decision.confidence},
             {"loop_gain", nullptr},
             {"loop_gain_interval_95", nullptr},
             {"evidence", finding.decision.evidence}};
    if (finding.loop_gain) {
      one["loop_gain"] = finding.loop_gain->value;
      one["loop_gain_interval_95"] = {finding.loop_gain->lower, finding.loop_gain->upper};
    }
    Json possible = Json::array();
    for (const Mechanism mechanism : finding.decision.possible) possible.push_back(word_of(mechanism));
    one["possible"] = possible;
    document["oscillations"].push_back(std::move(one));
  }
  document["following"] = json_of(diagnosis.following);
  document["recording"] = file;
  document["sample_time_s"] = signals.sample_time.value;
  document["samples"] = signals.samples;
  Json read = Json::object();
  for (const Role role : all_roles) {
    std::string key(words_of(role));
    std::replace(key.begin(), key.end(), ' ', '_');
    const Channel* channel = signals.find(role);
    read[key] = channel == nullptr ? Json(nullptr) : Json(channel->name);
  }
  document["signals"] = read;
  const auto scale = [](const std::optional<ReportedVelocity>& told) {
    return told ? Json(told->scale) : Json(nullptr);
  };
  document["reported_velocity_scale"] = {{"master", scale(signals.master_velocity)},
                                         {"slave", scale(signals.slave_velocity)}};
  document["notes"] = signals.notes;
  return report::json_text(document);
}

report::HeatMap spectrogram_of(const Signals& signals, const Diagnosis& diagnosis) {
  constexpr double frames_wanted = 120.0, decades = 6.0;
  constexpr std::size_t shades = 6, rows = 72;
  const Role role = shown_role(signals, diagnosis);
  const Seconds dt = signals.sample_time;
  const double slowest_Hz = diagnosis.findings.empty() ? 10.0 : diagnosis.findings.front().oscillation.frequency_Hz;
  const double frame_s = std::clamp(10.0 / slowest_Hz, 0.25, 0.25 * signals.duration_s());
  const std::size_t frame = std::clamp<std::size_t>(std::bit_floor(static_cast<std::size_t>(frame_s / dt.value)), 16,
                                                    std::bit_floor(signals.samples));
  const std::size_t hop =
      std::max<std::size_t>(1, static_cast<std::size_t>(static_cast<double>(signals.samples - frame) / frames_wanted));
  const Spectrogram found = spectrogram(signals.values(role), frame, hop, dt);

  report::HeatMap map;
  map.title = "Spectrogram of the " + std::string(words_of(role));
  map.x.label = "time", map.x.unit = "s", map.x.values = found.time_s;
  map.y.label = "frequency", map.y.unit = "Hz", map.y.logarithmic = true;
  map.panels.resize(1);
  map.panels[0].title = "power, in decades below the largest";
  for (std::size_t shade = 0; shade < shades; ++shade) {
    const std::string from = std::to_string(shades - 1 - shade);
    map.classes.push_back({shade == 0 ? "more than " + from : from + " to " + std::to_string(shades - shade),
                           colour_of(static_cast<double>(shade) / (shades - 1.0)),
                           colour_of(1.0 - static_cast<double>(shade) / (shades - 1.0))});  // strong is bright there
  }
  const double lowest_Hz = found.frequency_Hz[1], highest_Hz = found.frequency_Hz.back();
  const double ratio = std::pow(highest_Hz / lowest_Hz, 1.0 / static_cast<double>(rows - 1));
  for (std::size_t r = 0; r < rows; ++r) map.y.values.push_back(lowest_Hz * std::pow(ratio, static_cast<double>(r)));
  // Positions are weighted with the frequency squared, as velocities are, so that fast motion can be seen.
  const auto weighted = [&](std::size_t i, std::size_t k) {
    return found.power[i][k] * (is_position(role) ? found.frequency_Hz[k] * found.frequency_Hz[k] : 1.0);
  };
  double largest = 0.0;
  for (std::size_t i = 0; i < found.power.size(); ++i) {
    for (std::size_t k = 1; k < found.frequency_Hz.size(); ++k) largest = std::max(largest, weighted(i, k));
  }
  for (const double f_Hz : map.y.values) {
    const auto k = std::clamp<std::size_t>(static_cast<std::size_t>(std::llround(f_Hz / found.frequency_Hz[1])), 1,
                                           found.frequency_Hz.size() - 1);
    for (std::size_t i = 0; i < found.power.size(); ++i) {
      const double below = std::log10(largest / std::max(weighted(i, k), 1e-30));
      const double level = std::clamp(1.0 - below / decades, 0.0, 0.999);
      map.panels[0].cells.push_back(static_cast<std::size_t>(level * static_cast<double>(shades)));
    }
  }
  return map;
}

std::optional<report::Figure> periods_of(const Signals& signals, const Diagnosis& diagnosis) {
  if (diagnosis.findings.empty()) return std::nullopt;
  const Oscillation& oscillation = diagnosis.findings.front().oscillation;
  const double dt_s = signals.sample_time.value;
  const double middle_s = 0.5 * (oscillation.from_s + oscillation.to_s);
  const double half_s = std::min(6.0 / oscillation.frequency_Hz, 0.5 * (oscillation.to_s - oscillation.from_s));
  const auto from = static_cast<std::size_t>(std::max(0.0, middle_s - half_s) / dt_s);
  const auto to = std::min(signals.samples, static_cast<std::size_t>((middle_s + half_s) / dt_s));
  report::Figure figure;
  figure.title = "A dozen periods";
  figure.caption = "The signals about the middle of the strongest oscillation.";
  figure.columns = 1;
  figure.share_x = report::Sharing::in_line;
  for (const Role role : all_roles) {
    const Channel* channel = signals.find(role);
    if (channel == nullptr) continue;
    report::Line line{.name = {}, .x = {}, .y = {}};
    for (std::size_t i = from; i < to; ++i) {
      line.x.push_back(static_cast<double>(i) * dt_s);
      line.y.push_back(channel->values[i] * (is_position(role) ? 1e3 : 1.0));
    }
    report::Panel panel;
    panel.x.label = "time", panel.x.unit = "s";
    panel.y.label = std::string(words_of(role)), panel.y.unit = unit_of(signals, role);
    panel.lines.push_back(std::move(line));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

std::string loop_of(const Signals& signals, const Finding& finding) {
  const Oscillation& oscillation = finding.oscillation;
  const double dt_s = signals.sample_time.value;
  const auto from = static_cast<std::size_t>(oscillation.from_s / dt_s);
  const auto to = std::min(signals.samples, static_cast<std::size_t>(oscillation.to_s / dt_s));
  const double length = static_cast<double>(to - from);
  const auto block = std::max<std::size_t>(
      8, static_cast<std::size_t>(std::min(length, std::max(length / 8.0, 3.0 / (oscillation.frequency_Hz * dt_s)))));
  const auto blocks_of = [&](Role role) {
    return line_in_blocks(signals.values(role).subspan(from, to - from), block, oscillation.frequency_Hz,
                          signals.sample_time);
  };
  const Role zero = signals.find(Role::master_position) != nullptr ? Role::master_position : Role::slave_position;
  const std::vector<Complex> reference = blocks_of(zero);
  const auto told = [&](Role role) -> std::string {
    if (signals.find(role) == nullptr) return "not recorded";
    const std::vector<Complex> blocks = blocks_of(role);
    const Relation with = relation(reference, blocks);
    const std::string size =
        report::number(usual_size(blocks) * (is_position(role) ? 1e3 : 1.0), 3) + " " + unit_of(signals, role);
    if (role == zero) return size + ", 0°";
    if (with.coherence < 0.3) return size + ", no fixed phase";
    return size + ", " + report::number(with.angle_rad * 180.0 / std::numbers::pi, 3) + "°";
  };
  const auto mark = [&](std::initializer_list<Mechanism> mechanisms) {
    return std::find(mechanisms.begin(), mechanisms.end(), finding.decision.mechanism) != mechanisms.end()
               ? "  <== here"
               : "";
  };
  using enum Mechanism;
  std::string text;
  text += "  hand      --( force     " + told(Role::hand_force) + " )" + mark({tremor}) + "\n";
  text += "    v\n";
  text += "  master    --( position  " + told(Role::master_position) + " )" +
          mark({induced_motion, delay, virtual_wall}) + "\n";
  text +=
      "    |  ^ displayed force  " + told(Role::displayed_force) + mark({induced_motion, delay, virtual_wall}) + "\n";
  text += "    v  |\n";
  text += "  slave     --( position  " + told(Role::slave_position) + " )" +
          mark({slave_servo, quantisation, stick_slip, induced_motion, delay}) + "\n";
  text += "    |  ^ its motor        " + told(Role::slave_force) + mark({slave_servo, quantisation, stick_slip}) + "\n";
  text += "    v  |\n";
  text += "  contact   --( tip force " + told(Role::tip_force) + " )" + mark({induced_motion}) + "\n";
  return text;
}

report::Page to_page(const Signals& signals, const Diagnosis& diagnosis, const std::string& file) {
  report::Page page("Why it shakes: " + file);
  page.paragraph(diagnosis.verdict);
  if (!diagnosis.findings.empty()) page.table(table_of(diagnosis));
  const report::HeatMap map = spectrogram_of(signals, diagnosis);
  if (map.x.values.size() > 1) {
    page.figure(map, is_position(shown_role(signals, diagnosis)) ? "Weighted as a velocity is." : "Power as recorded.");
  }
  for (const Finding& finding : diagnosis.findings) {
    page.heading(report::number(finding.oscillation.frequency_Hz, 3) +
                 " Hz: " + std::string(words_of(finding.decision.mechanism)));
    for (const std::string& sentence : finding.decision.evidence) page.paragraph(sentence + ".");
    page.code(loop_of(signals, finding),
              "The loop: amplitude and phase at this frequency, the phase against the first position");
  }
  if (const auto figure = periods_of(signals, diagnosis)) page.figure(*figure);
  if (diagnosis.following) {
    page.heading("How the follower follows");
    page.paragraph(text_of(*diagnosis.following, signals));
  }
  if (!diagnosis.record_next.empty()) page.heading("Record next");
  for (const std::string& next : diagnosis.record_next) page.paragraph(next + ".");
  for (const std::string& note : signals.notes) page.paragraph("Note: " + note + ".");
  return page;
}

}  // namespace tactus::diagnosis
