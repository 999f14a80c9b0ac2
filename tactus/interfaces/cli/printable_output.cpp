// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/printable_output.hpp>

namespace tactus::cli {

std::string printable_lines(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t end = text.find_first_of("\n\t");
    shown += report::printable(text.substr(0, end));
    if (end == std::string_view::npos) break;
    shown += text[end];
    text.remove_prefix(end + 1);
  }
  return shown;
}

PrintableOutput::PrintableOutput(std::ostream& stream, std::optional<Painter> painter)
    : stream_(stream), target_(stream.rdbuf(this)), painter_(std::move(painter)) {}

PrintableOutput::~PrintableOutput() {
  pass_on(waiting_.size());
  const std::ios::iostate state = stream_.rdstate();
  stream_.rdbuf(target_);
  stream_.clear(state);
}

std::streamsize PrintableOutput::xsputn(const char* text, std::streamsize size) {
  return take({text, static_cast<std::size_t>(size)}) ? size : 0;
}

PrintableOutput::int_type PrintableOutput::overflow(int_type character) {
  if (traits_type::eq_int_type(character, traits_type::eof())) return traits_type::not_eof(character);
  const char byte = traits_type::to_char_type(character);
  return take({&byte, 1}) ? character : traits_type::eof();
}

int PrintableOutput::sync() {
  const std::scoped_lock lock(mutex_);
  return pass_on(waiting_.size()) ? target_->pubsync() : -1;
}

bool PrintableOutput::take(std::string_view text) {
  const std::scoped_lock lock(mutex_);
  waiting_ += text;
  return pass_on(waiting_.rfind('\n') + 1);  // nothing where there is no line feed
}

std::string PrintableOutput::painted(std::string_view lines) {
  std::string all;
  while (!lines.empty()) {
    const std::size_t end = lines.find('\n');
    if (end == std::string_view::npos) return all + std::string(lines);
    all += painter_->paint(lines.substr(0, end)) + "\n";
    lines.remove_prefix(end + 1);
  }
  return all;
}

bool PrintableOutput::pass_on(std::size_t size) {
  if (size == 0) return true;
  std::string shown = printable_lines(std::string_view(waiting_).substr(0, size));
  if (painter_) shown = painted(shown);
  waiting_.erase(0, size);
  return target_->sputn(shown.data(), static_cast<std::streamsize>(shown.size())) ==
         static_cast<std::streamsize>(shown.size());
}

}  // namespace tactus::cli
