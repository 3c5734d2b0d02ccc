// Check of NRRD files, whose headers ITK's copy of teem parses.
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <NrrdIO.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/itk/itk_call.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

struct HeaderText {
  std::string lines;                     ///< without "data file": teem opens what it names
  std::optional<std::string> data_file;  ///< of a detached header
  std::uint64_t bytes = 0;               ///< with the blank line at its end; pixels may follow
};

Result<HeaderText> read_header_text(const fs::path& path) {
  const std::string text = first_bytes(path, 1u << 20);
  if (!text.starts_with("NRRD000")) return bad_file(path, "is not an NRRD file");
  HeaderText header;
  bool has_ended = false;
  while (header.bytes < text.size() && !has_ended) {
    const std::size_t end = std::min(text.find('\n', header.bytes), text.size());
    const std::string line(trimmed(std::string_view(text).substr(header.bytes, end - header.bytes)));
    header.bytes = std::min(end + 1, text.size());
    has_ended = line.empty();
    const std::string lower = to_lower(line);
    if (!lower.starts_with("data file:") && !lower.starts_with("datafile:")) {
      header.lines += line + '\n';
      continue;
    }
    if (header.data_file) return bad_file(path, "says 'data file' twice in its header");
    header.data_file = std::string(trimmed(std::string_view(line).substr(line.find(':') + 1)));
  }
  return header;
}

/// True if all numbers of the geometry are plausible, or missing (NaN).
bool has_plausible_geometry(const Nrrd& nrrd) {
  const auto is_sound = [](double x) { return std::isnan(x) || is_plausible(x); };
  bool sound = true;
  for (unsigned a = 0; a < nrrd.dim; ++a) {
    sound = sound && is_sound(nrrd.axis[a].spacing) && !(nrrd.axis[a].spacing <= 0);
    for (unsigned row = 0; row < nrrd.spaceDim; ++row)
      sound = sound && is_sound(nrrd.axis[a].spaceDirection[row]);
  }
  for (unsigned row = 0; row < nrrd.spaceDim; ++row) sound = sound && is_sound(nrrd.spaceOrigin[row]);
  return sound;
}

/// Number and position of the layers: axes outside space, first ("none" ahead of the directions) or last.
Result<void> find_layers(const Nrrd& nrrd, const fs::path& path, PixelData& pixels) {
  const NrrdAxisInfo& first = nrrd.axis[0];
  const std::string kind = first.kind != nrrdKindUnknown ? airEnumStr(nrrdKind, first.kind) : "";
  if (to_lower(kind).find("color") != std::string::npos)
    return bad_file(path, "holds colours (kind {}); a volume of numbers is needed", kind);
  pixels.layers_first = nrrd.spaceDim > 0
                            ? std::isnan(first.spaceDirection[0])
                            : first.kind != nrrdKindUnknown && nrrdKindIsDomain(first.kind) == 0;
  if (pixels.layers_first) pixels.layers = first.size;
  for (unsigned a = 3; a < nrrd.dim && !pixels.layers_first; ++a) pixels.layers *= nrrd.axis[a].size;
  return {};
}

/// The axes x and y with a wrong sign from ITK: it turns x of LAS, not y, and nothing in spaces with time.
std::array<bool, 2> misread_axes(int space) {
  if (space == nrrdSpaceLeftAnteriorSuperior || space == nrrdSpaceRightAnteriorSuperiorTime)
    return {true, true};
  return {false, space == nrrdSpaceLeftAnteriorSuperiorTime};
}

/// Millimetres of the unit of the space, or of its axes. Nullopt for different and for unknown ones.
std::optional<double> find_unit(const Nrrd& nrrd) {
  std::set<std::string> units;
  const auto add = [&](const char* text) {
    if (text != nullptr && !trimmed(text).empty()) units.emplace(trimmed(text));
  };
  for (unsigned row = 0; row < nrrd.spaceDim; ++row) add(nrrd.spaceUnits[row]);
  for (unsigned a = 0; a < nrrd.dim && nrrd.spaceDim == 0; ++a) add(nrrd.axis[a].units);
  if (units.size() > 1) return std::nullopt;
  return units.empty() ? 1.0 : mm_of_unit(*units.begin());
}

