#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/nifti/nifti_header.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/images/pixels/image_readers.h"
#include "preprocess/import/images/pixels/read_deflated.h"
#include "preprocess/import/quiet_vtk.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// The labels of a LabelTable (Caret's XML, as TotalSegmentator and Mango write it) in the bytes between
/// header and voxels; none if there is no such table. Their colours are dropped: TotalSegmentator repeats a
/// cycle of twelve. Only numbers and names are kept: other parts of the XML may hold names of patients.
std::vector<SourceSegment> labels_of_extensions(std::string_view extensions) {
  std::vector<SourceSegment> labels;
  constexpr std::string_view kEnd = "</LabelTable>";
  const std::size_t first = extensions.find("<LabelTable"), end = extensions.find(kEnd, first);
  if (end == std::string_view::npos) return labels;
  const auto table = parse_xml(std::string(extensions.substr(first, end + kEnd.size() - first)));
  for (int n = 0; table != nullptr && n < table->GetNumberOfNestedElements(); ++n) {
    vtkXMLDataElement* const label = table->GetNestedElement(n);
    SourceSegment segment;
    segment.value = parse_integer(attribute(*label, "Key")).value_or(0);
    segment.structure.name = text_of(label);
    if (segment.value > 0 && !segment.structure.name.empty()) labels.push_back(std::move(segment));
  }
  return labels;
}

struct FilePair {
  fs::path header, voxels;
};

/// Header and voxels of a pair stand side by side, with equal names.
FilePair files_of(const fs::path& path) {
  const std::string name = to_lower(path.filename().string());
  fs::path stem = path;
  if (name.ends_with(".gz")) stem.replace_extension();
  const std::string ending = to_lower(stem.extension().string());
  if (ending != ".hdr" && ending != ".img") return {path, path};
  const auto beside = [&](const char* other) {
    for (const std::string& suffix : {std::string(other), std::string(other) + ".gz"}) {
      fs::path candidate = stem;
      candidate.replace_extension(suffix);
      std::error_code error;
      if (fs::exists(candidate, error)) return candidate;
    }
    return fs::path(stem).replace_extension(other);
  };
  if (ending == ".hdr") return {path, beside(".img")};
  return {beside(".hdr"), path};
}

Result<StoredType> stored_type(const NiftiHeader& header, const fs::path& path) {
  const auto known = std::ranges::find(kNiftiTypes, header.datatype) - kNiftiTypes.begin();
  if (known > 0 && known < std::ssize(kNiftiTypes)) return StoredType{static_cast<VoxelType>(known)};
  switch (header.datatype) {
    case 1024: return StoredType{VoxelType::kNone, WideInteger::kSigned};
    case 1280: return StoredType{VoxelType::kNone, WideInteger::kUnsigned};
    case 128:
    case 2304:
      return bad_file(
          path, "holds colours (NIfTI type {}){}; a volume of numbers is needed", header.datatype,
          header.datatype == 2304 ? ", perhaps NiiVue's PAQD, whose first channel has labels" : "");
    default: return bad_pixel_type(path, fmt::format("NIfTI type {}", header.datatype));
  }
}

template <typename Scaled>
VoxelBuffer scaled(const VoxelBuffer& voxels, VoxelType type, double slope, double intercept) {
  const std::size_t count = voxels.bytes.size() / bytes_of(voxels.type);
  VoxelBuffer result{type, std::vector<std::byte>(count * sizeof(Scaled))};
  visit_voxel_type(voxels.type, [&]<typename T>(T) {
    for (std::size_t v = 0; v < count; ++v)
      result.as<Scaled>()[v] =
          static_cast<Scaled>(static_cast<double>(voxels.as<T>()[v]) * slope + intercept);
  });
  return result;
}

/// A slope of 0, or one that is no number, stands for unscaled values.
VoxelBuffer with_scale(VoxelBuffer voxels, double slope, double intercept) {
  const bool is_identity = !(slope < 1 || slope > 1) && !(intercept < 0 || intercept > 0);
  if (is_identity || !(slope < 0 || slope > 0)) return voxels;
  return voxels.type == VoxelType::kFloat64 ? scaled<double>(voxels, VoxelType::kFloat64, slope, intercept)
                                            : scaled<float>(voxels, VoxelType::kFloat32, slope, intercept);
}

/// Reads the parts of a file or a pair in their order.
class NiftiReader {
 public:
  explicit NiftiReader(const fs::path& path) : path_(path), files_(files_of(path)) {}

  Result<SourceImage> read() {
    SPLATLAS_RETURN_IF_ERROR(read_header());
    SPLATLAS_ASSIGN_OR_RETURN(image_.grid, nifti_grid(header_, path_, image_.notes));
    SPLATLAS_RETURN_IF_ERROR(measure());
    SPLATLAS_RETURN_IF_ERROR(read_extensions());
    SPLATLAS_RETURN_IF_ERROR(read_voxels());
    return std::move(image_);
  }

