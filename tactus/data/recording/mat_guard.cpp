// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/file_bytes.hpp>
#include <tactus/data/recording/limits.hpp>
#include <tactus/data/recording/mat_guard.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <zlib.h>

namespace tactus::recording {
namespace {

using Bytes = std::span<const unsigned char>;

constexpr std::size_t header_size = 128;
constexpr std::size_t tag_size = 8;

/// Types of a data element, by their number in the file.
enum Type : std::uint32_t {
  int8 = 1,
  uint8 = 2,
  uint16 = 4,
  int32 = 5,
  uint32 = 6,
  matrix = 14,
  compressed = 15,
  utf8 = 16,
  utf16 = 17,
  utf32 = 18
};

/// Classes of a matrix, by their number in the file.
enum Class : std::uint32_t {
  cell = 1,
  structure = 2,
  object = 3,
  text = 4,
  sparse = 5,
  first_number = 6,
  last_number = 15,
  function = 16,
  opaque = 17
};

std::size_t padded(std::size_t size) { return (size + 7) / 8 * 8; }

/// Bytes of one number of an element type; 0 for a type that holds no numbers.
std::size_t size_of_number(std::uint32_t type) {
  constexpr std::array<std::size_t, 14> sizes{0, 1, 1, 2, 2, 4, 4, 4, 0, 8, 0, 0, 8, 8};
  return type < sizes.size() ? sizes[type] : 0;
}

struct DataElement {
  std::uint32_t type = 0;
  Bytes content;
  bool packed = false;  ///< content of up to four bytes inside the tag
};

/// Reads elements one after the other out of a run of bytes, never beyond its end. Each read fails as an empty
/// optional.
class Cursor {
 public:
  Cursor(Bytes bytes, bool swapped) : rest_(bytes), swapped_(swapped) {}

  [[nodiscard]] bool at_end() const { return rest_.empty(); }

  std::optional<DataElement> next() {
    if (rest_.size() < tag_size) return std::nullopt;
    const std::uint32_t first = word(rest_, 0);
    if ((first >> 16U) != 0) {
      const std::size_t size = first >> 16U;
      if (size > 4) return std::nullopt;
      const DataElement element{first & 0xffffU, rest_.subspan(4, size), true};
      rest_ = rest_.subspan(tag_size);
      return element;
    }
    const std::size_t size = word(rest_, 1);
    if (size > rest_.size() - tag_size) return std::nullopt;
    const DataElement element{first, rest_.subspan(tag_size, size), false};
    // Compressed elements are not padded.
    const std::size_t step = first == compressed ? size : padded(size);
    rest_ = rest_.subspan(std::min(tag_size + step, rest_.size()));
    return element;
  }

  [[nodiscard]] std::uint32_t word(Bytes bytes, std::size_t index) const {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + 4 * index, sizeof value);
    return swapped_ ? __builtin_bswap32(value) : value;
  }

 private:
  Bytes rest_;
  bool swapped_;
};

/// What is wrong with a variable; empty if nothing is.
struct Fault {
  Fault() = default;
  Fault(const char* text) : what(text) {}  // implicit, so that `return "it is damaged";` reads well
  Fault(std::string text, bool is_too_large) : what(std::move(text)), too_large(is_too_large) {}
  [[nodiscard]] bool empty() const { return what.empty(); }

  std::string what;
  bool too_large = false;  ///< sound, but more than is read
};

/// What all variables share: the order of bytes, and how much the rest of the file may still take.
struct Walk {
  bool swapped;
  std::size_t bytes_left = most_unpacked_bytes;
  std::size_t arrays_left = most_mat_arrays;
};

Fault check_matrix(Bytes content, Walk& walk, int depth, bool top_level);

Fault check_children(Cursor& cursor, std::size_t count, Walk& walk, int depth) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto child = cursor.next();
    if (!child || child->type != matrix || child->packed) return "a member of a struct or cell array is missing";
    if (Fault fault = check_matrix(child->content, walk, depth + 1, false); !fault.empty()) return fault;
  }
  return {};
}

/// Checks the names of the fields and returns how many there are.
std::optional<std::size_t> count_fields(Cursor& cursor) {
  const auto length = cursor.next();
  const auto names = cursor.next();
  if (!length || !length->packed || length->type != int32 || length->content.size() != 4) return std::nullopt;
  if (!names || names->type != int8) return std::nullopt;
  const std::size_t size = cursor.word(length->content, 0);
  if (size == 0 || size > longest_mat_name || names->content.size() % size != 0) return std::nullopt;
  for (std::size_t start = 0; start < names->content.size(); start += size) {
    const Bytes name = names->content.subspan(start, size);
    if (std::find(name.begin(), name.end(), 0) == name.end()) return std::nullopt;
  }
  return names->content.size() / size;
}

