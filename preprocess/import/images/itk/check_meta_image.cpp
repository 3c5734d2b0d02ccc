// Checks of the image formats with text headers: NRRD and MetaImage.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "format/content/grid.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

struct TextHeader {
  std::map<std::string, std::string> fields;
  std::map<std::string, std::string> pairs;  ///< key/value pairs of NRRD
  std::uint64_t bytes = 0;                   ///< length of the header; pixels may follow

  /// The value of a field, or `otherwise`.
  [[nodiscard]] std::string get(const std::string& field, const std::string& otherwise = "") const {
    const auto found = fields.find(field);
    return found == fields.end() ? otherwise : found->second;
  }
};

/// A value for messages. Damage may join other lines to it, whose free text may name a patient.
std::string shown(const std::string& value) {
  std::size_t end = value.size();
  for (const char* mark : {": ", " = ", ":=", " #"}) end = std::min(end, value.find(mark));
  if (end == value.size()) return value;
  return value.substr(0, value.find_last_of(' ', end)) + " ...";
}

/// The fields that messages may name. Others hold free text, and so may their names.
bool is_known_field(const std::string& field) {
  static const std::set<std::string> kFields{
      "type",           "dimension",   "space",           "sizes",      "space directions", "kinds",
      "endian",         "encoding",    "space origin",    "spacings",   "space dimension",  "data file",
      "ObjectType",     "NDims",       "DimSize",         "Offset",     "Position",         "Origin",
      "ElementSpacing", "ElementType", "TransformMatrix", "Rotation",   "Orientation",      "CompressedData",
      "BinaryData",     "HeaderSize",  "ElementDataFile", "ElementSize"};
  return kFields.contains(field);
}

/// A line of a header.
struct HeaderLine {
  enum class Kind { kField, kLastField, kPair, kComment, kEnd } kind = Kind::kEnd;
  std::string field, value;
};

/// "field: value" of NRRD, names in lower case, or "key:=value". A blank line ends the header.
HeaderLine parse_nrrd_line(std::string_view raw_line) {
  using Kind = HeaderLine::Kind;
  const std::string_view line = trimmed(raw_line);
  if (line.empty()) return {};
  const std::size_t colon = line.find(": ");
  const std::size_t assign = line.find(":=");
  if (line.front() == '#') return {Kind::kComment, {}, {}};
  if (assign < colon)
    return {Kind::kPair, std::string(trimmed(line.substr(0, assign))),
            std::string(trimmed(line.substr(assign + 2)))};
  if (colon == std::string_view::npos) return {Kind::kComment, {}, {}};
  return {Kind::kField, to_lower(trimmed(line.substr(0, colon))),
          std::string(trimmed(line.substr(colon + 2)))};
}

/// "Key = Value" of MetaImage; pixels may follow ElementDataFile.
HeaderLine parse_meta_line(std::string_view line) {
  using Kind = HeaderLine::Kind;
  constexpr std::size_t kMaxLineBytes = 4096;
  const std::size_t equals = line.find('=');
  if (line.size() > kMaxLineBytes) return {};
  if (equals == std::string_view::npos) return {trimmed(line).empty() ? Kind::kComment : Kind::kEnd, {}, {}};
  const std::string key(trimmed(line.substr(0, equals)));
  return {key == "ElementDataFile" ? Kind::kLastField : Kind::kField, key,
          std::string(trimmed(line.substr(equals + 1)))};
}

/// Reads lines until kLastField or kEnd, or to the end of the first MiB. kFailed for a field that occurs
/// twice.
Result<TextHeader> read_text_header(const fs::path& path, HeaderLine (*parse_line)(std::string_view line)) {
  using Kind = HeaderLine::Kind;
  const std::string text = first_bytes(path, 1u << 20);
  TextHeader header;
  for (HeaderLine line{Kind::kComment, {}, {}};
       line.kind != Kind::kEnd && line.kind != Kind::kLastField && header.bytes < text.size();) {
    const std::size_t end = std::min(text.find('\n', header.bytes), text.size());
    line = parse_line(std::string_view(text).substr(header.bytes, end - header.bytes));
    header.bytes = std::min(end + 1, text.size());
    if (line.kind == Kind::kPair) header.pairs[line.field] = line.value;
    const bool is_field = line.kind == Kind::kField || line.kind == Kind::kLastField;
    if (is_field && !header.fields.emplace(line.field, line.value).second)
      return bad_file(path, "says '{}' twice in its header", is_known_field(line.field) ? line.field : "...");
  }
  return header;
}

