// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/entry.hpp>
#include <tactus/kernel/core/binding.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::configuration {

/// A configuration as a user wrote it: a TOML file, and values that override it.
///
/// A copy is independent, so a sweep copies the document and overrides one value in each copy. Every error carries the
/// place where the value was written: `tapping.toml:12:5`, or `--set control.force_gain=-1`. Cold: it allocates.
class Document {
 public:
  /// Reads a file of at most 1 MiB.
  ///
  /// Errors: `missing` for a file that is not there, empty, too long or unreadable, and for a folder; `syntax` as in
  /// `parse`.
  static Result<Document> load(const std::filesystem::path& file);

  /// Parses TOML 1.0 text, with or without a byte-order mark; `name` stands for the file in errors. Empty text is fine:
  /// every key keeps its default.
  ///
  /// Errors: `syntax`, with line and column, for text that is not TOML, a key that is written twice, more than 16
  /// levels of nested values, a line with more than 100 dots, a key of more than 500 letters with its section, and
  /// text beyond 1 MiB.
  static Result<Document> parse(std::string_view text, std::string name);

  /// Overrides one value: `control.force_gain=3`. The last override of a key wins.
  ///
  /// The right side is read as a TOML value or, if it is not one, as a text, so `control.cancellation=off` needs no
  /// quotes. A text parameter takes what was typed, number or not.
  ///
  /// Errors: `syntax` for an assignment without `=` or with a malformed key, `wrong_type` for a section as value, a
  /// value in the place of a section, and a key below a value. Whether the key exists is known only to `read`.
  Check set(std::string_view assignment);

  /// Takes over every key of `other`, where both have it in place of this document's: what a file that holds part of a
  /// configuration, such as an identified model, states on top of an experiment. Errors found later name the file that
  /// a key came from.
  ///
  /// Errors: `wrong_type` where one has a section and the other a value.
  Check merge(const Document& other);

  /// The whole document as a `T`. Keys that are not written keep the defaults of `T`.
  ///
  /// Errors: the first in document order, overrides last: `unknown_key`, `wrong_type`, or `out_of_bounds`, which
  /// includes what is not finite and a word that a choice does not know.
  template <Described T>
  Result<T> read() const {
    T params{};
    if (Check problem = read(bind(params))) return *std::move(problem);
    return params;
  }

  /// The same for bindings of one or more structs, which together describe the whole document. They may share sections
  /// but no key. After an error some of the values are assigned and some are not.
  Check read(std::span<const Binding> bindings) const;

  /// The keys that hold a value, dotted, in the order written.
  [[nodiscard]] std::vector<std::string> keys() const;

  /// One text, before it is known what the rest of the document describes: `text_at("task.kind")`.
  ///
  /// Errors: `missing`, `wrong_type`.
  [[nodiscard]] Result<std::string> text_at(std::string_view path) const;

  /// The error with its place filled in from its parameter, for checks that are made after reading, such as the `make`
  /// of an element: where the parameter is written; else, where the section that encloses it begins; else the name of
  /// the document. A place that is already there stays.
  [[nodiscard]] Error locate(Error error) const;

  /// The file, or what stands for it.
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  [[nodiscard]] const Entry* find(std::string_view path) const;
  [[nodiscard]] std::string place_of(const Entry& entry, Position position) const;

  std::string name_;
  std::vector<Entry> entries_;  // in the order written, overrides last, a section before its keys
};

}  // namespace tactus::configuration
