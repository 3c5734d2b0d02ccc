#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <vtkBase64Utilities.h>
#include <vtkXMLUtilities.h>
#include <zlib.h>

#include "format/result_macros.h"
#include "preprocess/import/meshes/polygon_readers.h"
#include "preprocess/import/quiet_vtk.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// The text of a nested element; empty if there is none.
std::string text_in(vtkXMLDataElement& element, const char* name) {
  return text_of(element.FindNestedElementWithName(name));
}

/// Bytes of base64, inflated if the encoding says so; nothing if they are not `count`.
std::optional<std::string> decoded(std::string text, const std::string& encoding, std::size_t count) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; });
  std::string bytes(text.size() / 4 * 3, '\0');
  const auto input = reinterpret_cast<const unsigned char*>(text.data());
  const auto output = reinterpret_cast<unsigned char*>(bytes.data());
  const std::size_t length = vtkBase64Utilities::DecodeSafely(input, text.size(), output, bytes.size());
  const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with("=") ? 1 : 0;
  if (text.size() % 4 != 0 || length + padding != bytes.size()) return std::nullopt;
  bytes.resize(length);
  if (encoding.starts_with("GZip")) {
    std::string inflated(count, '\0');
    uLongf size = count;
    if (uncompress(reinterpret_cast<Bytef*>(inflated.data()), &size, output, length) != Z_OK) size = 0;
    inflated.resize(size);
    bytes = std::move(inflated);
  }
  return bytes.size() == count ? std::optional(std::move(bytes)) : std::nullopt;
}

/// The numbers of `bytes`, of four bytes each.
template <typename T>
void append_numbers(const std::string& bytes, bool is_big_endian, std::vector<double>& numbers) {
  for (std::size_t at = 0; at < bytes.size(); at += 4) {
    std::array<char, 4> field{};
    std::copy_n(&bytes[at], 4, field.begin());
    if (is_big_endian) std::ranges::reverse(field);
    numbers.push_back(static_cast<double>(std::bit_cast<T>(field)));
  }
}

/// Numbers of an array of N x 3, row by row.
Result<std::vector<double>> numbers_of(vtkXMLDataElement& array, const fs::path& path) {
  const std::string rows_text = attribute(array, "Dim0"), columns = attribute(array, "Dim1");
  const auto rows = parse_integer(rows_text);
  constexpr std::int64_t kMostRows = std::int64_t{1} << 28;
  if (attribute(array, "Dimensionality") != "2" || !rows || *rows < 1 || *rows > kMostRows || columns != "3")
    return bad_file(path, "has an array of {} x {} numbers; N x 3 are needed", rows_text, columns);
  const auto count = static_cast<std::size_t>(*rows) * 3;
  const std::string encoding = attribute(array, "Encoding"), type = attribute(array, "DataType"),
                    data = text_in(array, "Data");
  std::vector<double> numbers;
  if (encoding == "ASCII") {
    for (const std::string_view word : split_blanks(data))
      numbers.push_back(parse_number(word).value_or(NAN));
  } else if (encoding == "Base64Binary" || encoding == "GZipBase64Binary") {
    const std::optional<std::string> bytes = decoded(data, encoding, 4 * count);
    const bool is_big_endian = attribute(array, "Endian") == "BigEndian";
    if (type != "NIFTI_TYPE_FLOAT32" && type != "NIFTI_TYPE_INT32")
      return bad_file(path, "has points or triangles of type {}", type);
    if (!bytes) return bad_file(path, "has a damaged array ({})", attribute(array, "Intent"));
    if (type == "NIFTI_TYPE_INT32")
      append_numbers<std::int32_t>(*bytes, is_big_endian, numbers);
    else
      append_numbers<float>(*bytes, is_big_endian, numbers);
  } else {
    return bad_file(path, "has its numbers in encoding {}; convert it with wb_command -gifti-convert ASCII",
                    encoding);
  }
  if (numbers.size() != count)
    return bad_file(path, "promises {} numbers, {} are there", count, numbers.size());
  if (attribute(array, "ArrayIndexingOrder") == "ColumnMajorOrder") {
    std::vector<double> by_row(count);
    for (std::size_t n = 0; n < count; ++n) by_row[n / (count / 3) + n % (count / 3) * 3] = numbers[n];
    numbers = std::move(by_row);
  }
  return numbers;
}

