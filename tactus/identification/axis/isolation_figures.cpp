// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/identification/axis/frequency_response.hpp>
#include <tactus/identification/axis/isolation_figures.hpp>
#include <tactus/identification/axis/zero_phase.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace tactus::identification {

namespace {

using report::Axis;
using report::Dash;
using report::Line;
using report::Panel;

Panel panel(std::string title, Axis x, Axis y) {
  Panel empty;
  empty.title = std::move(title);
  empty.x = std::move(x);
  empty.y = std::move(y);
  return empty;
}

Line line(std::string name, int colour, Dash dash = Dash::solid) {
  Line empty;
  empty.name = std::move(name);
  empty.colour = colour;
  empty.dash = dash;
  return empty;
}

Axis axis(std::string label, std::string unit, Axis::Scale scale = Axis::Scale::linear) {
  Axis made;
  made.label = std::move(label);
  made.unit = std::move(unit);
  made.scale = scale;
  return made;
}

/// H1 from command to position within the band of the sweep; empty where the data hold none.
FrequencyResponse response(const BenchExperiment& experiment, const std::vector<double>& position_m) {
  const std::vector<double>& force_N = experiment.run.commanded_force_N;
  const auto segment = std::clamp<std::size_t>(std::bit_floor(force_N.size() / 5), 64, 16384);
  const InputOutput data{force_N, position_m};
  const auto spectra =
      average_spectra({&data, 1}, Seconds{experiment.run.tick_s}, {.samples = static_cast<std::int64_t>(segment)});
  return spectra ? response_h1(*spectra) : FrequencyResponse{};
}

void add_response(std::vector<Panel>& panels, const BenchExperiment& experiment,
                  const std::vector<double>& modelled_m) {
  const Axis frequency = axis("frequency", "Hz", Axis::Scale::logarithmic);
  Panel gain = panel(experiment.title, frequency, axis("position over force", "mm/N", Axis::Scale::logarithmic));
  Panel phase = panel("", frequency, axis("phase", "deg"));
  Panel coherence = panel("", frequency, axis("coherence", ""));
  const auto add = [&](const FrequencyResponse& h, const std::string& name, int colour, Dash dash) {
    Line magnitude = line(name, colour, dash), angle = line(name, colour, dash), coherent = line(name, colour, dash);
    for (std::size_t k = 0; k < h.frequency_Hz.size(); ++k) {
      if (h.frequency_Hz[k] < experiment.lower_Hz || h.frequency_Hz[k] > experiment.upper_Hz) continue;
      magnitude.x.push_back(h.frequency_Hz[k]);
      magnitude.y.push_back(1e3 * std::abs(h.response[k]));
      const double phase_deg = 180.0 / std::numbers::pi * std::arg(h.response[k]);
      angle.y.push_back(phase_deg > 90.0 ? phase_deg - 360.0 : phase_deg);  // a mass lags by 180, and a little more
      coherent.y.push_back(h.coherence[k]);
    }
    angle.x = coherent.x = magnitude.x;
    gain.lines.push_back(std::move(magnitude));
    phase.lines.push_back(std::move(angle));
    coherence.lines.push_back(std::move(coherent));
  };
  add(response(experiment, experiment.run.position_m), "measured", 0, Dash::solid);
  add(response(experiment, modelled_m), "model", 1, Dash::dashed);
  coherence.lines.pop_back();  // of the model it would only tell that it is one
  panels.push_back(std::move(gain));
  panels.push_back(std::move(phase));
  panels.push_back(std::move(coherence));
}

void add_loop(std::vector<Panel>& panels, const BenchExperiment& experiment, const std::vector<double>& modelled_m) {
  Panel loop = panel(experiment.title, axis("commanded force", "N"), axis("position", "mm"));
  Line measured = line("measured", 0), modelled = line("model", 1, Dash::dashed);
  constexpr std::size_t every = 10;
  for (std::size_t i = 0; i < modelled_m.size(); i += every) {
    measured.x.push_back(experiment.run.commanded_force_N[i]);
    measured.y.push_back(1e3 * experiment.run.position_m[i]);
    modelled.y.push_back(1e3 * modelled_m[i]);
  }
  modelled.x = measured.x;
  loop.lines = {std::move(measured), std::move(modelled)};
  panels.push_back(std::move(loop));
}

void add_motion(std::vector<Panel>& panels, const BenchExperiment& experiment, const std::vector<double>& modelled_m) {
  Panel motion = panel(experiment.title, axis("time", "s"), axis("measured less modelled position", "um"));
  Line left = line("", 0);
  for (std::size_t i = 0; i < modelled_m.size(); ++i) {
    left.x.push_back(static_cast<double>(i) * experiment.run.tick_s);
    left.y.push_back(1e6 * (experiment.run.position_m[i] - modelled_m[i]));
  }
  motion.lines.push_back(std::move(left));
  panels.push_back(std::move(motion));
  if (experiment.program.reference_m.empty()) return;
  Panel force = panel("", axis("reference", "mm"), axis("force, below 20 Hz", "N"));
  Line taken = line("", 0);
  const auto smooth = zero_phase_low_pass(experiment.run.commanded_force_N, 20.0, Seconds{experiment.run.tick_s});
  for (std::size_t i = 0; smooth && i < smooth->size(); ++i) {
    taken.x.push_back(1e3 * experiment.program.reference_m[i]);
    taken.y.push_back((*smooth)[i]);
  }
  force.lines.push_back(std::move(taken));
  panels.push_back(std::move(force));
}

}  // namespace

std::vector<report::Figure> figures(const Isolation& isolation) {
  std::vector<report::Figure> all;
  for (const IsolationStage& stage : isolation.stages) {
    report::Figure motions, responses;
    motions.title = responses.title = stage.title;
    motions.caption = responses.caption =
        "Measured less modelled position of the whole stage: " + report::number(1e6 * stage.residual_rms_m, 2) +
        " um rms.";
    motions.columns = 2;
    responses.columns = 3;
    for (std::size_t i = 0; i < stage.experiments.size(); ++i) {
      const BenchExperiment& experiment = stage.experiments[i];
      if (experiment.upper_Hz > 0.0) {
        add_response(responses.panels, experiment, stage.modelled_m[i]);
      } else if (experiment.assembly == Assembly::linkage) {
        add_loop(motions.panels, experiment, stage.modelled_m[i]);
      } else {
        add_motion(motions.panels, experiment, stage.modelled_m[i]);
      }
    }
    for (report::Figure* picture : {&motions, &responses}) {
      picture->columns = std::min(picture->columns, static_cast<int>(picture->panels.size()));
      if (!picture->panels.empty()) all.push_back(std::move(*picture));
    }
  }
  return all;
}

report::Figure figure(const ImpactCheck& check) {
  report::Figure picture;
  picture.title = "Impacts that no fit has seen";
  picture.caption = "Motion above 20 Hz that displayed impacts induce in the held master. The model leaves " +
                    report::number(100.0 * check.residual, 2) + " % of it.";
  Panel motion = panel("", axis("time", "s"), axis("position above 20 Hz", "um"));
  Line measured = line("measured", 0), modelled = line("model", 1, Dash::dashed);
  for (std::size_t i = 0; i < check.measured_m.size(); ++i) {
    measured.x.push_back(static_cast<double>(i) * check.tick_s);
    measured.y.push_back(1e6 * check.measured_m[i]);
    modelled.y.push_back(1e6 * check.modelled_m[i]);
  }
  modelled.x = measured.x;
  motion.lines = {std::move(measured), std::move(modelled)};
  picture.panels = {std::move(motion)};
  return picture;
}

}  // namespace tactus::identification