/// Bytes of a pixel; 0 for types that are not supported. NRRD has many names for one: "unsigned short int",
/// "ushort", "uint16_t". ITK tells signed types from others.
std::uint64_t bytes_of_nrrd_type(std::string type) {
  std::erase(type, ' ');
  for (const std::string_view prefix : {"unsigned", "signed", "u"}) {
    if (!type.starts_with(prefix)) continue;
    type.erase(0, prefix.size());
    break;
  }
  if (type.ends_with("_t")) type.resize(type.size() - 2);
  static const std::map<std::string, std::uint64_t> kTypes{
      {"char", 1},  {"int8", 1},  {"short", 2},  {"shortint", 2}, {"int16", 2},       {"int", 4},
      {"int32", 4}, {"float", 4}, {"double", 8}, {"longlong", 8}, {"longlongint", 8}, {"int64", 8}};
  const auto found = kTypes.find(type);
  return found == kTypes.end() ? 0 : found->second;
}

/// The same for MetaImage.
std::uint64_t bytes_of_meta_type(const std::string& type) {
  static const std::map<std::string, std::uint64_t> kTypes{
      {"MET_CHAR", 1},  {"MET_UCHAR", 1},  {"MET_SHORT", 2},     {"MET_USHORT", 2},
      {"MET_INT", 4},   {"MET_UINT", 4},   {"MET_LONG", 4},      {"MET_ULONG", 4},
      {"MET_FLOAT", 4}, {"MET_DOUBLE", 8}, {"MET_LONG_LONG", 8}, {"MET_ULONG_LONG", 8}};
  const auto found = kTypes.find(type);
  return found == kTypes.end() ? 0 : found->second;
}

