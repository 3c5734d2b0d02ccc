#include <algorithm>
#include <map>
#include <set>

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

constexpr std::size_t kMaxHeaderBytes = 1u << 20;

/// "field: value", names in lower case. A blank line ends the header.
HeaderLine parse_line(std::string_view raw_line) {
  using Kind = HeaderLine::Kind;
  const std::string_view line = trimmed(raw_line);
  if (line.empty()) return {};
  const std::size_t colon = line.find(": ");  // excludes "key:=value"
  if (line.front() == '#' || colon == std::string_view::npos) return {Kind::kComment, {}, {}};
  return {Kind::kField, to_lower(trimmed(line.substr(0, colon))),
          std::string(trimmed(line.substr(colon + 2)))};
}

/// Bytes of a pixel of a supported type; 0 for others.
std::uint64_t bytes_of_type(const std::string& type) {
  static const std::map<std::uint64_t, std::set<std::string>> kTypes{
      {1, {"signed char", "int8", "int8_t", "uchar", "unsigned char", "uint8", "uint8_t"}},
      {2,
       {"short", "short int", "signed short", "signed short int", "int16", "int16_t", "ushort",
        "unsigned short", "unsigned short int", "uint16", "uint16_t"}},
      {4, {"int", "signed int", "int32", "int32_t", "uint", "unsigned int", "uint32", "uint32_t", "float"}},
      {8, {"double"}}};
  for (const auto& [bytes, names] : kTypes) {
    if (names.contains(to_lower(type))) return bytes;
  }
  return 0;
}

/// Spacings and directions must be plausible, and spacings positive ("none" marks other axes).
Result<void> check_geometry(const TextHeader& header, const fs::path& path) {
  for (const char* field : {"spacings", "space directions", "space origin"}) {
    std::string text = header.get(field);
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
    for (const std::string_view part : split_blanks(text)) {
      if (part == "none") continue;
      const auto value = parse_number(part);
      const bool positive = std::string_view(field) != "spacings" || (value && *value > 0);
      if (!value || !is_plausible(*value) || !positive) {
        return bad_file(path, "has '{}: {}' in its header, which is no geometry", field, header.get(field));
      }
    }
  }
  return {};
}

Result<std::uint64_t> expected_bytes(const TextHeader& header, const fs::path& path) {
  std::vector<std::int64_t> sizes;
  const std::string sizes_text = header.get("sizes");
  for (const std::string_view part : split_blanks(sizes_text)) {
    sizes.push_back(parse_integer(part).value_or(0));
  }
  if (sizes.size() < 2 || sizes.size() > 4) {
    return bad_file(path, "has {} dimensions; a volume has 2 or 3", sizes.size());
  }
  const std::uint64_t bytes = bytes_of_type(header.get("type"));
  if (bytes == 0) return bad_pixel_type(path, "type '" + header.get("type") + "'");
  return payload_bytes(path, sizes, bytes);
}

Result<void> check_gzip_pixels(const TextHeader& header, const fs::path& pixels, std::uint64_t start,
                               std::uint64_t expected) {
  const std::string skipped_lines = header.get("line skip", header.get("lineskip"));
  if (parse_integer(skipped_lines).value_or(0) == 0) return check_deflated_payload(pixels, start, expected);
  // The stream starts after lines of unknown length: check its size only.
  return check_raw_payload(pixels, start, expected / kMaxDeflateRatio, expected);
}

}  // namespace

Result<void> check_nrrd_file(const fs::path& path) {
  if (!first_bytes(path, 7).starts_with("NRRD000")) return bad_file(path, "is not an NRRD file");
  SPLATLAS_ASSIGN_OR_RETURN(const TextHeader header, read_text_header(path, kMaxHeaderBytes, parse_line));
  SPLATLAS_RETURN_IF_ERROR(check_geometry(header, path));
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t expected, expected_bytes(header, path));

  fs::path pixels = path;
  const std::string name = header.get("data file", header.get("datafile"));
  if (name.starts_with("LIST") || name.find('%') != std::string::npos) {
    return bad_file(path, "spreads its pixels over several files; give one file");
  }
  if (!name.empty()) {
    SPLATLAS_ASSIGN_OR_RETURN(pixels, resolve_beside(path, name));
  }
  const std::uint64_t start = name.empty() ? header.bytes : 0;
  const std::string encoding = to_lower(header.get("encoding"));
  if (encoding == "raw") return check_raw_payload(pixels, start, expected);
  if (encoding == "gzip" || encoding == "gz") return check_gzip_pixels(header, pixels, start, expected);
  // A pixel as text takes at least two characters, except for the last. ITK counts pixels exactly.
  const std::uint64_t voxels = expected / bytes_of_type(header.get("type"));
  if (encoding == "hex") return check_raw_payload(pixels, start, 2 * expected);
  if (encoding == "ascii" || encoding == "text" || encoding == "txt") {
    return check_raw_payload(pixels, start, 2 * voxels - 1);
  }
  return bad_file(path, "has pixels in encoding '{}'; raw, gzip, ascii and hex are read", encoding);
}

}  // namespace splatlas
