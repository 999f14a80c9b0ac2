// SPDX-License-Identifier: Apache-2.0
#include "markup.hpp"

#include <cctype>
#include <cstdlib>
#include <set>

namespace tactus::report {
namespace {

bool is_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == ':'; }

std::string fault_of_references(std::string_view text) {
  for (std::size_t at = text.find('&'); at != std::string_view::npos; at = text.find('&', at + 1)) {
    const std::string_view rest = text.substr(at);
    const bool known = rest.starts_with("&amp;") || rest.starts_with("&lt;") || rest.starts_with("&gt;") ||
                       rest.starts_with("&quot;") || rest.starts_with("&#39;");
    if (!known) return "bare & at '" + std::string(rest.substr(0, 20)) + "'";
  }
  return "";
}

}  // namespace

std::string fault_of(std::string_view document) {
  if (document.starts_with("<!DOCTYPE html>")) document.remove_prefix(15);
  std::vector<std::string> open;
  bool any = false;
  while (!document.empty()) {
    const std::size_t start = document.find('<');
    if (std::string fault = fault_of_references(document.substr(0, start)); !fault.empty()) return fault;
    if (start == std::string_view::npos) break;
    document.remove_prefix(start + 1);
    const bool closing = document.starts_with("/");
    if (closing) document.remove_prefix(1);
    std::size_t i = 0;
    while (i < document.size() && is_name(document[i])) ++i;
    const std::string name(document.substr(0, i));
    if (name.empty()) return "a '<' that starts no tag";
    std::set<std::string> seen;
    while (i < document.size() && document[i] != '>' && document[i] != '/') {
      if (document[i] == ' ' || document[i] == '\n') {
        ++i;
        continue;
      }
      const std::size_t key = i;
      while (i < document.size() && is_name(document[i])) ++i;
      const std::string attribute_name(document.substr(key, i - key));
      if (attribute_name.empty() || document.substr(i, 2) != "=\"") return "bad attribute in <" + name + ">";
      if (!seen.insert(attribute_name).second) return "attribute twice in <" + name + ">";
      const std::size_t end = document.find('"', i + 2);
      if (end == std::string_view::npos) return "open quote in <" + name + ">";
      const std::string_view value = document.substr(i + 2, end - i - 2);
      if (value.find('<') != std::string_view::npos) return "'<' in an attribute of <" + name + ">";
      if (std::string fault = fault_of_references(value); !fault.empty()) return fault;
      i = end + 1;
    }
    const bool empty = document.substr(i).starts_with("/>");
    if (!empty && !document.substr(i).starts_with(">")) return "unfinished <" + name + ">";
    document.remove_prefix(i + (empty ? 2 : 1));
    if (closing) {
      if (open.empty() || open.back() != name) return "</" + name + "> closes nothing";
      open.pop_back();
    } else if (!empty) {
      if (open.empty() && any) return "a second root <" + name + ">";
      open.push_back(name);
    }
    any = true;
  }
  return open.empty() ? (any ? "" : "no element") : "<" + open.back() + "> is never closed";
}

std::vector<std::string> tags(std::string_view document, std::string_view name, std::string_view with) {
  std::vector<std::string> found;
  std::string opening("<");
  opening.append(name);
  for (std::size_t at = document.find(opening); at != std::string_view::npos; at = document.find(opening, at + 1)) {
    const std::string_view tag = document.substr(at, document.find('>', at) - at);
    const bool whole_name = tag.size() == opening.size() || !is_name(tag[opening.size()]);
    if (whole_name && tag.find(with) != std::string_view::npos) found.emplace_back(tag);
  }
  return found;
}

std::string attribute(std::string_view tag, std::string_view name) {
  std::string key(" ");
  key.append(name).append("=\"");
  const std::size_t at = tag.find(key);
  if (at == std::string_view::npos) return "";
  const std::size_t begin = at + key.size();
  return std::string(tag.substr(begin, tag.find('"', begin) - begin));
}

std::vector<std::string> texts(std::string_view document, std::string_view style) {
  std::vector<std::string> found;
  std::string opening("<text class=\"");
  opening.append(style).append("\"");
  for (std::size_t at = document.find(opening); at != std::string_view::npos; at = document.find(opening, at + 1)) {
    const std::size_t begin = document.find('>', at) + 1;
    found.emplace_back(document.substr(begin, document.find('<', begin) - begin));
  }
  return found;
}

std::vector<std::vector<Position>> strokes(const std::string& data) {
  std::vector<std::vector<Position>> found;
  const char* at = data.c_str();
  bool relative = false;
  const auto read = [&] {
    char* end = nullptr;
    const double value = std::strtod(at, &end);
    at = end == at ? at + 1 : end;
    return value;
  };
  while (*at != '\0') {
    if (*at == 'M' || *at == 'l') {
      relative = *at++ == 'l';
      if (!relative) found.emplace_back();
      continue;
    }
    if (found.empty()) return found;
    const double x = read();
    const double y = read();
    const Position from = relative ? found.back().back() : Position{0.0, 0.0};
    found.back().push_back({from.x + x, from.y + y});
  }
  return found;
}

}  // namespace tactus::report
