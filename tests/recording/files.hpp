// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/recording/recording.hpp>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>
#include <matio.h>

namespace tactus::recording {

/// A folder for the files of one test, gone when it ends.
class RecordingFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = scratch_path();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path path(std::string_view name) const { return folder_ / name; }

  [[nodiscard]] std::filesystem::path write(std::string_view name, std::string_view content) const {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }

  static std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream content;
    content << stream.rdbuf();
    return content.str();
  }

 private:
  std::filesystem::path folder_;
};

/// What `read` says about a source that it must refuse.
inline std::string refusal(const Source& source) {
  const Result<Signal> result = read(source);
  return result ? "was read" : describe(result.error());
}

inline bool says(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

/// A MATLAB variable of one class, its values column by column. matio copies the values.
template <class Number>
matvar_t* matrix(const char* name, matio_classes kind, matio_types type, std::size_t rows, std::size_t columns,
                 std::vector<Number> values) {
  std::size_t dimensions[] = {rows, columns};
  return Mat_VarCreate(name, kind, type, 2, dimensions, values.data(), 0);
}
inline matvar_t* matrix(const char* name, std::size_t rows, std::size_t columns, std::vector<double> values) {
  return matrix(name, MAT_C_DOUBLE, MAT_T_DOUBLE, rows, columns, std::move(values));
}

/// Writes a MATLAB file of version 5 from `variables`, which it takes over.
inline std::filesystem::path write_mat(const std::filesystem::path& file, const std::vector<matvar_t*>& variables,
                                       matio_compression compression) {
  mat_t* mat = Mat_CreateVer(file.c_str(), nullptr, MAT_FT_MAT5);
  for (matvar_t* variable : variables) {
    EXPECT_EQ(Mat_VarWrite(mat, variable, compression), 0);
    Mat_VarFree(variable);
  }
  Mat_Close(mat);
  return file;
}

/// A struct as a Simulink scope writes it: `name.time` of `samples` times, 0.0005 s apart, and three `name.signals`,
/// the k-th (from 1) with a label and `values` of two columns: 100 k + i and -(100 k + i) at sample i (from 0).
inline matvar_t* scope(const char* name, std::size_t samples) {
  std::vector<double> time;
  for (std::size_t i = 0; i < samples; ++i) time.push_back(0.0005 * static_cast<double>(i));
  std::size_t one[] = {1, 1};
  std::size_t three[] = {1, 3};
  const char* outer_fields[] = {"time", "signals"};
  const char* inner_fields[] = {"values", "label"};
  matvar_t* outer = Mat_VarCreateStruct(name, 2, one, outer_fields, 2);
  matvar_t* inner = Mat_VarCreateStruct("signals", 2, three, inner_fields, 2);
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<double> values(2 * samples);
    for (std::size_t i = 0; i < samples; ++i) {
      values[i] = 100.0 * static_cast<double>(k + 1) + static_cast<double>(i);
      values[samples + i] = -values[i];
    }
    std::string label = "signal";
    std::size_t length[] = {1, label.size()};
    Mat_VarSetStructFieldByName(inner, "values", k, matrix("values", samples, 2, values));
    Mat_VarSetStructFieldByName(inner, "label", k,
                                Mat_VarCreate("label", MAT_C_CHAR, MAT_T_UTF8, 2, length, label.data(), 0));
  }
  Mat_VarSetStructFieldByName(outer, "time", 0, matrix("time", samples, 1, time));
  Mat_VarSetStructFieldByName(outer, "signals", 0, inner);
  return outer;
}

}  // namespace tactus::recording