/// The offset behind the first `lines` lines from `start` on. kFailed if there are fewer.
Result<std::uint64_t> skip_lines(const fs::path& path, std::uint64_t start, unsigned lines) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(start));
  std::string line;
  for (unsigned n = 0; n < lines; ++n) {
    if (!std::getline(file, line) || file.eof())
      return bad_file(path, "is truncated: its header skips {} lines", lines);
    start += line.size() + 1;
  }
  return start;
}

/// Applies "line skip", in the file, and "byte skip", in the decompressed bytes, to gzip. Only ITK finds
/// pixels at the end (-1).
Result<void> find_gzip(const NrrdIoState& io, PixelData& pixels) {
  if (io.byteSkip < 0) return {};
  pixels.compression = Compression::kDeflate;  // teem reads over a tenth of flipped bits
  pixels.skipped_bytes = static_cast<std::uint64_t>(io.byteSkip);
  SPLATLAS_ASSIGN_OR_RETURN(pixels.start, skip_lines(pixels.file, pixels.start, io.lineSkip));
  return {};
}

}  // namespace

Result<PixelData> check_nrrd_file(const fs::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const HeaderText header, read_header_text(path));
  const std::unique_ptr<Nrrd, Nrrd* (*)(Nrrd*)> nrrd(nrrdNew(), nrrdNuke);
  const std::unique_ptr<NrrdIoState, NrrdIoState* (*)(NrrdIoState*)> io(nrrdIoStateNew(), nrrdIoStateNix);
  io->skipData = 1;
  if (nrrdStringRead(nrrd.get(), header.lines.c_str(), io.get()) != 0) {
    const std::unique_ptr<char, decltype(&std::free)> stack(biffGetDone(NRRD), std::free);
    return bad_file(path, "{}", message_of_teem(stack.get()));
  }
  if (nrrd->dim < 2 || nrrd->dim > 5)
    return bad_file(path, "has {} dimensions; a volume has 2 or 3", nrrd->dim);
  if (!has_plausible_geometry(*nrrd))
    return bad_file(path, "has spacings, space directions or a space origin that are no geometry");
  std::vector<std::int64_t> sizes;
  for (unsigned a = 0; a < nrrd->dim; ++a) sizes.push_back(static_cast<std::int64_t>(nrrd->axis[a].size));
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t bytes,
                            payload_bytes(path, sizes, nrrdElementSize(nrrd.get())));
  PixelData pixels{.file = path, .start = header.bytes, .bytes = bytes};
  if (header.data_file) {
    SPLATLAS_ASSIGN_OR_RETURN(pixels.file, pixel_file_beside(path, *header.data_file));
    pixels.start = 0;
  }
  pixels.is_big_endian = io->endian == airEndianBig;
  pixels.has_no_space = nrrd->space == nrrdSpaceUnknown || nrrd->space >= nrrdSpaceScannerXYZ;
  pixels.misread_axes = misread_axes(nrrd->space);
  SPLATLAS_RETURN_IF_ERROR(find_layers(*nrrd, path, pixels));
  pixels.mm_per_unit = find_unit(*nrrd);
  for (std::size_t n = 0; n < nrrdKeyValueSize(nrrd.get()); ++n)
    pixels.pairs[nrrd->kvp[2 * n]] = nrrd->kvp[2 * n + 1];

  const std::string encoding = io->encoding->name;
  std::uint64_t stored = encoding == "raw" ? bytes : 1;  // at least; ITK counts the numbers of text
  if (encoding == "bzip2") pixels.compression = Compression::kBzip2;
  if (encoding == "gzip") {
    SPLATLAS_RETURN_IF_ERROR(find_gzip(*io, pixels));
    stored = (pixels.skipped_bytes + bytes) / kMaxDeflateRatio;
  }
  SPLATLAS_RETURN_IF_ERROR(check_raw_payload(pixels.file, pixels.start, stored, bytes));
  return pixels;
}

}  // namespace splatlas
