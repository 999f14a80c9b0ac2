// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cstddef>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

/// A stored result of another program: `tests/oracles/NAME.csv`, made by `tests/oracles/NAME.py`.
///
/// The file has one comment line that tells its origin, one line of column names, then numbers. A file or column that
/// is missing ends the test with an exception: an oracle that is not there is a failure and never a skip.
class OracleTable {
 public:
  explicit OracleTable(const std::string& name) : name_(name) {
    std::ifstream file(std::string(TACTUS_ORACLE_FOLDER) + "/" + name + ".csv");
    std::string line;
    if (!std::getline(file, line) || !line.starts_with("#") || !std::getline(file, line)) {
      throw std::runtime_error(name + ".csv is missing or has no header");
    }
    header_ = split(line);
    while (std::getline(file, line)) {
      rows_.push_back(split(line));
      if (rows_.back().size() != header_.size()) throw std::runtime_error(name + ".csv has an uneven row");
    }
    if (rows_.empty()) throw std::runtime_error(name + ".csv has no rows");
  }

  template <class Number = double>
  std::vector<Number> column(std::string_view name) const {
    for (std::size_t i = 0; i < header_.size(); ++i) {
      if (header_[i] != name) continue;
      std::vector<Number> numbers;
      for (const auto& row : rows_) {
        Number number{};
        const char* const end = row[i].data() + row[i].size();
        if (std::from_chars(row[i].data(), end, number).ptr != end) {
          throw std::runtime_error(name_ + ".csv: '" + row[i] + "' is not a number");
        }
        numbers.push_back(number);
      }
      return numbers;
    }
    throw std::runtime_error(name_ + ".csv has no column " + std::string(name));
  }

 private:
  static std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    return cells;
  }

  std::string name_;
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
};
