#include <algorithm>
#include <cstring>
#include <fstream>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>
#include <nlohmann/json.hpp>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/itk/itk_call.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/images/pixels/image_readers.h"
#include "preprocess/import/images/pixels/read_deflated.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

StoredType stored_type(itk::IOComponentEnum component) {
  switch (component) {
    case itk::IOComponentEnum::LONG:
    case itk::IOComponentEnum::LONGLONG: return {VoxelType::kNone, WideInteger::kSigned};
    case itk::IOComponentEnum::ULONG:
    case itk::IOComponentEnum::ULONGLONG: return {VoxelType::kNone, WideInteger::kUnsigned};
    default: return {voxel_type_of(component), WideInteger::kNone};
  }
}

/// The pixels in the order of the file. MetaIO ignores damage in compressed ones, and takes a "%" in the name
/// of a file for a pattern: ITK reads only what is neither.
Result<std::vector<std::byte>> read_pixels(itk::ImageIOBase& io, const PixelData& pixels, std::uint64_t bytes,
                                           std::size_t bytes_each) {
  std::vector<std::byte> result;
  if (pixels.is_plain) {
    result.resize(bytes);
    std::ifstream file(pixels.file, std::ios::binary);
    file.seekg(static_cast<std::streamoff>(pixels.start));
    if (!file.read(reinterpret_cast<char*>(result.data()), static_cast<std::streamsize>(bytes)))
      return bad_file(pixels.file, "cannot be read whole");
  } else if (pixels.compression == Compression::kNone) {
    result.resize(bytes);
    itk::ImageIORegion region(io.GetNumberOfDimensions());
    for (unsigned a = 0; a < io.GetNumberOfDimensions(); ++a) region.SetSize(a, io.GetDimensions(a));
    io.SetIORegion(region);
    io.Read(result.data());
    return result;
  } else {
    const auto read = pixels.compression == Compression::kDeflate ? read_deflated : read_bzip2;
    SPLATLAS_RETURN_IF_ERROR(read(pixels.file, pixels.start, pixels.skipped_bytes + bytes, result));
    result.erase(result.begin(), result.begin() + static_cast<std::ptrdiff_t>(pixels.skipped_bytes));
  }
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
  for (Vec3* lengths : {&image.grid.spacing_mm, &image.grid.origin_lps_mm}) {
    for (double& length : *lengths) length *= pixels.mm_per_unit.value_or(1);
  }
  if (!pixels.mm_per_unit) image.notes.add("unknown-unit", name);
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

/// The numbers N of the keys "SegmentN_...", in ascending order. Scripts leave gaps, and begin at 1.
std::set<std::size_t> segment_numbers(const std::map<std::string, std::string>& pairs) {
  std::set<std::size_t> numbers;
  for (const auto& [key, value] : pairs) {
    constexpr std::string_view kSegment = "Segment";
    const std::size_t end = key.find('_');
    if (!key.starts_with(kSegment) || end == std::string::npos) continue;
    const auto number = parse_number<std::size_t>(key.substr(kSegment.size(), end - kSegment.size()));
    if (number) numbers.insert(*number);
  }
  return numbers;
}

/// The segments with their colours, all of one scale. Others are noted.
std::vector<SourceSegment> colored(std::vector<SourceSegment> segments,
                                   const std::vector<std::string>& colors, Notes& notes) {
  const double scale = scale_of_colors(colors);
  for (std::size_t n = 0; n < segments.size(); ++n) {
    segments[n].structure.color = parse_table_color(colors[n], scale);
    if (!segments[n].structure.color && !colors[n].empty()) notes.add("bad-colors", in_quotes(colors[n]));
  }
  return segments;
}

/// The segments that the key/value pairs of an NRRD header name (3D Slicer's developer guide, segmentations),
/// by number. Files before Slicer 4.11 have no values and layers: the n-th segment is the value 1 of layer n.
/// Terminology entries become terms: the code of the type, and of its modifier.
std::vector<SourceSegment> segments_of_nrrd(const std::map<std::string, std::string>& pairs, Notes& notes) {
  std::vector<SourceSegment> segments;
  std::vector<std::string> colors;
  for (const std::size_t n : segment_numbers(pairs)) {
    const auto get = [&](const char* key) {
      const auto found = pairs.find(fmt::format("Segment{}_{}", n, key));
      return found == pairs.end() ? std::string() : found->second;
    };
    SourceSegment segment;
    segment.value = parse_integer(get("LabelValue")).value_or(1);
    const auto layer = get("LabelValue").empty() ? std::ssize(segments) : 0;
    segment.layer =
        static_cast<std::size_t>(std::max<std::int64_t>(parse_integer(get("Layer")).value_or(layer), 0));
    const std::string name = get("Name");
    segment.structure.name = name.empty() ? get("ID") : name;
    segment.structure.terms = terms_of(get("Tags"));
    colors.push_back(get("Color"));
    segments.push_back(std::move(segment));
  }
  return colored(std::move(segments), colors, notes);
}

/// The segments of MITK's multilabel segmentations: JSON in a pair, a list of labels a layer.
Result<std::vector<SourceSegment>> segments_of_mitk(const std::map<std::string, std::string>& pairs,
                                                    const fs::path& path, Notes& notes) try {
  std::vector<SourceSegment> segments;
  std::vector<std::string> colors;
  const auto text = pairs.find("org.mitk.multilabel.segmentation.labelgroups");
  if (text == pairs.end()) {  // before 2023, it had a pair a label
    if (pairs.contains("label_000_00001")) notes.add("unread-names", path.string());
    return segments;
  }
  std::size_t layer = 0;
  for (const auto& group : nlohmann::json::parse(text->second)) {
    for (const auto& label : group.at("labels")) {
      SourceSegment segment;
      segment.layer = layer;
      segment.value = label.at("value").get<std::int64_t>();
      segment.structure.name = label.at("name").get<std::string>();
      colors.push_back(label.contains("color") ? label["color"].at("value").dump() : "");
      segments.push_back(std::move(segment));
    }
    ++layer;
  }
  return colored(std::move(segments), colors, notes);
} catch (const nlohmann::json::exception&) {
  return bad_file(
      path, "has names of MITK (labelgroups) that cannot be read; save it as .seg.nrrd, or without them");
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
    if (pixels.has_no_space) image.notes.add("no-space", path.string());
    image.segments = segments_of_nrrd(pixels.pairs, image.notes);
    if (image.segments.empty()) {
      SPLATLAS_ASSIGN_OR_RETURN(image.segments, segments_of_mitk(pixels.pairs, path, image.notes));
    }
    image.is_segmentation = !image.segments.empty();
    for (const SourceSegment& segment : image.segments) {
      if (segment.layer < image.layers) continue;
      return bad_file(path, "puts segment '{}' into layer {}, but it has {} layers", segment.structure.name,
                      segment.layer, image.layers);
    }
    std::set<std::pair<std::size_t, std::int64_t>> values;
    std::erase_if(image.segments, [&](const SourceSegment& segment) {
      const bool is_new = values.emplace(segment.layer, segment.value).second;
      if (!is_new)
        image.notes.add("repeated-values", fmt::format("{} ({})", segment.structure.name, segment.value));
      return !is_new;
    });
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
