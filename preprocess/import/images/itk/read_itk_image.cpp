#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>

#include "format/result_macros.h"
#include "preprocess/import/images/itk/itk_call.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/images/pixels/image_readers.h"
#include "preprocess/import/images/pixels/read_deflated.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

const NoteKind kNoSpace{"no-space", "NRRD file names no anatomical space and is read as LPS",
                        "NRRD files name no anatomical space and are read as LPS", true};

StoredType stored_type(itk::IOComponentEnum component) {
  switch (component) {
    case itk::IOComponentEnum::LONG:
    case itk::IOComponentEnum::LONGLONG: return {VoxelType::kNone, WideInteger::kSigned};
    case itk::IOComponentEnum::ULONG:
    case itk::IOComponentEnum::ULONGLONG: return {VoxelType::kNone, WideInteger::kUnsigned};
    default: return {voxel_type_of(component), WideInteger::kNone};
  }
}

/// The pixels in the order of the file. MetaIO ignores damage in compressed ones: ITK reads only plain ones.
Result<std::vector<std::byte>> read_pixels(itk::ImageIOBase& io, const PixelData& pixels, std::uint64_t bytes,
                                           std::size_t bytes_each) {
  std::vector<std::byte> result;
  if (pixels.compression == Compression::kNone) {
    result.resize(bytes);
    itk::ImageIORegion region(io.GetNumberOfDimensions());
    for (unsigned a = 0; a < io.GetNumberOfDimensions(); ++a) region.SetSize(a, io.GetDimensions(a));
    io.SetIORegion(region);
    io.Read(result.data());
    return result;
  }
  const auto read = pixels.compression == Compression::kDeflate ? read_deflated : read_bzip2;
  SPLATLAS_RETURN_IF_ERROR(read(pixels.file, pixels.start, pixels.skipped_bytes + bytes, result));
  result.erase(result.begin(), result.begin() + static_cast<std::ptrdiff_t>(pixels.skipped_bytes));
  if (pixels.is_big_endian) swap_bytes(result, bytes_each);
  return result;
}

/// Layer after layer, from pixels whose layers stand together.
std::vector<std::byte> separate_layers(const std::vector<std::byte>& mixed, std::size_t layers,
                                       std::size_t bytes_each) {
  std::vector<std::byte> result(mixed.size());
  const std::size_t voxels = mixed.size() / (layers * bytes_each);
  for (std::size_t v = 0; v < voxels; ++v) {
    for (std::size_t layer = 0; layer < layers; ++layer)
      std::memcpy(&result[(layer * voxels + v) * bytes_each], &mixed[(v * layers + layer) * bytes_each],
                  bytes_each);
  }
  return result;
}

Result<SourceImage> read_with(itk::ImageIOBase& io, const fs::path& path, const PixelData& pixels) {
  const std::string name = path.string();
  if (!io.CanReadFile(name.c_str())) return bad_file(path, "is not of the type that its ending says");
  io.SetFileName(name);
  io.ReadImageInformation();
  SourceImage image;
  image.grid = grid_of(io);
  SPLATLAS_RETURN_IF_ERROR(validate(image.grid, name));
  const StoredType type = stored_type(io.GetComponentType());
  if (type == StoredType())
    return bad_pixel_type(path, "type " + itk::ImageIOBase::GetComponentTypeAsString(io.GetComponentType()));
  image.layers = pixels.layers;
  const std::size_t bytes_each = type.bytes();
  const std::uint64_t bytes = static_cast<std::uint64_t>(image.grid.voxels()) * image.layers * bytes_each;
  if (pixels.bytes != bytes)
    return bad_file(path, "has {} bytes of pixels by its header, {} by ITK's reading", pixels.bytes, bytes);
  SPLATLAS_ASSIGN_OR_RETURN(std::vector<std::byte> read, read_pixels(io, pixels, bytes, bytes_each));
  // ITK moves the layers of NRRD files to the front.
  const bool are_mixed =
      pixels.layers_first || (pixels.compression == Compression::kNone && io.GetNumberOfComponents() > 1);
  if (are_mixed && image.layers > 1) read = separate_layers(read, image.layers, bytes_each);
  SPLATLAS_ASSIGN_OR_RETURN(image.voxels, voxels_of(std::move(read), type, path));
  return image;
}

