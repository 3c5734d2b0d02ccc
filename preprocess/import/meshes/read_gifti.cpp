#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <expat.h>
#include <zlib.h>

#include "format/result_macros.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/meshes/polygon_readers.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// An array of the file (GIFTI 1.0), as its XML says.
struct DataArray {
  std::map<std::string, std::string> attributes;
  std::map<std::string, std::string> metadata;
  std::string data;
  bool is_of_scanner = false;  ///< its points are in the scanner's frame
  std::optional<std::array<double, 16>> to_scanner;

  [[nodiscard]] std::string get(const char* key) const {
    const auto found = attributes.find(key);
    return found == attributes.end() ? std::string() : found->second;
  }
};

/// Collects the arrays of points and triangles.
class GiftiParser {
 public:
  Result<void> parse(const fs::path& path) {
    const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr),
                                                                              XML_ParserFree);
    XML_SetUserData(parser.get(), this);
    XML_SetElementHandler(parser.get(), on_start, on_end);
    XML_SetCharacterDataHandler(parser.get(), on_text);
    std::ifstream file(path, std::ios::binary);
    std::vector<char> piece(1 << 16);
    bool is_last = false;
    while (!is_last) {
      file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
      is_last = !file;
      if (XML_Parse(parser.get(), piece.data(), static_cast<int>(file.gcount()), is_last) == XML_STATUS_OK)
        continue;
      return bad_file(path, "is no GIFTI file, or is damaged: line {}, {}",
                      XML_GetCurrentLineNumber(parser.get()),
                      XML_ErrorString(XML_GetErrorCode(parser.get())));
    }
    return {};
  }
  [[nodiscard]] const DataArray* find(const std::string& intent) const {
    const auto found =
        std::ranges::find_if(arrays_, [&](const DataArray& array) { return array.get("Intent") == intent; });
    return found == arrays_.end() ? nullptr : &*found;
  }

 private:
  static void on_start(void* self, const char* name, const char** attributes) {
    static_cast<GiftiParser*>(self)->start(name, attributes);
  }
  static void on_end(void* self, const char* name) { static_cast<GiftiParser*>(self)->end(name); }
  static void on_text(void* self, const char* text, int length) {
    static_cast<GiftiParser*>(self)->text_.append(text, static_cast<std::size_t>(length));
  }

  void start(const std::string& name, const char** attributes) {
    text_.clear();
    if (name != "DataArray") return;
    DataArray& array = arrays_.emplace_back();
    for (; *attributes != nullptr; attributes += 2) array.attributes[attributes[0]] = attributes[1];
  }
  void end(const std::string& name) {
    if (arrays_.empty()) return;
    DataArray& array = arrays_.back();
    if (name == "Data") array.data = std::move(text_);
    if (name == "Name") name_ = std::string(trimmed(text_));
    if (name == "Value") array.metadata[name_] = std::string(trimmed(text_));
    if (name == "DataSpace")
      array.is_of_scanner = array.is_of_scanner || trimmed(text_) == "NIFTI_XFORM_SCANNER_ANAT";
    if (name == "TransformedSpace") space_ = std::string(trimmed(text_));
    if (name == "MatrixData") matrix_ = std::move(text_);
    if (name == "CoordinateSystemTransformMatrix" && space_ == "NIFTI_XFORM_SCANNER_ANAT") {
      std::array<double, 16> matrix{};
      const std::vector<std::string_view> numbers = split_blanks(matrix_);
      for (std::size_t n = 0; n < 16 && numbers.size() == 16; ++n)
        matrix[n] = parse_number(numbers[n]).value_or(NAN);
      if (numbers.size() == 16) array.to_scanner = matrix;
    }
    text_.clear();
  }

  std::vector<DataArray> arrays_;
  std::string text_, name_, space_, matrix_;
};

std::optional<std::string> decoded_base64(std::string_view text) {
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    if (c == '=' || c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    if (++count % 4 == 0) {
      for (int shift = 16; shift >= 0; shift -= 8) bytes += static_cast<char>(bits >> shift & 0xff);
    }
  }
  if (count % 4 == 1) return std::nullopt;
  if (count % 4 == 2) bytes += static_cast<char>(bits >> 4 & 0xff);
  if (count % 4 == 3) {
    bytes += static_cast<char>(bits >> 10 & 0xff);
    bytes += static_cast<char>(bits >> 2 & 0xff);
  }
  return bytes;
}

