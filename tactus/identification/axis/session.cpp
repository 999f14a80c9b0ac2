// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/recording.hpp>
#include <tactus/data/report/files.hpp>
#include <tactus/identification/axis/session.hpp>

#include <cstdio>
#include <fstream>
#include <utility>

namespace tactus::identification {

namespace {

std::string first_line(const std::string& rig, std::size_t number, Assembly assembly, const MotorProgram& program) {
  char program_text[20];
  std::snprintf(program_text, sizeof program_text, "%016llx", static_cast<unsigned long long>(fingerprint(program)));
  std::string line = "# tactus run ";
  line += std::to_string(number) + " of " + rig + ", assembly " + name_of(assembly) + ", program " + program_text;
  return line;
}

std::string csv_of(const RigRun& run, const std::string& heading) {
  const bool current = !run.current_force_N.empty();
  std::string text = heading;
  text += current ? "\ntime_s,commanded_N,position_m,current_N\n" : "\ntime_s,commanded_N,position_m\n";
  for (std::size_t i = 0; i < run.position_m.size(); ++i) {
    text += format_number(static_cast<double>(i) * run.tick_s);
    text += ',';
    text += format_number(run.commanded_force_N[i]);
    text += ',';
    text += format_number(run.position_m[i]);
    if (current) {
      text += ',';
      text += format_number(run.current_force_N[i]);
    }
    text += '\n';
  }
  return text;
}

Error damaged(const std::filesystem::path& file, std::string what) {
  return {ErrorCode::inconsistent, {}, std::move(what), file.string()};
}

Result<RigRun> replay(const std::filesystem::path& file, const std::string& heading, double tick_s, std::size_t ticks) {
  std::string found;
  {
    std::ifstream stream(file);
    std::getline(stream, found);
  }
  if (!found.empty() && found.back() == '\r') found.pop_back();
  if (found != heading) {
    return damaged(file, "this is not the run that is needed here, which would begin with \"" + heading +
                             "\": name the session's own folder, or a new one");
  }
  RigRun run;
  run.tick_s = tick_s;
  const std::pair<const char*, std::vector<double>*> columns[] = {
      {"commanded_N", &run.commanded_force_N}, {"position_m", &run.position_m}, {"current_N", &run.current_force_N}};
  const auto contents = recording::contents(file);
  if (!contents) return contents.error();
  const bool current = contents->size() > 3;
  for (const auto& [name, values] : columns) {
    if (values == &run.current_force_N && !current) continue;
    auto signal = recording::read({.file = file, .variable = name, .sample_time_s = tick_s});
    if (!signal) {
      Error error = signal.error();
      if (error.place.empty()) error.place = file.string();
      return error;
    }
    if (signal->values.size() != ticks) {
      return damaged(file, "there are " + std::to_string(signal->values.size()) + " samples of " + name + " and not " +
                               std::to_string(ticks) + ", as the program has: remove the file to run it again");
    }
    *values = std::move(signal->values);
  }
  return run;
}

}  // namespace

Result<SessionRig> SessionRig::open(Rig& rig, const std::filesystem::path& folder) {
  if (auto error = report::prepare_directory(folder)) return *std::move(error);
  return SessionRig(rig, folder);
}

Check SessionRig::assemble(Assembly assembly) {
  wanted_ = assembly;
  return {};
}

Result<RigRun> SessionRig::run(const MotorProgram& program) {
  ++runs_;
  char name[32];
  std::snprintf(name, sizeof name, "run-%03zu.csv", runs_);
  const std::filesystem::path file = folder_ / name;
  const std::string heading = first_line(rig_->name(), runs_, wanted_, program);
  if (std::error_code ignored; std::filesystem::exists(file, ignored)) {
    ++replayed_;
    return replay(file, heading, rig_->tick_s(), length(program));
  }
  if (standing_ != wanted_) {
    if (auto error = rig_->assemble(wanted_)) return *std::move(error);
    standing_ = wanted_;
  }
  auto run = rig_->run(program);
  if (!run) return run;
  if (auto error = report::write_file(file, csv_of(*run, heading))) return *std::move(error);
  return run;
}

}  // namespace tactus::identification