/// True for the numbers of a geometry: `count` of them (0: any number), plausible and, if required, positive.
bool are_numbers(const std::vector<std::string_view>& parts, std::size_t count, bool positive) {
  return (count == 0 || parts.size() == count) && std::ranges::all_of(parts, [&](std::string_view part) {
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

/// The pixel file that a detached header names. kFailed for absolute names, for names that leave the header's
/// folder through ".." or a symbolic link, and for anything but a regular file.
Result<fs::path> resolve_beside(const fs::path& header, const std::string& name) {
  std::error_code error;
  const fs::path folder =
      fs::canonical(header.has_parent_path() ? header.parent_path() : fs::path("."), error);
  const fs::path target = error ? fs::path() : fs::weakly_canonical(folder / name, error);
  const auto [rest_of_folder, unused] =
      std::mismatch(folder.begin(), folder.end(), target.begin(), target.end());
  if (error || rest_of_folder != folder.end() || fs::path(name).is_absolute()) {
    return bad_file(header, "names a pixel file outside its own folder: '{}'", shown(name));
  }
  SPLATLAS_RETURN_IF_ERROR(check_regular_file(target));
  return target;
}

/// Pixels of `bytes` bytes in the file `name`, or behind the header if that is empty.
Result<PixelData> find_pixels(const fs::path& path, const TextHeader& header, const std::string& name,
                              std::uint64_t bytes) {
  PixelData pixels;
  pixels.file = path;
  pixels.start = header.bytes;
  pixels.bytes = bytes;
  if (name.empty()) return pixels;
  // ITK's readers take any name that begins so for a list, and follow its lines to any file.
  const std::string lower = to_lower(name);
  if (lower.starts_with("list") || lower.starts_with("skiplist") || name.find('%') != std::string::npos) {
    return bad_file(path, "spreads its pixels over several files; give one file");
  }
  pixels.start = 0;
  SPLATLAS_ASSIGN_OR_RETURN(pixels.file, resolve_beside(path, name));
  return pixels;
}

Result<void> check_nrrd_geometry(const TextHeader& header, const fs::path& path) {
  for (const std::string field : {"spacings", "space directions", "space origin"}) {
    std::string text = header.get(field);
    std::ranges::replace_if(
        text, [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
    std::vector<std::string_view> parts = split_blanks(text);
    std::erase(parts, "none");                          // marks axes outside space
    if (field == "spacings") std::erase(parts, "nan");  // the same
    if (are_numbers(parts, 0, field == "spacings")) continue;
    return bad_file(path, "has '{}: {}' in its header, which is no geometry", field,
                    shown(header.get(field)));
  }
  return {};
}

/// Number and position of the layers: axes outside space, first ("none" ahead of the directions) or last.
Result<void> find_layers(const TextHeader& header, const std::vector<std::int64_t>& sizes,
                         const fs::path& path, PixelData& pixels) {
  const std::string all_directions = header.get("space directions"), all_kinds = header.get("kinds");
  const std::vector<std::string_view> directions = split_blanks(all_directions),
                                      kinds = split_blanks(all_kinds);
  if (!kinds.empty() && to_lower(kinds.front()).find("color") != std::string::npos)
    return bad_file(path, "holds colours (kind {}); a volume of numbers is needed", kinds.front());
  const auto is_spatial = [&](std::size_t a) {
    if (a < directions.size()) return directions[a] != "none";
    return a >= kinds.size() || kinds[a] == "domain" || kinds[a] == "space" || kinds[a] == "???";
  };
  pixels.layers_first = !is_spatial(0);
  if (pixels.layers_first) {
    pixels.layers = static_cast<std::size_t>(sizes[0]);
  } else {
    for (std::size_t a = 3; a < sizes.size(); ++a) pixels.layers *= static_cast<std::size_t>(sizes[a]);
  }
  return {};
}

/// The space of an NRRD file, as letters: "leftposteriorsuperior". Writers may use hyphens and blanks.
std::string space_of(const TextHeader& header) {
  std::string space = to_lower(header.get("space"));
  std::erase_if(space, [](char c) { return c == '-' || c == ' '; });
  return space;
}

/// A name of NRRD's that says nothing about the patient.
bool is_unknown_space(const std::string& space) {
  return space.empty() || space.starts_with("scanner") || space.starts_with("3d");
}

/// The axes x and y that ITK leaves with the wrong sign: it turns x of LAS in place of y, and nothing in
/// spaces with time.
std::array<bool, 2> misread_axes(const std::string& space) {
  if (space == "las" || space == "leftanteriorsuperior") return {true, true};
  if (space == "rast" || space == "rightanteriorsuperiortime") return {true, true};
  if (space == "last" || space == "leftanteriorsuperiortime") return {false, true};
  return {false, false};
}

Result<void> check_meta_geometry(const TextHeader& header, std::size_t dimensions, const fs::path& path) {
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

/// The offset behind the first `lines` lines from `start` on. kFailed if there are fewer.
Result<std::uint64_t> skip_lines(const fs::path& path, std::uint64_t start, std::uint64_t lines) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(start));
  std::vector<char> piece(1 << 16);
  for (std::uint64_t left = lines; left > 0;) {
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    if (file.gcount() <= 0) return bad_file(path, "is truncated: its header skips {} lines", lines);
    for (std::streamsize n = 0; n < file.gcount() && left > 0; ++n) {
      ++start;
      if (piece[static_cast<std::size_t>(n)] == '\n') --left;
    }
  }
  return start;
}

/// Applies NRRD's "line skip", in the file, and "byte skip", in the decompressed bytes, to compressed pixels.
/// Only ITK finds pixels at the end (-1).
Result<void> skip_nrrd_start(const TextHeader& header, const fs::path& path, PixelData& pixels) {
  const auto text_of = [&](const std::string& what) {
    return header.get(what + " skip", header.get(what + "skip", "0"));
  };
  const std::string line_skip = text_of("line"), byte_skip = text_of("byte");
  const auto lines = parse_integer(line_skip), bytes = parse_integer(byte_skip);
  if (!lines || *lines < 0 || !bytes || *bytes < -1 || *bytes > kMaxVoxels)
    return bad_file(path, "has line skip: {} and byte skip: {}; they must be counts", line_skip, byte_skip);
  if (*bytes < 0) return {};
  pixels.compression = Compression::kDeflate;
  pixels.skipped_bytes = static_cast<std::uint64_t>(*bytes);
  SPLATLAS_ASSIGN_OR_RETURN(pixels.start,
                            skip_lines(pixels.file, pixels.start, static_cast<std::uint64_t>(*lines)));
  return {};
}

/// Moves the start of MetaImage's pixels to HeaderSize, an offset in their file. 0 stands for no such offset,
/// and -1 for pixels at the end of the file.
Result<void> skip_header_size(const TextHeader& header, const fs::path& path, PixelData& pixels) {
  const auto size = parse_integer(header.get("HeaderSize", "0"));
  if (!size || *size < -1) return bad_file(path, "has HeaderSize = {}", shown(header.get("HeaderSize")));
  if (*size <= 0) return {};
  if (static_cast<std::uint64_t>(*size) < pixels.start) {
    return bad_file(path, "has HeaderSize = {}, but its header alone has {} bytes; remove HeaderSize", *size,
                    pixels.start);
  }
  pixels.start = static_cast<std::uint64_t>(*size);
  return {};
}

}  // namespace

Result<PixelData> check_nrrd_file(const fs::path& path) {
  if (!first_bytes(path, 7).starts_with("NRRD000")) return bad_file(path, "is not an NRRD file");
  SPLATLAS_ASSIGN_OR_RETURN(const TextHeader header, read_text_header(path, parse_nrrd_line));
  SPLATLAS_RETURN_IF_ERROR(check_nrrd_geometry(header, path));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::int64_t> sizes, parse_sizes(header.get("sizes"), path));
  const std::uint64_t bytes_per_voxel = bytes_of_nrrd_type(to_lower(header.get("type")));
  if (bytes_per_voxel == 0) return bad_pixel_type(path, "type '" + shown(header.get("type")) + "'");
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t bytes, payload_bytes(path, sizes, bytes_per_voxel));
  SPLATLAS_ASSIGN_OR_RETURN(
      PixelData pixels, find_pixels(path, header, header.get("data file", header.get("datafile")), bytes));
  pixels.is_big_endian = to_lower(header.get("endian")) == "big";
  pixels.pairs = header.pairs;
  pixels.has_no_space = is_unknown_space(space_of(header));
  pixels.misread_axes = misread_axes(space_of(header));
  SPLATLAS_RETURN_IF_ERROR(find_layers(header, sizes, path, pixels));

  const std::string encoding = to_lower(header.get("encoding"));
  std::uint64_t stored = bytes;  // at least
  bool is_text = false;
  if (encoding == "gzip" || encoding == "gz") {
    SPLATLAS_RETURN_IF_ERROR(skip_nrrd_start(header, path, pixels));
    stored = (pixels.skipped_bytes + bytes) / kMaxDeflateRatio;
  } else if (encoding == "bzip2" || encoding == "bz2") {
    pixels.compression = Compression::kBzip2;
    stored = 1;
  } else if (encoding == "hex") {
    stored = 2 * bytes;
    is_text = true;
  } else if (encoding == "ascii" || encoding == "text" || encoding == "txt") {
    stored = 2 * bytes / bytes_per_voxel - 1;  // a digit and a blank per pixel; ITK counts exactly
    is_text = true;
  } else if (encoding != "raw") {
    return bad_file(path, "has pixels in encoding '{}'; raw, gzip, bzip2, ascii and hex are read",
                    shown(encoding));
  }
  SPLATLAS_RETURN_IF_ERROR(check_raw_payload(pixels.file, pixels.start, stored, is_text ? stored : bytes));
  return pixels;
}

Result<PixelData> check_meta_image_file(const fs::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const TextHeader header, read_text_header(path, parse_meta_line));
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
  SPLATLAS_RETURN_IF_ERROR(check_meta_geometry(header, sizes.size(), path));
  std::vector<std::int64_t> numbers = sizes;
  const auto channels = parse_integer(header.get("ElementNumberOfChannels", "1"));
  if (!channels || *channels < 1)
    return bad_file(path, "has ElementNumberOfChannels = {}", shown(header.get("ElementNumberOfChannels")));
  if (*channels > 1 && sizes.size() > 3)
    return bad_file(path, "has several volumes of {} values a voxel", *channels);
  numbers.push_back(*channels);
  const std::string type = header.get("ElementType", "(none)");
  const std::uint64_t bytes_per_voxel = bytes_of_meta_type(type);
  if (bytes_per_voxel == 0) return bad_pixel_type(path, "type " + shown(type));
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t bytes, payload_bytes(path, numbers, bytes_per_voxel));
  SPLATLAS_ASSIGN_OR_RETURN(PixelData pixels,
                            find_pixels(path, header, to_lower(name) == "local" ? "" : name, bytes));
  pixels.is_big_endian = is_true(header.get("BinaryDataByteOrderMSB", header.get("ElementByteOrderMSB")));
  if (is_true(header.get("CompressedData"))) pixels.compression = Compression::kDeflate;
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
