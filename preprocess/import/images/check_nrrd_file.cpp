#include <algorithm>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
#include "preprocess/import/images/check_image_file.h"
#include "preprocess/import/images/image_payload.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxHeaderBytes = 1u << 20;

/// "field: value" lines up to the blank line, after which the pixels may follow.
struct NrrdHeader {
  std::map<std::string, std::string> fields;  ///< names in lower case
  std::uint64_t bytes = 0;                    ///< length of the header, blank line included

  [[nodiscard]] std::string get(const std::string& field) const {
    const auto found = fields.find(field);
    return found == fields.end() ? std::string() : found->second;
  }
  /// Fields that may be written with or without a blank.
  [[nodiscard]] std::string get(const std::string& field, const std::string& synonym) const {
    return fields.contains(field) ? get(field) : get(synonym);
  }
};

tl::unexpected<Error> bad(const fs::path& path, const std::string& what) {
  return fail(ErrorCode::kFailed, fmt::format("{}: {}", path.string(), what));
}

Result<NrrdHeader> read_header(const fs::path& path) {
  std::string text(kMaxHeaderBytes, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (!text.starts_with("NRRD000")) return bad(path, "is not an NRRD file");

  NrrdHeader header;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    const std::string_view line = trimmed(std::string_view(text).substr(start, end - start));
    start = std::min(end + 1, text.size());
    if (line.empty()) {
      header.bytes = start;
      return header;
    }
    const std::size_t colon = line.find(": ");
    if (line.front() == '#' || colon == std::string_view::npos) continue;  // comment, or "key:=value"
    const std::string field = to_lower(trimmed(line.substr(0, colon)));
    if (!header.fields.emplace(field, trimmed(line.substr(colon + 2))).second) {
      return bad(path, fmt::format("says '{}' twice in its header", field));
    }
  }
  header.bytes = text.size();
  return header;
}

/// Bytes of a value of an NRRD type that atlases take; 0 for others.
std::uint64_t bytes_of_type(const std::string& type) {
  static const std::map<std::string, std::uint64_t> kBytes{{"signed char", 1},
                                                           {"int8", 1},
                                                           {"int8_t", 1},
                                                           {"uchar", 1},
                                                           {"unsigned char", 1},
                                                           {"uint8", 1},
                                                           {"uint8_t", 1},
                                                           {"short", 2},
                                                           {"short int", 2},
                                                           {"signed short", 2},
                                                           {"signed short int", 2},
                                                           {"int16", 2},
                                                           {"int16_t", 2},
                                                           {"ushort", 2},
                                                           {"unsigned short", 2},
                                                           {"unsigned short int", 2},
                                                           {"uint16", 2},
                                                           {"uint16_t", 2},
                                                           {"int", 4},
                                                           {"signed int", 4},
                                                           {"int32", 4},
                                                           {"int32_t", 4},
                                                           {"uint", 4},
                                                           {"unsigned int", 4},
                                                           {"uint32", 4},
                                                           {"uint32_t", 4},
                                                           {"float", 4},
                                                           {"double", 8}};
  const auto found = kBytes.find(to_lower(type));
  return found == kBytes.end() ? 0 : found->second;
}

/// Spacings and directions: every number must be finite, and no spacing zero ("none" marks other axes).
Result<void> check_geometry(const NrrdHeader& header, const fs::path& path) {
  for (const char* field : {"spacings", "space directions", "space origin"}) {
    std::string text = header.get(field);
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
    for (const std::string_view part : split_blanks(text)) {
      if (part == "none") continue;
      const auto value = parse_number(part);
      const bool positive = std::string_view(field) != "spacings" || (value && *value > 0);
      if (!value || !is_plausible(*value) || !positive) {
        return bad(path,
                   fmt::format("has '{}: {}' in its header, which is no geometry", field, header.get(field)));
      }
    }
  }
  return {};
}

Result<std::uint64_t> expected_bytes(const NrrdHeader& header, const fs::path& path) {
  std::vector<std::int64_t> sizes;
  const std::string sizes_text = header.get("sizes");
  for (const std::string_view part : split_blanks(sizes_text)) {
    sizes.push_back(parse_integer(part).value_or(0));
  }
  if (sizes.size() < 2 || sizes.size() > 4) {
    return bad(path, fmt::format("has {} dimensions; a volume has 2 or 3", sizes.size()));
  }
  const std::uint64_t bytes = bytes_of_type(header.get("type"));
  if (bytes == 0) {
    return bad(path,
               fmt::format("has pixels of type '{}'; 8, 16 and 32-bit integers, float and double are read",
                           header.get("type")));
  }
  return payload_bytes(path, sizes, bytes);
}

/// Lines and bytes may be skipped before and after decompression: what is skipped only adds to the bytes.
Result<void> check_gzip_pixels(const NrrdHeader& header, const fs::path& pixels, std::uint64_t start,
                               std::uint64_t expected) {
  const auto skipped_lines = parse_integer(header.get("line skip", "lineskip")).value_or(0);
  if (skipped_lines == 0) return check_deflated_payload(pixels, start, expected);
  constexpr std::uint64_t kMaxRatio = 1100;  // deflate's is 1032
  return check_raw_payload(pixels, start, expected / kMaxRatio);
}

}  // namespace

Result<void> check_nrrd_file(const fs::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const NrrdHeader header, read_header(path));
  SPLATLAS_RETURN_IF_ERROR(check_geometry(header, path));
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t expected, expected_bytes(header, path));

  fs::path pixels = path;
  const std::string name = header.get("data file", "datafile");
  if (name.starts_with("LIST") || name.find('%') != std::string::npos) {
    return bad(path, "spreads its pixels over several files; give one file");
  }
  if (!name.empty()) {
    SPLATLAS_ASSIGN_OR_RETURN(pixels, resolve_beside(path, name));
  }
  const std::uint64_t start = name.empty() ? header.bytes : 0;
  const std::string encoding = to_lower(header.get("encoding"));
  if (encoding == "raw") return check_raw_payload(pixels, start, expected);
  if (encoding == "gzip" || encoding == "gz") return check_gzip_pixels(header, pixels, start, expected);
  // Text pixels take two characters each at least, the last one aside; ITK counts them exactly.
  const std::uint64_t voxels = expected / bytes_of_type(header.get("type"));
  if (encoding == "hex") return check_raw_payload(pixels, start, 2 * expected);
  if (encoding == "ascii" || encoding == "text" || encoding == "txt") {
    return check_raw_payload(pixels, start, 2 * voxels - 1);
  }
  return bad(path, fmt::format("has pixels in encoding '{}'; raw, gzip, ascii and hex are read", encoding));
}

}  // namespace splatlas
