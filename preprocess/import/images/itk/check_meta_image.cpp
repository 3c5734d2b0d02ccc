// Checks of MetaImage files.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "format/content/grid.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

struct TextHeader {
  std::map<std::string, std::string> fields;
  std::uint64_t bytes = 0;  ///< length of the header; pixels may follow

  [[nodiscard]] std::string get(const std::string& field, const std::string& otherwise = "") const {
    const auto found = fields.find(field);
    return found == fields.end() ? otherwise : found->second;
  }
};

/// Reads lines "Key = Value" to ElementDataFile, whose pixels may follow, to a line without a field, or to
/// the end of the first MiB. kFailed for a field that occurs twice.
Result<TextHeader> read_text_header(const fs::path& path) {
  constexpr std::size_t kMaxLineBytes = 4096;
  const std::string text = first_bytes(path, 1u << 20);
  TextHeader header;
  while (header.bytes < text.size() && !header.fields.contains("ElementDataFile")) {
    const std::size_t end = std::min(text.find('\n', header.bytes), text.size());
    const std::string_view line = std::string_view(text).substr(header.bytes, end - header.bytes);
    header.bytes = std::min(end + 1, text.size());
    const std::size_t equals = line.find('=');
    if (line.size() > kMaxLineBytes || (equals == std::string_view::npos && !trimmed(line).empty())) break;
    if (equals == std::string_view::npos) continue;
    const std::string key(trimmed(line.substr(0, equals)));
    if (!header.fields.emplace(key, trimmed(line.substr(equals + 1))).second)
      return bad_file(path, "says one field twice in its header, at byte {}", header.bytes);
  }
  return header;
}

/// Bytes of a pixel; 0 for types that are not supported.
std::uint64_t bytes_of_type(const std::string& type) {
  static const std::map<std::string, std::uint64_t> kTypes{
      {"MET_CHAR", 1},  {"MET_UCHAR", 1},  {"MET_SHORT", 2},     {"MET_USHORT", 2},
      {"MET_INT", 4},   {"MET_UINT", 4},   {"MET_LONG", 4},      {"MET_ULONG", 4},
      {"MET_FLOAT", 4}, {"MET_DOUBLE", 8}, {"MET_LONG_LONG", 8}, {"MET_ULONG_LONG", 8}};
  const auto found = kTypes.find(type);
  return found == kTypes.end() ? 0 : found->second;
}

/// True for `count` numbers of a geometry: plausible and, if required, positive.
bool are_numbers(const std::vector<std::string_view>& parts, std::size_t count, bool positive) {
  return parts.size() == count && std::ranges::all_of(parts, [&](std::string_view part) {
           const auto value = parse_number(part);
           return value && is_plausible(*value) && (!positive || *value > 0);
         });
}

Result<std::vector<std::int64_t>> parse_sizes(const std::string& text, const fs::path& path) {
  std::vector<std::int64_t> sizes;
  for (const std::string_view part : split_blanks(text)) {
    const auto size = parse_number(part);
    if (!size || std::floor(*size) != *size || std::abs(*size) > 1e12)
      return bad_file(path, "has sizes '{}'; whole numbers are needed", shown(text));
    sizes.push_back(static_cast<std::int64_t>(*size));
  }
  if (sizes.size() >= 2 && sizes.size() <= 5) return sizes;
  return bad_file(path, "has {} dimensions; a volume has 2 or 3", sizes.size());
}

Result<void> check_geometry(const TextHeader& header, std::size_t dimensions, const fs::path& path) {
  for (const std::string key : {"ElementSpacing", "ElementSize", "Offset", "Position", "Origin",
                                "TransformMatrix", "Orientation", "Rotation"}) {
    const bool is_spacing = key.starts_with("Element");
    const bool is_matrix = key == "TransformMatrix" || key == "Orientation" || key == "Rotation";
    const std::size_t count = is_matrix ? dimensions * dimensions : dimensions;
    const std::string text = header.get(key);
    if (!header.fields.contains(key) || are_numbers(split_blanks(text), count, is_spacing)) continue;
    return bad_file(path, "has {} = {}; it must be {} {} numbers", key, shown(text), count,
                    is_spacing ? "positive" : "finite");
  }
  return {};
}

