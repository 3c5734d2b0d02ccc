#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "preprocess/import/import_error.h"
#include "preprocess/import/meshes/polygon_readers.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

constexpr std::int64_t kMaxElements = std::int64_t{1} << 31;
constexpr double kMaxListLength = 255;

/// Number type of the file, in the machine's byte order.
struct ScalarType {
  std::size_t bytes = 0;
  bool is_integer = true;
  double (*value)(const char* bytes) = nullptr;
};

/// "property TYPE NAME" or "property list COUNT_TYPE TYPE NAME".
struct Property {
  std::string name;
  ScalarType type;
  std::optional<ScalarType> count;  ///< of a list's items
};
struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;

  [[nodiscard]] std::optional<std::size_t> find(std::string_view property, bool list) const {
    for (std::size_t n = 0; n < properties.size(); ++n) {
      if (properties[n].name == property && properties[n].count.has_value() == list) return n;
    }
    return std::nullopt;
  }
  /// The corners of a face. Files use both names.
  [[nodiscard]] std::optional<std::size_t> find_corners() const {
    const auto corners = find("vertex_indices", true);
    return corners ? corners : find("vertex_index", true);
  }
};

template <typename T>
ScalarType scalar_type_of() {
  return {sizeof(T), std::is_integral_v<T>, [](const char* bytes) {
            T value;
            std::memcpy(&value, bytes, sizeof(T));
            return static_cast<double>(value);
          }};
}

std::optional<ScalarType> scalar_type(std::string_view name) {
  if (name == "char" || name == "int8") return scalar_type_of<std::int8_t>();
  if (name == "uchar" || name == "uint8") return scalar_type_of<std::uint8_t>();
  if (name == "short" || name == "int16") return scalar_type_of<std::int16_t>();
  if (name == "ushort" || name == "uint16") return scalar_type_of<std::uint16_t>();
  if (name == "int" || name == "int32") return scalar_type_of<std::int32_t>();
  if (name == "uint" || name == "uint32") return scalar_type_of<std::uint32_t>();
  if (name == "float" || name == "float32") return scalar_type_of<float>();
  if (name == "double" || name == "float64") return scalar_type_of<double>();
  return std::nullopt;
}

std::optional<Property> parse_property(const std::vector<std::string_view>& words) {
  const bool list = words.size() == 5 && words[1] == "list";
  if (!list && words.size() != 3) return std::nullopt;
  const auto type = scalar_type(words[list ? 3 : 1]);
  const auto count = list ? scalar_type(words[2]) : std::nullopt;
  if (!type || (list && !(count && count->is_integer))) return std::nullopt;
  return Property{std::string(words.back()), *type, count};
}

/// Reads header and body in one pass; each function returns false for a damaged or truncated file.
class PlyReader {
 public:
  explicit PlyReader(const std::filesystem::path& path) : file_(path, std::ios::binary) {}

  bool read_header() {
    if (!read_line() || words_.size() != 1 || words_[0] != "ply") return false;
    while (read_line()) {
      if (words_.empty()) return false;
      if (words_[0] == "end_header") return is_mesh();
      if (words_[0] != "comment" && words_[0] != "obj_info" && !add_header_line()) return false;
    }
    return false;
  }

  bool read_body() {
    for (const Element& element : elements_) {
      if (!is_text_ && element.properties.empty()) continue;  // no bytes, whatever the count
      values_.resize(element.properties.size());
      for (std::int64_t n = 0; n < element.count; ++n) {
        if (!read_element(element)) return false;
        if (element.name == "vertex") add_vertex(element);
        if (element.name == "face" && !add_face(element)) return false;
      }
    }
    return true;
  }

  [[nodiscard]] vtkSmartPointer<vtkPolyData> poly_data() const { return mesh_.poly_data(); }

 private:
  bool read_line() {
    if (!std::getline(file_, line_)) return false;
    words_ = split_blanks(trimmed(line_));
    next_word_ = 0;
    return true;
  }