/// Three numbers from 0 to 1.
std::optional<Rgb> color_of(const std::string& text) {
  const std::vector<std::string_view> parts = split_blanks(text);
  if (parts.size() != 3) return std::nullopt;
  std::array<std::uint8_t, 3> rgb{};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto value = parse_number(parts[n]);
    if (!value || !(*value >= 0 && *value <= 1)) return std::nullopt;
    rgb[n] = static_cast<std::uint8_t>(std::lround(255 * *value));
  }
  return Rgb{rgb[0], rgb[1], rgb[2]};
}

/// A code "scheme^value^meaning"; nothing if it is empty.
void add_code(std::string_view code, const char* prefix, std::vector<Term>& terms) {
  const std::vector<std::string_view> parts = split(code, '^');
  if (parts.size() != 3 || parts[0].empty() || parts[1].empty()) return;
  terms.push_back({prefix + vocabulary_of(parts[0]), std::string(parts[1])});
}

/// Terms of "TerminologyEntry:context~category~type~modifier~...|key:value|...".
std::vector<Term> terms_of(const std::string& tags) {
  std::vector<Term> terms;
  constexpr std::string_view kEntry = "TerminologyEntry:";
  for (const std::string_view tag : split(tags, '|')) {
    if (!tag.starts_with(kEntry)) continue;
    const std::vector<std::string_view> parts = split(tag.substr(kEntry.size()), '~');
    if (parts.size() > 2) add_code(parts[2], "", terms);
    if (parts.size() > 3) add_code(parts[3], "modifier ", terms);
  }
  return terms;
}

/// The segments that the key/value pairs of an NRRD header name (3D Slicer's developer guide, segmentations),
/// by number. Files before Slicer 4.11 have no values and layers: segment N is the value 1 of layer N.
/// Terminology entries become terms: the code of the type, and of its modifier.
std::vector<SourceSegment> segments_of_nrrd(const std::map<std::string, std::string>& pairs) {
  std::vector<SourceSegment> segments;
  for (std::size_t n = 0; pairs.contains(fmt::format("Segment{}_ID", n)); ++n) {
    const auto get = [&](const char* key) {
      const auto found = pairs.find(fmt::format("Segment{}_{}", n, key));
      return found == pairs.end() ? std::string() : found->second;
    };
    SourceSegment segment;
    segment.value = parse_integer(get("LabelValue")).value_or(1);
    segment.layer = static_cast<std::size_t>(std::max<std::int64_t>(
        parse_integer(get("Layer")).value_or(get("LabelValue").empty() ? static_cast<std::int64_t>(n) : 0),
        0));
    const std::string name = get("Name");
    segment.structure.name = name.empty() ? get("ID") : name;
    segment.structure.color = color_of(get("Color"));
    segment.structure.terms = terms_of(get("Tags"));
    segments.push_back(std::move(segment));
  }
  return segments;
}

}  // namespace

Result<SourceImage> read_nrrd(const fs::path& path, const ImageOptions& /*options*/) {
  return call_itk(path.string(), [&]() -> Result<SourceImage> {
    SPLATLAS_ASSIGN_OR_RETURN(const PixelData pixels, check_nrrd_file(path));
    SPLATLAS_ASSIGN_OR_RETURN(SourceImage image, read_with(*itk::NrrdImageIO::New(), path, pixels));
    for (std::size_t row = 0; row < 2; ++row) {
      if (!pixels.misread_axes[row]) continue;
      image.grid.origin_lps_mm[row] *= -1;
      for (std::size_t a = 0; a < 3; ++a) image.grid.direction_lps[3 * row + a] *= -1;
    }
    if (pixels.has_no_space) image.notes.add(kNoSpace, path.string());
    image.segments = segments_of_nrrd(pixels.pairs);
    image.is_segmentation = !image.segments.empty();
    for (const SourceSegment& segment : image.segments) {
      if (segment.layer < image.layers) continue;
      return bad_file(path, "puts segment '{}' into layer {}, but it has {} layers", segment.structure.name,
                      segment.layer, image.layers);
    }
    return image;
  });
}

Result<SourceImage> read_meta_image(const fs::path& path, const ImageOptions& /*options*/) {
  return call_itk(path.string(), [&]() -> Result<SourceImage> {
    SPLATLAS_ASSIGN_OR_RETURN(const PixelData pixels, check_meta_image_file(path));
    return read_with(*itk::MetaImageIO::New(), path, pixels);
  });
}

}  // namespace splatlas