Fault check_numbers(Cursor& cursor, std::size_t count) {
  const auto numbers = cursor.next();
  const std::size_t size = numbers ? size_of_number(numbers->type) : 0;
  if (size == 0) return "numbers are missing";
  return numbers->content.size() == count * size ? Fault{} : "numbers do not fill their array";
}

Fault check_text(Cursor& cursor) {
  constexpr std::array<std::uint32_t, 6> types_of_text{int8, uint8, uint16, utf8, utf16, utf32};
  const auto characters = cursor.next();
  const bool found =
      characters && std::find(types_of_text.begin(), types_of_text.end(), characters->type) != types_of_text.end();
  return found ? Fault{} : "characters are missing";
}

Fault check_sparse(Cursor& cursor, bool is_complex) {
  const auto rows = cursor.next();
  const auto columns = cursor.next();
  const auto real = cursor.next();
  const auto imaginary = is_complex ? cursor.next() : real;
  const auto is_index = [](const auto& element) {
    return element && (element->type == int32 || element->type == uint32);
  };
  if (!is_index(rows) || !is_index(columns) || !real || !imaginary)
    return "indices or numbers of a sparse array are missing";
  const bool alike = real->type == imaginary->type && real->content.size() == imaginary->content.size();
  return alike && size_of_number(real->type) != 0 ? Fault{} : "numbers of a sparse array are damaged";
}

/// Number of members of an array, none if it is not one that `limit` bytes can describe.
std::optional<std::size_t> count_members(const Cursor& cursor, const DataElement& dimensions, std::size_t limit) {
  const std::size_t rank = dimensions.content.size() / 4;
  if (dimensions.type != int32 || dimensions.packed || dimensions.content.size() % 4 != 0 || rank < 2 || rank > 8) {
    return std::nullopt;
  }
  std::size_t count = 1;
  bool none = false;
  for (std::size_t i = 0; i < rank; ++i) {
    const std::size_t extent = cursor.word(dimensions.content, i);
    if (extent > std::numeric_limits<std::int32_t>::max()) return std::nullopt;
    none = none || extent == 0;
    count = none ? 0 : count * extent;
    if (count > limit) return std::nullopt;
  }
  return count;
}

Fault check_matrix(Bytes content, Walk& walk, int depth, bool top_level) {
  constexpr int deepest = 16;
  constexpr std::uint32_t complex_flag = 0x0800;
  if (walk.arrays_left == 0) {
    return {"with it the file has more than the " + std::to_string(most_mat_arrays) + " arrays and members of structs",
            true};
  }
  --walk.arrays_left;
  if (content.empty() && !top_level) return {};
  if (depth > deepest) return "structs are nested too deep";
  Cursor cursor(content, walk.swapped);
  const auto flags = cursor.next();
  if (!flags || flags->type != uint32 || flags->packed || flags->content.size() != 8) return "array flags are missing";
  const std::uint32_t bits = cursor.word(flags->content, 0);
  const std::uint32_t kind = bits & 0xffU;
  // Of an object of a class nothing is read, but where dimensions would stand matio must not find any.
  if (kind == opaque) {
    const auto name = cursor.next();
    return name && name->type == int8 ? Fault{} : "an object has no name";
  }

  const auto dimensions = cursor.next();
  const auto name = cursor.next();
  if (!dimensions || !name) return "dimensions or name are missing";
  if (name->type != int8 || name->content.size() > longest_mat_name) return "a name is no text, or too long";
  // Members are named by their struct; matio takes it for granted that they have no name of their own.
  if (!top_level && !name->content.empty()) return "a member has a name of its own";
  // A sparse array may have more members than bytes.
  const std::size_t limit = kind == sparse ? std::numeric_limits<std::uint32_t>::max() : content.size();
  const auto count = count_members(cursor, *dimensions, limit);
  if (!count) return "dimensions are impossible";

  if (kind >= first_number && kind <= last_number) {
    Fault fault = check_numbers(cursor, *count);
    return fault.empty() && (bits & complex_flag) != 0 ? check_numbers(cursor, *count) : fault;
  }
  if (kind == cell || kind == function) return check_children(cursor, *count, walk, depth);
  if (kind == structure || kind == object) {
    if (kind == object) {
      const auto class_name = cursor.next();
      if (!class_name || class_name->type != int8) return "the class of an object is missing";
    }
    const auto fields = count_fields(cursor);
    if (!fields) return "names of fields are damaged";
    return check_children(cursor, *fields * *count, walk, depth);
  }
  if (kind == text) return check_text(cursor);
  if (kind == sparse) return check_sparse(cursor, (bits & complex_flag) != 0);
  return "a class is unknown";
}

