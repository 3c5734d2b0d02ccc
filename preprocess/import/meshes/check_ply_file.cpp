#include "preprocess/import/meshes/check_ply_file.h"

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

#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxHeaderBytes = 1u << 16;
constexpr std::size_t kMaxLineBytes = 4000;    // VTK's reader has 4096 for a line
constexpr std::uint64_t kMaxListLength = 255;  // and a byte for the corners of a face
constexpr std::int64_t kMaxElements = std::int64_t{1} << 31;
constexpr std::string_view kVertex = "vertex", kFace = "face", kCorners = "vertex_indices";

struct ScalarType {
  std::size_t bytes = 0;  ///< 0: none
  enum class Kind : std::uint8_t { kSigned, kUnsigned, kFloat } kind = Kind::kSigned;
};

/// "property TYPE NAME" or "property list COUNT_TYPE TYPE NAME"; sizes in bytes.
struct Property {
  std::string name;
  ScalarType count;  ///< of a list's items; none where it is no list
  ScalarType type;

  [[nodiscard]] bool is_list() const { return count.bytes != 0; }
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

const ScalarType* scalar_type(std::string_view name) {
  constexpr auto kSigned = ScalarType::Kind::kSigned, kUnsigned = ScalarType::Kind::kUnsigned,
                 kFloat = ScalarType::Kind::kFloat;
  static const std::map<std::string, ScalarType, std::less<>> kTypes{
      {"char", {1, kSigned}},     {"int8", {1, kSigned}},     {"uchar", {1, kUnsigned}},
      {"uint8", {1, kUnsigned}},  {"short", {2, kSigned}},    {"int16", {2, kSigned}},
      {"ushort", {2, kUnsigned}}, {"uint16", {2, kUnsigned}}, {"int", {4, kSigned}},
      {"int32", {4, kSigned}},    {"uint", {4, kUnsigned}},   {"uint32", {4, kUnsigned}},
      {"float", {4, kFloat}},     {"float32", {4, kFloat}},   {"double", {8, kFloat}},
      {"float64", {8, kFloat}}};
  const auto found = kTypes.find(name);
  return found == kTypes.end() ? nullptr : &found->second;
}

std::optional<Property> parse_property(const std::vector<std::string_view>& words) {
  const bool list = words.size() == 5 && words[1] == "list";
  if (!list && words.size() != 3) return std::nullopt;
  const ScalarType* const type = scalar_type(words[list ? 3 : 1]);
  const ScalarType* const count = list ? scalar_type(words[2]) : nullptr;
  if (type == nullptr || (list && (count == nullptr || count->kind == ScalarType::Kind::kFloat)))
    return std::nullopt;
  return Property{std::string(words.back()), list ? *count : ScalarType{}, *type};
}

/// Without characters that VTK takes for something else than we do: a zero ends its lines.
bool is_plain(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  return std::ranges::none_of(line, [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t'; });
}

/// Nothing where a line is none that PLY has.
std::optional<PlyHeader> parse_header(std::string_view text) {
  PlyHeader header;
  for (std::size_t number = 1, start = 0; start < text.size(); ++number) {
    const std::size_t end = text.find('\n', start);
    if (end == std::string_view::npos || end - start > kMaxLineBytes) return std::nullopt;
    const std::string_view line = text.substr(start, end - start);
    if (!is_plain(line)) return std::nullopt;
    const std::vector<std::string_view> words = split_blanks(trimmed(line));
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

/// VTK takes for granted that vertices have x, y and z, that faces have a list of corners, and that vertices
/// come first.
bool has_what_vtk_needs(const PlyHeader& header) {
  bool vertices = false, faces = false;
  for (const Element& element : header.elements) {
    if (element.name == kVertex) {
      if (vertices) return false;
      vertices = true;
      for (const char* axis : {"x", "y", "z"}) {
        const Property* const p = element.find(axis);
        if (p == nullptr || p->is_list()) return false;
      }
    }
    if (element.name == kFace) {
      if (!vertices) return false;
      faces = true;
      const Property* const corners = element.find(kCorners);
      if (corners == nullptr || !corners->is_list() || corners->type.kind == ScalarType::Kind::kFloat)
        return false;
    }
  }
  return vertices && faces;
}

/// Walks the elements behind the header; each reader returns whether the element is all there, and its
/// corners are.
class BodyWalker {
 public:
  BodyWalker(const fs::path& path, const PlyHeader& header)
      : header_(header), file_(path, std::ios::binary), big_endian_(header.format == "binary_big_endian") {
    file_.seekg(static_cast<std::streamoff>(header.bytes));
  }

  bool walk() {
    const bool text = header_.format == "ascii";
    for (const Element& element : header_.elements) {
      if (element.name == kVertex) vertices_ = element.count;
      if (!text && element.properties.empty()) continue;  // takes no bytes, however many there are
      for (std::uint64_t n = 0; n < element.count; ++n) {
        if (!(text ? read_line(element) : read_binary(element))) return false;
      }
    }
    return true;
  }

 private:
  bool read_line(const Element& element) {
    if (!std::getline(file_, line_) || line_.size() > kMaxLineBytes || !is_plain(line_)) return false;
    const std::vector<std::string_view> words = split_blanks(trimmed(line_));
    std::size_t at = 0;
    for (const Property& property : element.properties) {
      std::size_t items = 1;
      if (property.is_list()) {
        const auto length = at < words.size() ? parse_integer(words[at]) : std::nullopt;
        if (!length || *length < 0 || *length > static_cast<std::int64_t>(kMaxListLength)) return false;
        items = static_cast<std::size_t>(*length);
        ++at;
      }
      if (words.size() - at < items) return false;
      for (const std::size_t end = at + items; at < end; ++at) {
        if (!is_corner(element, property)) continue;
        const auto corner = parse_integer(words[at]);
        if (!corner || !vertex_exists(*corner)) return false;
      }
    }
    return true;
  }

  bool read_binary(const Element& element) {
    for (const Property& property : element.properties) {
      std::int64_t items = 1;
      if (property.is_list()) {
        const auto length = read_integer(property.count);
        if (!length || *length < 0 || *length > static_cast<std::int64_t>(kMaxListLength)) return false;
        items = *length;
      }
      if (is_corner(element, property)) {
        for (; items > 0; --items) {
          const auto corner = read_integer(property.type);
          if (!corner || !vertex_exists(*corner)) return false;
        }
      }
      const auto skip = static_cast<std::streamsize>(items * static_cast<std::int64_t>(property.type.bytes));
      if (file_.ignore(skip).gcount() != skip) return false;
    }
    return true;
  }

  /// Of four bytes at most.
  std::optional<std::int64_t> read_integer(const ScalarType& type) {
    std::array<char, 8> bytes{};
    if (!file_.read(bytes.data(), static_cast<std::streamsize>(type.bytes))) return std::nullopt;
    if (big_endian_) std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(type.bytes));
    std::int64_t value = 0;
    std::memcpy(&value, bytes.data(), sizeof(value));
    const std::int64_t limit = std::int64_t{1} << (8 * type.bytes - 1);
    return type.kind == ScalarType::Kind::kSigned && value >= limit ? value - 2 * limit : value;
  }

  static bool is_corner(const Element& element, const Property& property) {
    return element.name == kFace && property.name == kCorners &&
           property.type.kind != ScalarType::Kind::kFloat;
  }
  [[nodiscard]] bool vertex_exists(std::int64_t index) const {
    return index >= 0 && static_cast<std::uint64_t>(index) < vertices_;
  }

  const PlyHeader& header_;
  std::ifstream file_;
  std::string line_;
  std::uint64_t vertices_ = 0;
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
                fmt::format("{}: is truncated or damaged: not all of its elements or corners are there",
                            path.string()));
  }
  return {};
}

}  // namespace splatlas
