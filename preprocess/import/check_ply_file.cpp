#include "preprocess/import/check_ply_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "preprocess/import/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxHeaderBytes = 1u << 16;
constexpr std::size_t kMaxLineBytes = 4000;    // VTK's reader has 4096 for a line
constexpr std::uint64_t kMaxListLength = 255;  // and a byte for the corners of a face
constexpr std::int64_t kMaxElements = std::int64_t{1} << 31;

/// "property TYPE NAME" or "property list COUNT_TYPE TYPE NAME"; sizes in bytes.
struct Property {
  std::string name;
  std::size_t count_bytes = 0;  ///< 0: no list
  std::size_t bytes = 0;
  bool is_float = false;
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  [[nodiscard]] const Property* find(std::string_view property) const {
    for (const Property& p : properties) {
      if (p.name == property) return &p;
    }
    return nullptr;
  }
};
struct PlyHeader {
  std::string format;
  std::vector<Element> elements;
  std::size_t bytes = 0;  ///< "end_header" and its line end included
};

struct ScalarType {
  std::size_t bytes;
  bool is_float;
};

const ScalarType* scalar_type(std::string_view name) {
  static const std::map<std::string, ScalarType, std::less<>> kTypes{
      {"char", {1, false}},  {"int8", {1, false}},   {"uchar", {1, false}},  {"uint8", {1, false}},
      {"short", {2, false}}, {"int16", {2, false}},  {"ushort", {2, false}}, {"uint16", {2, false}},
      {"int", {4, false}},   {"int32", {4, false}},  {"uint", {4, false}},   {"uint32", {4, false}},
      {"float", {4, true}},  {"float32", {4, true}}, {"double", {8, true}},  {"float64", {8, true}}};
  const auto found = kTypes.find(name);
  return found == kTypes.end() ? nullptr : &found->second;
}

std::optional<Property> parse_property(const std::vector<std::string_view>& words) {
  const bool list = words.size() == 5 && words[1] == "list";
  if (!list && words.size() != 3) return std::nullopt;
  const ScalarType* const type = scalar_type(words[list ? 3 : 1]);
  const ScalarType* const count = list ? scalar_type(words[2]) : nullptr;
  if (type == nullptr || (list && (count == nullptr || count->is_float))) return std::nullopt;
  return Property{std::string(words.back()), list ? count->bytes : 0, type->bytes, type->is_float};
}

/// Nothing where a line is none that PLY has.
std::optional<PlyHeader> parse_header(std::string_view text) {
  PlyHeader header;
  for (std::size_t number = 1, start = 0; start < text.size(); ++number) {
    const std::size_t end = text.find('\n', start);
    if (end == std::string_view::npos || end - start > kMaxLineBytes) return std::nullopt;
    const std::vector<std::string_view> words = split_blanks(trimmed(text.substr(start, end - start)));
    start = end + 1;
    if (number == 1 && (words.size() != 1 || words[0] != "ply")) return std::nullopt;
    if (number == 1 || (!words.empty() && (words[0] == "comment" || words[0] == "obj_info"))) continue;
    if (words.size() == 1 && words[0] == "end_header") {
      header.bytes = start;
      return header;
    }
    if (words.size() == 3 && words[0] == "format") {
      header.format = std::string(words[1]);
    } else if (words.size() == 3 && words[0] == "element") {
      const auto count = parse_integer(words[2]);
      if (!count || *count < 0 || *count > kMaxElements) return std::nullopt;
      header.elements.push_back({std::string(words[1]), static_cast<std::uint64_t>(*count), {}});
    } else if (!words.empty() && words[0] == "property" && !header.elements.empty()) {
      auto property = parse_property(words);
      if (!property) return std::nullopt;
      header.elements.back().properties.push_back(std::move(*property));
    } else {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

/// VTK takes for granted that vertices have x, y and z, and faces a list of corners.
bool has_what_vtk_needs(const PlyHeader& header) {
  bool vertices = false, faces = false;
  for (const Element& element : header.elements) {
    if (element.name == "vertex") {
      vertices = true;
      for (const char* axis : {"x", "y", "z"}) {
        const Property* const p = element.find(axis);
        if (p == nullptr || p->count_bytes != 0) return false;
      }
    }
    if (element.name == "face") {
      faces = true;
      const Property* const corners = element.find("vertex_indices");
      if (corners == nullptr || corners->count_bytes == 0 || corners->is_float) return false;
    }
  }
  return vertices && faces;
}

/// Walks the elements behind the header; each reader returns whether the element is all there.
class BodyWalker {
 public:
  BodyWalker(const fs::path& path, const PlyHeader& header)
      : header_(header), file_(path, std::ios::binary), big_endian_(header.format == "binary_big_endian") {
    file_.seekg(static_cast<std::streamoff>(header.bytes));
  }

  bool walk() {
    const bool text = header_.format == "ascii";
    for (const Element& element : header_.elements) {
      if (!text && element.properties.empty()) continue;  // takes no bytes, however many there are
      for (std::uint64_t n = 0; n < element.count; ++n) {
        if (!(text ? read_line(element) : read_binary(element))) return false;
      }
    }
    return true;
  }

 private:
  bool read_line(const Element& element) {
    if (!std::getline(file_, line_) || line_.size() > kMaxLineBytes) return false;
    const std::vector<std::string_view> words = split_blanks(trimmed(line_));
    std::size_t needed = 0;
    for (const Property& property : element.properties) {
      ++needed;
      if (property.count_bytes == 0) continue;
      const auto length = needed <= words.size() ? parse_integer(words[needed - 1]) : std::nullopt;
      if (!length || *length < 0 || *length > static_cast<std::int64_t>(kMaxListLength)) return false;
      needed += static_cast<std::size_t>(*length);
    }
    return words.size() >= needed;
  }

  bool read_binary(const Element& element) {
    for (const Property& property : element.properties) {
      std::uint64_t items = 1;
      if (property.count_bytes != 0) {
        std::array<char, 8> bytes{};
        if (!file_.read(bytes.data(), static_cast<std::streamsize>(property.count_bytes))) return false;
        if (big_endian_)
          std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(property.count_bytes));
        std::memcpy(&items, bytes.data(), sizeof(items));
        if (items > kMaxListLength) return false;
      }
      const auto skip = static_cast<std::streamsize>(items * property.bytes);
      if (file_.ignore(skip).gcount() != skip) return false;
    }
    return true;
  }

  const PlyHeader& header_;
  std::ifstream file_;
  std::string line_;
  bool big_endian_;
};

}  // namespace

Result<void> check_ply_file(const fs::path& path) {
  std::string text(kMaxHeaderBytes, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  const std::optional<PlyHeader> header = parse_header(text);
  const bool known = header && (header->format == "ascii" || header->format == "binary_little_endian" ||
                                header->format == "binary_big_endian");
  if (!known || !has_what_vtk_needs(*header)) {
    return fail(
        ErrorCode::kFailed,
        fmt::format("{}: is no PLY file of vertices (x, y, z) and faces (vertex_indices)", path.string()));
  }
  if (!BodyWalker(path, *header).walk()) {
    return fail(ErrorCode::kFailed,
                fmt::format("{}: is truncated or damaged: not all of its elements are there", path.string()));
  }
  return {};
}

}  // namespace splatlas