Fault too_large(std::size_t packed, std::size_t unpacked) {
  return {"its " + std::to_string(packed) + " bytes claim " + std::to_string(unpacked) +
              " unpacked, where all variables together may take " + std::to_string(most_unpacked_bytes >> 20U) + " MiB",
          true};
}

/// Unpacks a zlib stream that holds one data element and nothing else, as far as it may be unpacked.
Fault unpack(Bytes packed, Walk& walk, std::vector<unsigned char>& content) {
  constexpr const char* damaged = "its compressed data are damaged";
  std::vector<unsigned char> chunk(std::size_t{1} << 16U);
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return damaged;
  // zlib takes a pointer to mutable input, which it does not change.
  stream.next_in = const_cast<unsigned char*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  int state = Z_OK;
  Fault fault;
  for (std::size_t most = 0; state == Z_OK && fault.empty();) {
    stream.next_out = chunk.data();
    stream.avail_out = static_cast<uInt>(chunk.size());
    state = inflate(&stream, Z_NO_FLUSH);
    content.insert(content.end(), chunk.data(), stream.next_out);
    // The element says at its beginning how long it is.
    if (most == 0 && content.size() >= tag_size) {
      most = tag_size + padded(Cursor({}, walk.swapped).word(content, 1));
      if (most > walk.bytes_left) fault = too_large(packed.size(), most);
    }
    if (most != 0 && content.size() > most) fault = damaged;
  }
  inflateEnd(&stream);
  if (!fault.empty()) return fault;
  if (state != Z_STREAM_END || stream.avail_in != 0) return damaged;
  walk.bytes_left -= content.size();
  return {};
}

Fault check_variable(const DataElement& element, Walk& walk) {
  if (element.packed) return "it begins with a damaged tag";
  if (element.type == matrix) {
    return check_matrix(element.content, walk, 0, true);
  }
  if (element.type != compressed) return "it is of an unknown type";
  std::vector<unsigned char> content;
  if (Fault fault = unpack(element.content, walk, content); !fault.empty()) return fault;
  Cursor cursor(content, walk.swapped);
  const auto inner = cursor.next();
  if (!inner || inner->packed || inner->type != matrix || !cursor.at_end()) return "its compressed data are incomplete";
  return check_matrix(inner->content, walk, 0, true);
}

Error refused(const std::filesystem::path& file, std::string message, ErrorCode code = ErrorCode::syntax) {
  return {.code = code, .parameter = {}, .message = std::move(message), .place = file.string()};
}

}  // namespace

Result<std::size_t> check_mat_file(const std::filesystem::path& file) {
  const Result<std::string> raw = file_bytes(file, most_mat_bytes);
  if (!raw) return raw.error();
  const Bytes bytes(reinterpret_cast<const unsigned char*>(raw->data()), raw->size());
  const std::string_view head = std::string_view(*raw).substr(0, header_size);
  if (head.starts_with("MATLAB 7.3") || head.starts_with("\x89HDF")) {
    return refused(file, "is a MATLAB 7.3 (HDF5) file, which is not read; save it with '-v7'");
  }
  const std::string_view mark = head.size() == header_size ? head.substr(header_size - 4) : std::string_view{};
  const bool little = mark == std::string_view("\x00\x01IM", 4);
  if (!little && mark != std::string_view("\x01\x00MI", 4)) {
    return refused(file, "is not a MATLAB file of version 5; save it from MATLAB, Octave or SciPy with '-v7'");
  }
  Walk walk{.swapped = little != (std::endian::native == std::endian::little)};
  Cursor cursor(bytes.subspan(header_size), walk.swapped);
  std::size_t variables = 0;
  while (!cursor.at_end()) {
    const auto element = cursor.next();
    ++variables;
    const Fault fault = element ? check_variable(*element, walk) : "the file ends within it";
    const std::string number = std::to_string(variables);
    if (fault.too_large || variables > most_mat_variables) {
      return refused(file,
                     "holds more than is read, at variable " + number + ": " +
                         (fault.too_large ? fault.what : "it is one more than may be in a file") +
                         "; save only the variables that are needed, large ones with '-v6'",
                     ErrorCode::out_of_bounds);
    }
    if (fault.empty()) continue;
    return refused(file, "is damaged in variable " + number + ": " + fault.what + "; copy or save the file again");
  }
  return variables;
}

}  // namespace tactus::recording