bool is_true(const std::string& value) {
  return value.starts_with('T') || value.starts_with('t') || value == "1";
}

/// Moves the start of MetaImage's pixels to HeaderSize, an offset in their file. 0 stands for no such offset,
/// and -1 for pixels at the end of the file.
Result<void> skip_header_size(const TextHeader& header, const fs::path& path, PixelData& pixels) {
  const auto size = parse_integer(header.get("HeaderSize", "0"));
  if (!size || *size < -1) return bad_file(path, "has HeaderSize = {}", shown(header.get("HeaderSize")));
  std::error_code error;
  if (*size < 0)
    pixels.start =
        fs::file_size(pixels.file, error) - std::min(fs::file_size(pixels.file, error), pixels.bytes);
  if (*size <= 0) return {};
  if (static_cast<std::uint64_t>(*size) < pixels.start) {
    return bad_file(path, "has HeaderSize = {}, but its header alone has {} bytes; remove HeaderSize", *size,
                    pixels.start);
  }
  pixels.start = static_cast<std::uint64_t>(*size);
  return {};
}

}  // namespace

Result<PixelData> check_meta_image_file(const fs::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const TextHeader header, read_text_header(path));
  const std::string name = header.get("ElementDataFile");
  if (name.empty()) return bad_file(path, "is not a MetaImage file (no ElementDataFile in its header)");
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::int64_t> sizes, parse_sizes(header.get("DimSize"), path));
  if (parse_integer(header.get("NDims")) != std::ssize(sizes)) {
    return bad_file(path, "contradicts itself: NDims = {}, DimSize = {}",
                    shown(header.get("NDims", "(none)")), shown(header.get("DimSize")));
  }
  if (header.fields.contains("BinaryData") && !is_true(header.get("BinaryData"))) {
    return bad_file(path, "has its pixels as text; write them as binary data");
  }
  SPLATLAS_RETURN_IF_ERROR(check_geometry(header, sizes.size(), path));
  std::vector<std::int64_t> numbers = sizes;
  const auto channels = parse_integer(header.get("ElementNumberOfChannels", "1"));
  if (!channels || *channels < 1)
    return bad_file(path, "has ElementNumberOfChannels = {}", shown(header.get("ElementNumberOfChannels")));
  if (*channels > 1 && sizes.size() > 3)
    return bad_file(path, "has several volumes of {} values a voxel", *channels);
  numbers.push_back(*channels);
  const std::string type = header.get("ElementType", "(none)");
  const std::uint64_t bytes_per_voxel = bytes_of_type(type);
  if (bytes_per_voxel == 0) return bad_pixel_type(path, "type " + shown(type));
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t bytes, payload_bytes(path, numbers, bytes_per_voxel));
  PixelData pixels{.file = path, .start = header.bytes, .bytes = bytes};
  if (to_lower(name) != "local") {
    SPLATLAS_ASSIGN_OR_RETURN(pixels.file, pixel_file_beside(path, name));
    pixels.start = 0;
  }
  pixels.is_big_endian = is_true(header.get("BinaryDataByteOrderMSB", header.get("ElementByteOrderMSB")));
  pixels.is_plain = !is_true(header.get("CompressedData"));
  if (!pixels.is_plain) pixels.compression = Compression::kDeflate;
  pixels.mm_per_unit = mm_of_unit(header.get("DistanceUnits"));
  pixels.layers_first = *channels > 1;
  pixels.layers = static_cast<std::size_t>(*channels);
  for (std::size_t a = 3; a < sizes.size(); ++a) pixels.layers *= static_cast<std::size_t>(sizes[a]);
  SPLATLAS_RETURN_IF_ERROR(skip_header_size(header, path, pixels));
  SPLATLAS_RETURN_IF_ERROR(
      check_raw_payload(pixels.file, pixels.start,
                        pixels.compression == Compression::kNone ? bytes : bytes / kMaxDeflateRatio, bytes));
  return pixels;
}

}  // namespace splatlas