/// Row by row, the matrix to the scanner's frame: that of the file, or by the centre of FreeSurfer's volume.
std::array<double, 16> matrix_to_scanner(vtkXMLDataElement& array) {
  constexpr const char* kScanner = "NIFTI_XFORM_SCANNER_ANAT";
  constexpr std::array<double, 16> kSame{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  std::array<double, 16> matrix = kSame;
  bool has_matrix = false;
  for (int n = 0; n < array.GetNumberOfNestedElements(); ++n) {
    vtkXMLDataElement& system = *array.GetNestedElement(n);
    if (text_in(system, "DataSpace") == kScanner) return kSame;
    const std::string text = text_in(system, "MatrixData");
    const std::vector<std::string_view> numbers = split_blanks(text);
    if (text_in(system, "TransformedSpace") != kScanner || numbers.size() != 16) continue;
    has_matrix = true;
    std::ranges::transform(numbers, matrix.begin(),
                           [](std::string_view word) { return parse_number(word).value_or(NAN); });
  }
  vtkXMLDataElement* const metadata = array.FindNestedElementWithName("MetaData");
  for (int n = 0; !has_matrix && metadata != nullptr && n < metadata->GetNumberOfNestedElements(); ++n) {
    vtkXMLDataElement& pair = *metadata->GetNestedElement(n);
    for (std::size_t row = 0; row < 3; ++row) {
      if (text_in(pair, "Name") == std::string("VolGeomC_") + "RAS"[row])
        matrix[4 * row + 3] = parse_number(text_in(pair, "Value")).value_or(0);
    }
  }
  return matrix;
}

}  // namespace

Result<vtkSmartPointer<vtkPolyData>> read_gifti(const fs::path& path) {
  initialize_vtk();
  const auto file = vtk::TakeSmartPointer(vtkXMLUtilities::ReadElementFromFile(path.c_str()));
  if (file == nullptr) return bad_file(path, "is no GIFTI file, or is damaged: its XML is not whole");
  vtkXMLDataElement* const point_array =
      file->FindNestedElementWithNameAndAttribute("DataArray", "Intent", "NIFTI_INTENT_POINTSET");
  vtkXMLDataElement* const triangle_array =
      file->FindNestedElementWithNameAndAttribute("DataArray", "Intent", "NIFTI_INTENT_TRIANGLE");
  if (point_array == nullptr || triangle_array == nullptr)
    return bad_file(path,
                    "holds no surface: points or triangles are missing (labels and time series have none)");
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<double> points, numbers_of(*point_array, path));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<double> corners, numbers_of(*triangle_array, path));
  const std::array<double, 16> matrix = matrix_to_scanner(*point_array);
  PolygonMesh mesh;
  for (std::size_t p = 0; p < points.size(); p += 3) {
    std::array<double, 3> moved{};
    for (std::size_t row = 0; row < 3; ++row) {
      moved[row] = matrix[4 * row + 3];
      for (std::size_t a = 0; a < 3; ++a) moved[row] += matrix[4 * row + a] * points[p + a];
    }
    mesh.points->InsertNextPoint(moved.data());
  }
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    std::array<vtkIdType, 3> triangle{};
    for (std::size_t n = 0; n < 3; ++n) {
      // Others become -1, which has no point.
      const double corner = corners[t + n];
      triangle[n] =
          std::abs(corner) < 1e9 && std::floor(corner) == corner ? static_cast<vtkIdType>(corner) : -1;
    }
    mesh.add_polygon(triangle);
  }
  return mesh.poly_data();
}

}  // namespace splatlas
