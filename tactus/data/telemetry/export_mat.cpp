// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/files.hpp>
#include <tactus/data/telemetry/export.hpp>
#include <tactus/data/telemetry/export_parts.hpp>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <matio.h>

namespace tactus::telemetry {

namespace {

struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
struct CloseFile {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
using Variable = std::unique_ptr<matvar_t, FreeVariable>;

// matio copies the data and takes it as not const all the same.
Variable column_vector(std::vector<double> values) {
  std::array<std::size_t, 2> sizes{values.size(), 1};
  return Variable(Mat_VarCreate(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sizes.data(), values.data(), 0));
}

Variable text(std::string content) {
  std::array<std::size_t, 2> sizes{content.empty() ? std::size_t{0} : std::size_t{1}, content.size()};
  return Variable(Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF8, 2, sizes.data(), content.data(), 0));
}

/// Members go into the struct, which owns them then.
class Struct {
 public:
  explicit Struct(const std::string& name) {
    std::array<std::size_t, 2> sizes{1, 1};
    variable_.reset(Mat_VarCreateStruct(name.empty() ? nullptr : name.c_str(), 2, sizes.data(), nullptr, 0));
  }

  void add(const std::string& name, Variable member) {
    if (!variable_ || !member || Mat_VarAddStructField(variable_.get(), name.c_str()) != 0) {
      sound_ = false;
      return;
    }
    Mat_VarSetStructFieldByName(variable_.get(), name.c_str(), 0, member.release());
  }

  [[nodiscard]] bool sound() const { return sound_ && variable_ != nullptr; }
  Variable take() && { return std::move(variable_); }
  [[nodiscard]] matvar_t* get() const { return variable_.get(); }

 private:
  Variable variable_;
  bool sound_ = true;
};

bool write(mat_t* file, const Struct& content) {
  return content.sound() && Mat_VarWrite(file, content.get(), MAT_COMPRESSION_ZLIB) == 0;
}

/// Whether the elements of a MATLAB v5 file fill it: each begins with its type and its size. matio does not tell when a
/// disk is full.
bool is_whole(const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  const auto size = static_cast<std::uint64_t>(std::filesystem::file_size(name));
  std::uint64_t at = 128;
  while (at < size) {
    std::array<char, 8> tag{};
    std::uint32_t bytes = 0;
    if (!file.seekg(static_cast<std::streamoff>(at)) || !file.read(tag.data(), tag.size())) return false;
    std::memcpy(&bytes, tag.data() + 4, sizeof bytes);
    at += tag.size() + bytes;
  }
  return at == size;
}

}  // namespace

Check export_mat(const LogContent& content, const std::filesystem::path& file) {
  if (auto error = refuse_empty(content, file)) return error;
  return report::replace_file(file, [&content](const std::string& temporary) {
    std::unique_ptr<mat_t, CloseFile> mat(Mat_CreateVer(temporary.c_str(), nullptr, MAT_FT_MAT5));
    if (!mat) return false;
    bool done = true;
    const std::vector<std::string> names = names_of(content.tables);
    for (std::size_t one = 0; one < content.tables.size(); ++one) {
      const ExportColumns table(content.tables[one], content.start_unix_ns);
      Struct topic(names[one]);
      Struct units(""), codes(""), channel("");
      bool has_codes = false;
      for (std::size_t i = 0; i < table.columns.size(); ++i) {
        topic.add(table.columns[i].name, column_vector({table.values[i].begin(), table.values[i].end()}));
        units.add(table.columns[i].name, text(table.columns[i].unit));
        if (table.codes[i].words.empty()) continue;
        has_codes = true;
        codes.add(table.columns[i].name, text(text_of(table.codes[i])));
      }
      done = done && units.sound() && codes.sound();
      topic.add("units", std::move(units).take());
      if (has_codes) topic.add("codes", std::move(codes).take());
      const auto about = about_channel(content.tables[one]);
      for (const auto& [key, value] : about) channel.add(key, text(value));
      done = done && channel.sound();
      if (!about.empty()) topic.add("channel", std::move(channel).take());
      if (const auto condition = condition_of(content.summary, content.tables[one].topic)) {
        Struct which("");
        Identifiers keys("key_", {"label"});
        which.add("label", text(condition->label));
        for (const auto& [key, value] : condition->set) which.add(keys.unique(key), text(value));
        done = done && which.sound();
        topic.add("condition", std::move(which).take());
      }
      done = done && write(mat.get(), topic);
    }
    if (const auto run = about(content.summary); !run.empty()) {
      Struct about_run("about");
      for (const auto& [key, value] : run) about_run.add(key, text(value));
      done = done && write(mat.get(), about_run);
    }
    mat.reset();
    return done && is_whole(temporary);
  });
}

}  // namespace tactus::telemetry
