#include <cmath>
#include <map>
#include <optional>

#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
#include "preprocess/import/images/check_image_file.h"
#include "preprocess/import/images/image_payload.h"
#include "preprocess/import/images/text_header.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxHeaderBytes = 1u << 16;
constexpr std::size_t kMaxLineBytes = 4096;

/// "Key = Value"; pixels may follow ElementDataFile.
HeaderLine parse_line(std::string_view line) {
  using Kind = HeaderLine::Kind;
  const std::size_t equals = line.find('=');
  if (line.size() > kMaxLineBytes) return {};
  if (equals == std::string_view::npos) return {trimmed(line).empty() ? Kind::kComment : Kind::kEnd, {}, {}};
  const std::string key(trimmed(line.substr(0, equals)));
  return {key == "ElementDataFile" ? Kind::kLastField : Kind::kField, key,
          std::string(trimmed(line.substr(equals + 1)))};
}

bool is_true(const std::string& value) {
  return value.starts_with('T') || value.starts_with('t') || value == "1";
}

/// Parses `count` valid numbers of a geometry; none for any other text.
std::optional<std::vector<double>> numbers(const std::string& text, std::size_t count) {
  std::vector<double> values;
  for (const std::string_view part : split_blanks(text)) {
    const auto value = parse_number(part);
    if (!value || !is_plausible(*value)) return std::nullopt;
    values.push_back(*value);
  }
  if (values.size() != count) return std::nullopt;
  return values;
}

int bytes_of_element(const std::string& type) {
  static const std::map<std::string, int> kBytes{{"MET_UCHAR", 1}, {"MET_CHAR", 1},  {"MET_USHORT", 2},
                                                 {"MET_SHORT", 2}, {"MET_UINT", 4},  {"MET_INT", 4},
                                                 {"MET_FLOAT", 4}, {"MET_DOUBLE", 8}};
  const auto found = kBytes.find(type);
  return found == kBytes.end() ? 0 : found->second;
}

Result<void> check_geometry(const TextHeader& header, std::size_t dimensions, const fs::path& path) {
  for (const char* key : {"ElementSpacing", "ElementSize"}) {
    if (!header.fields.contains(key)) continue;
    const auto spacing = numbers(header.get(key), dimensions);
    if (!spacing || *std::min_element(spacing->begin(), spacing->end()) <= 0) {
      return bad_file(path, "has {} = {}; it must be {} positive numbers", key, header.get(key), dimensions);
    }
  }
  for (const char* key : {"Offset", "Position", "Origin", "TransformMatrix", "Orientation", "Rotation"}) {
    if (!header.fields.contains(key)) continue;
    const bool matrix = std::string_view(key) != "Offset" && std::string_view(key) != "Position" &&
                        std::string_view(key) != "Origin";
    const std::size_t count = matrix ? dimensions * dimensions : dimensions;
    if (!numbers(header.get(key), count)) {
      return bad_file(path, "has {} = {}; it must be {} finite numbers", key, header.get(key), count);
    }
  }
  return {};
}

Result<std::uint64_t> expected_bytes(const TextHeader& header, std::size_t dimensions, const fs::path& path) {
  const auto sizes = numbers(header.get("DimSize"), dimensions);
  if (!sizes)
    return bad_file(path, "has DimSize = {}; it must be {} numbers", header.get("DimSize"), dimensions);
  std::vector<std::int64_t> whole;
  for (const double size : *sizes) {
    if (std::floor(size) != size || std::abs(size) > 1e12)
      return bad_file(path, "has a DimSize that is not whole");
    whole.push_back(static_cast<std::int64_t>(size));
  }
  if (dimensions == 4) SPLATLAS_RETURN_IF_ERROR(check_one_volume(path, whole[3]));
  if (header.get("ElementNumberOfChannels", "1") != "1") {
    return bad_file(path, "has {} values a voxel; one is needed", header.get("ElementNumberOfChannels"));
  }
  const int bytes = bytes_of_element(header.get("ElementType"));
  if (bytes == 0) return bad_pixel_type(path, "type " + header.get("ElementType", "(none)"));
  return payload_bytes(path, whole, static_cast<std::uint64_t>(bytes));
}

Result<void> check_payload(const TextHeader& header, std::uint64_t expected, const fs::path& path) {
  const std::string name = header.get("ElementDataFile");
  const bool local = to_lower(name) == "local";
  if (name.empty() || to_lower(name).starts_with("list") || name.find('%') != std::string::npos) {
    return bad_file(path, "spreads its pixels over several files; give one file");
  }
  fs::path pixels = path;
  if (!local) {
    SPLATLAS_ASSIGN_OR_RETURN(pixels, resolve_beside(path, name));
  }
  const std::uint64_t start = local ? header.bytes : 0;
  if (is_true(header.get("CompressedData"))) return check_deflated_payload(pixels, start, expected);
  const auto skip = parse_integer(header.get("HeaderSize", "0"));
  if (!skip || *skip < -1) return bad_file(path, "has HeaderSize = {}", header.get("HeaderSize"));
  return check_raw_payload(pixels, start + (*skip > 0 ? static_cast<std::uint64_t>(*skip) : 0), expected);
}

}  // namespace

Result<void> check_meta_image_file(const fs::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const TextHeader header, read_text_header(path, kMaxHeaderBytes, parse_line));
  if (!header.fields.contains("ElementDataFile"))
    return bad_file(path, "is not a MetaImage file (no ElementDataFile in its header)");
  const auto dimensions = parse_integer(header.get("NDims"));
  if (!dimensions || *dimensions < 2 || *dimensions > 4) {
    return bad_file(path, "has NDims = {}; a volume has 2 or 3 dimensions", header.get("NDims", "(none)"));
  }
  if (header.fields.contains("BinaryData") && !is_true(header.get("BinaryData"))) {
    return bad_file(path, "has its pixels as text; write them as binary data");
  }
  const auto axes = static_cast<std::size_t>(*dimensions);
  SPLATLAS_RETURN_IF_ERROR(check_geometry(header, axes, path));
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t expected, expected_bytes(header, axes, path));
  return check_payload(header, expected, path);
}

}  // namespace splatlas