  bool add_header_line() {
    if (words_.size() == 3 && words_[0] == "format") {
      is_text_ = words_[1] == "ascii";
      is_big_endian_ = words_[1] == "binary_big_endian";
      has_format_ = is_text_ || is_big_endian_ || words_[1] == "binary_little_endian";
      return has_format_;
    }
    if (words_.size() == 3 && words_[0] == "element") {
      const auto count = parse_integer(words_[2]);
      if (count) elements_.push_back({std::string(words_[1]), *count, {}});
      return count && *count >= 0 && *count <= kMaxElements;
    }
    const auto property = words_[0] == "property" ? parse_property(words_) : std::nullopt;
    if (!property || elements_.empty()) return false;
    elements_.back().properties.push_back(*property);
    return true;
  }

  /// One element of vertices with x, y and z, before faces with a list of corners.
  bool is_mesh() {
    bool vertices = false, faces = false;
    for (const Element& element : elements_) {
      if (element.name == "vertex") {
        for (const char* axis : {"x", "y", "z"}) {
          if (vertices || !element.find(axis, false)) return false;
        }
        vertices = true;
        vertex_count_ = static_cast<double>(element.count);
      }
      if (element.name == "face") {
        const auto corners = element.find_corners();
        if (!vertices || !corners || !element.properties[*corners].type.is_integer) return false;
        faces = true;
      }
    }
    return has_format_ && faces;
  }

  bool read_element(const Element& element) {
    if (is_text_ && !read_line()) return false;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const Property& property = element.properties[p];
      std::optional<double> length = 1;
      if (property.count) length = read_number(*property.count);
      if (!length || !(*length >= 0 && *length <= kMaxListLength)) return false;
      values_[p].resize(static_cast<std::size_t>(*length));
      for (double& value : values_[p]) {
        const auto number = read_number(property.type);
        if (!number) return false;
        value = *number;
      }
    }
    return true;
  }

  std::optional<double> read_number(const ScalarType& type) {
    if (is_text_) {
      const auto number = next_word_ < words_.size() ? parse_number(words_[next_word_++]) : std::nullopt;
      const bool fits = number && (!type.is_integer || std::floor(*number) == *number);
      return fits ? number : std::nullopt;
    }
    std::array<char, 8> bytes{};
    const auto end = bytes.begin() + static_cast<std::ptrdiff_t>(type.bytes);
    if (!file_.read(bytes.data(), static_cast<std::streamsize>(type.bytes))) return std::nullopt;
    if (is_big_endian_) std::reverse(bytes.begin(), end);
    return type.value(bytes.data());
  }

  std::array<double, 3> vector_of(const Element& element, const std::array<const char*, 3>& names) const {
    std::array<double, 3> numbers{};
    for (std::size_t n = 0; n < 3; ++n) numbers[n] = values_[*element.find(names[n], false)][0];
    return numbers;
  }
  void add_vertex(const Element& element) {
    mesh_.points->InsertNextPoint(vector_of(element, {"x", "y", "z"}).data());
    if (element.find("nx", false) && element.find("ny", false) && element.find("nz", false))
      mesh_.normals->InsertNextTuple(vector_of(element, {"nx", "ny", "nz"}).data());
  }
  bool add_face(const Element& element) {
    corners_.clear();
    for (const double corner : values_[*element.find_corners()]) {
      if (!(corner >= 0 && corner < vertex_count_)) return false;
      corners_.push_back(static_cast<vtkIdType>(corner));
    }
    mesh_.add_polygon(corners_);
    return true;
  }

  std::ifstream file_;
  std::string line_;
  std::vector<std::string_view> words_;  // of line_
  std::size_t next_word_ = 0;
  bool has_format_ = false, is_text_ = false, is_big_endian_ = false;
  std::vector<Element> elements_;
  std::vector<std::vector<double>> values_;  // of the present element, per property
  double vertex_count_ = 0;
  std::vector<vtkIdType> corners_;
  PolygonMesh mesh_;
};

}  // namespace

Result<vtkSmartPointer<vtkPolyData>> read_ply(const std::filesystem::path& path) {
  PlyReader reader(path);
  if (!reader.read_header()) {
    return bad_file(path, "is no PLY file of vertices (x, y, z) and faces (vertex_indices or vertex_index)");
  }
  if (!reader.read_body()) {
    return bad_file(path, "is truncated or damaged: not all of its elements or corners are there");
  }
  return reader.poly_data();
}

}  // namespace splatlas