 private:
  Result<void> read_header() {
    SPLATLAS_ASSIGN_OR_RETURN(file_, GzipFile::open(files_.header));
    std::vector<std::byte> head(NiftiHeader::kMaxBytes);
    SPLATLAS_ASSIGN_OR_RETURN(const std::size_t found, file_.read_some(head));
    head.resize(found);
    if (found > 1 && head[0] == std::byte{0x1f} && head[1] == std::byte{0x8b})
      return bad_file(path_, "is compressed twice; gunzip it once");
    SPLATLAS_ASSIGN_OR_RETURN(header_, parse_nifti_header(head, files_.header));
    if (header_.is_pair != (files_.header != files_.voxels)) {
      return bad_file(path_, "{}",
                      header_.is_pair ? "is the header of a pair; name it .hdr, beside its .img"
                                      : "holds header and voxels in one; name it .nii");
    }
    if (!std::isfinite(header_.slope)) header_.slope = 0;
    if ((header_.slope < 0 || header_.slope > 0) && !std::isfinite(header_.intercept))
      return bad_file(path_, "has a value offset (scl_inter) that is not a number");
    if (header_.is_pair) {
      SPLATLAS_ASSIGN_OR_RETURN(file_, GzipFile::open(files_.voxels));
      header_.voxel_offset = std::max(header_.voxel_offset, 0.0);
    }
    return {};
  }

  /// Checks sizes and type, and that the file can hold them.
  Result<void> measure() {
    std::vector<std::int64_t> sizes;
    for (std::size_t n = 1; n <= static_cast<std::size_t>(header_.dim[0]); ++n) {
      // Trailing sizes of 0 stand for 1.
      sizes.push_back(n > 3 ? std::max<std::int64_t>(header_.dim[n], 1) : header_.dim[n]);
      if (n > 3)
        image_.layers *= static_cast<std::size_t>(std::min<std::int64_t>(sizes.back(), kMaxAxisSize));
      if (image_.layers > static_cast<std::size_t>(kMaxVoxels))
        return bad_file(path_, "has {} volumes", image_.layers);
    }
    SPLATLAS_ASSIGN_OR_RETURN(type_, stored_type(header_, path_));
    if (const auto bits = static_cast<std::int64_t>(8 * type_.bytes()); header_.bits_per_voxel != bits) {
      return bad_file(path_, "contradicts itself: {} bits a voxel, but its type has {}",
                      header_.bits_per_voxel, bits);
    }
    SPLATLAS_ASSIGN_OR_RETURN(voxel_bytes_, payload_bytes(path_, sizes, type_.bytes()));
    const double least = header_.is_pair ? 0 : static_cast<double>(header_.bytes());
    constexpr double kMostOffset = 1 << 30;
    if (!(header_.voxel_offset >= least && header_.voxel_offset <= kMostOffset))
      return bad_file(path_, "puts its pixels at byte {}, which cannot be", header_.voxel_offset);
    const auto offset = static_cast<std::uint64_t>(header_.voxel_offset);
    if (!file_.is_compressed()) return check_raw_payload(files_.voxels, offset, voxel_bytes_, voxel_bytes_);
    return check_raw_payload(files_.voxels, 0, (offset + voxel_bytes_) / kMaxDeflateRatio, voxel_bytes_);
  }

  /// Names of labels stand between header and voxels.
  Result<void> read_extensions() {
    constexpr double kMostBytes = 16 << 20;
    const double first = static_cast<double>(header_.bytes());
    if (header_.is_pair || header_.voxel_offset <= first + 4) return {};
    const double count = std::min(header_.voxel_offset - first, kMostBytes);
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> bytes,
                              file_.read(header_.bytes(), static_cast<std::uint64_t>(count)));
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    image_.segments = labels_of_extensions(text);
    const auto has = [text](std::string_view table) { return text.find(table) != std::string_view::npos; };
    if (image_.segments.empty() && (has("<LabelTable") || has("VALUE_LABEL_DTABLE")))
      image_.notes.add("unread-names", path_.string());
    return {};
  }

  Result<void> read_voxels() {
    SPLATLAS_ASSIGN_OR_RETURN(std::vector<std::byte> bytes,
                              file_.read(static_cast<std::uint64_t>(header_.voxel_offset), voxel_bytes_));
    SPLATLAS_RETURN_IF_ERROR(file_.check_end());
    if (header_.is_swapped) swap_bytes(bytes, type_.bytes());
    SPLATLAS_ASSIGN_OR_RETURN(VoxelBuffer voxels, voxels_of(std::move(bytes), type_, path_));
    image_.voxels = with_scale(std::move(voxels), header_.slope, header_.intercept);
    return {};
  }

  fs::path path_;
  FilePair files_;
  GzipFile file_;
  NiftiHeader header_;
  StoredType type_;
  std::uint64_t voxel_bytes_ = 0;
  SourceImage image_;
};

}  // namespace

fs::path other_of_pair(const fs::path& path) {
  const FilePair files = files_of(path);
  return files.header == path ? files.voxels : files.header;
}

Result<SourceImage> read_nifti(const fs::path& path, const ImageOptions& /*options*/) {
  return NiftiReader(path).read();
}

}  // namespace splatlas