/// Numbers of an array of N x 3, row by row.
Result<std::vector<double>> numbers_of(const DataArray& array, const fs::path& path) {
  const auto rows = parse_integer(array.get("Dim0")), columns = parse_integer(array.get("Dim1"));
  constexpr std::int64_t kMostRows = std::int64_t{1} << 28;
  if (array.get("Dimensionality") != "2" || !rows || *rows < 1 || *rows > kMostRows || columns != 3)
    return bad_file(path, "has an array of {} x {} numbers; N x 3 are needed", array.get("Dim0"),
                    array.get("Dim1"));
  const auto count = static_cast<std::size_t>(*rows) * 3;
  const std::string encoding = array.get("Encoding"), type = array.get("DataType");
  std::vector<double> numbers;
  if (encoding == "ASCII") {
    for (const std::string_view word : split_blanks(std::string_view(array.data)))
      numbers.push_back(parse_number(word).value_or(NAN));
  } else if (encoding == "Base64Binary" || encoding == "GZipBase64Binary") {
    const bool is_float = type == "NIFTI_TYPE_FLOAT32";
    if (!is_float && type != "NIFTI_TYPE_INT32")
      return bad_file(path, "has points or triangles of type {}", type);
    std::optional<std::string> bytes = decoded_base64(array.data);
    if (bytes && encoding.starts_with("GZip")) {
      std::string inflated(4 * count, '\0');
      uLongf length = inflated.size();
      const int status = uncompress(reinterpret_cast<Bytef*>(inflated.data()), &length,
                                    reinterpret_cast<const Bytef*>(bytes->data()), bytes->size());
      bytes = status == Z_OK && length == inflated.size() ? std::optional(std::move(inflated)) : std::nullopt;
    }
    if (!bytes || bytes->size() != 4 * count)
      return bad_file(path, "has a damaged array ({})", array.get("Intent"));
    for (std::size_t n = 0; n < count; ++n) {
      std::array<char, 4> field{};
      std::copy_n(&(*bytes)[4 * n], 4, field.begin());
      if (array.get("Endian") == "BigEndian") std::ranges::reverse(field);
      float real = 0;
      std::int32_t integer = 0;
      std::memcpy(&real, field.data(), 4);
      std::memcpy(&integer, field.data(), 4);
      numbers.push_back(is_float ? double{real} : static_cast<double>(integer));
    }
  } else {
    return bad_file(path, "has its numbers in encoding {}; convert it with wb_command -gifti-convert ASCII",
                    encoding);
  }
  if (numbers.size() != count)
    return bad_file(path, "promises {} numbers, {} are there", count, numbers.size());
  if (array.get("ArrayIndexingOrder") == "ColumnMajorOrder") {
    std::vector<double> by_row(count);
    for (std::size_t n = 0; n < count; ++n) by_row[n / (count / 3) + n % (count / 3) * 3] = numbers[n];
    numbers = std::move(by_row);
  }
  return numbers;
}

/// Points to the scanner's frame: by the file's matrix, or by the centre of FreeSurfer's volume.
void to_scanner(const DataArray& array, std::vector<double>& points) {
  if (array.is_of_scanner) return;
  std::array<double, 16> matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  if (array.to_scanner) matrix = *array.to_scanner;
  for (std::size_t row = 0; row < 3 && !array.to_scanner; ++row) {
    const auto center = array.metadata.find(std::string("VolGeomC_") + "RAS"[row]);
    if (center != array.metadata.end()) matrix[4 * row + 3] = parse_number(center->second).value_or(0);
  }
  for (std::size_t p = 0; p < points.size(); p += 3) {
    std::array<double, 3> moved{};
    for (std::size_t row = 0; row < 3; ++row) {
      moved[row] = matrix[4 * row + 3];
      for (std::size_t a = 0; a < 3; ++a) moved[row] += matrix[4 * row + a] * points[p + a];
    }
    std::ranges::copy(moved, points.begin() + static_cast<std::ptrdiff_t>(p));
  }
}

}  // namespace

Result<vtkSmartPointer<vtkPolyData>> read_gifti(const fs::path& path) {
  GiftiParser parser;
  SPLATLAS_RETURN_IF_ERROR(parser.parse(path));
  const DataArray* const point_array = parser.find("NIFTI_INTENT_POINTSET");
  const DataArray* const triangle_array = parser.find("NIFTI_INTENT_TRIANGLE");
  if (point_array == nullptr || triangle_array == nullptr)
    return bad_file(path,
                    "holds no surface: points or triangles are missing (labels and time series have none)");
  SPLATLAS_ASSIGN_OR_RETURN(std::vector<double> points, numbers_of(*point_array, path));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<double> corners, numbers_of(*triangle_array, path));
  to_scanner(*point_array, points);
  PolygonMesh mesh;
  for (std::size_t p = 0; p < points.size(); p += 3) mesh.points->InsertNextPoint(&points[p]);
  const std::size_t point_count = points.size() / 3;
  const auto count = static_cast<double>(point_count);
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    std::array<vtkIdType, 3> triangle{};
    for (std::size_t n = 0; n < 3; ++n) {
      const double corner = corners[t + n];
      if (!(corner >= 0 && corner < count && std::floor(corner) == corner))
        return bad_file(path, "triangle {} has corner {}, but there are {} points", t / 3, corner, count);
      triangle[n] = static_cast<vtkIdType>(corner);
    }
    mesh.add_polygon(triangle);
  }
  return mesh.poly_data();
}

}  // namespace splatlas
