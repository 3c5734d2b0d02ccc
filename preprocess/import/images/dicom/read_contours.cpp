#include <algorithm>
#include <cmath>
#include <map>

#include "format/result_macros.h"
#include "preprocess/import/images/dicom/dicom_item.h"
#include "preprocess/import/images/dicom/read_segmentation.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

using Contour = std::vector<Vec3>;

/// A structure of the file, with its contours in LPS mm.
struct Region {
  std::int64_t number = 0;
  std::vector<Contour> contours;  ///< closed ones
  bool has_open = false;          ///< points or open contours
};

/// The points of a contour; none if they are no triples of numbers.
Contour points_in(DcmItem& item) {
  DcmElement* element = nullptr;
  OFVector<Float64> numbers;
  if (item.findAndGetElement(DCM_ContourData, element).bad()) return {};
  auto* const text = dynamic_cast<DcmDecimalString*>(element);
  if (text == nullptr || text->getFloat64Vector(numbers).bad() || numbers.size() % 3 != 0) return {};
  Contour contour(numbers.size() / 3);
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    if (!is_plausible(numbers[n])) return {};
    contour[n / 3][n % 3] = numbers[n];
  }
  return contour;
}

Result<void> read_contours_of(DcmItem& item, const std::filesystem::path& path, Region& region,
                              SourceStructure& structure, Notes& notes) {
  if (const auto rgb = numbers_in<3>(item, DCM_ROIDisplayColor)) {
    const auto channel = [](double c) { return static_cast<std::uint8_t>(std::clamp(c, 0.0, 255.0)); };
    structure.color = Rgb{channel((*rgb)[0]), channel((*rgb)[1]), channel((*rgb)[2])};
  }
  for (DcmItem* const one : items_in(item, DCM_ContourSequence)) {
    if (!text_in(*one, DCM_ContourGeometricType).starts_with("CLOSED")) {
      region.has_open = true;
    } else if (region.contours.push_back(points_in(*one)); region.contours.back().empty()) {
      return bad_file(path, "has a contour of {} without points (ContourData); get it again", structure.name);
    }
  }
  if (region.has_open) notes.add(region.contours.empty() ? "only-points" : "open-contours", structure.name);
  return {};
}

/// The regions, and the image's segments without voxels: number n is that of region n - 1.
Result<std::vector<Region>> read_regions(const std::filesystem::path& path, SourceImage& image) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto format, open_dicom(path, DicomPart::kHeader));
  DcmDataset& dataset = *format->getDataset();
  static_cast<void>(dataset.convertToUTF8());  // names that are no UTF-8 afterwards are replaced
  std::vector<Region> regions;
  for (DcmItem* const item : items_in(dataset, DCM_StructureSetROISequence)) {
    regions.push_back({.number = integer_in(*item, DCM_ROINumber).value_or(-1), .contours = {}});
    image.segments.push_back(named_segment(text_in(*item, DCM_ROIName), std::ssize(regions), image.notes));
  }
  if (regions.empty() || regions.size() > 65535)
    return bad_file(path, "names {} structures; it must be 1 to 65535", regions.size());
  for (DcmItem* const item : items_in(dataset, DCM_ROIContourSequence)) {
    const std::int64_t number = integer_in(*item, DCM_ReferencedROINumber).value_or(-1);
    const auto region = std::ranges::find(regions, number, &Region::number);
    if (region == regions.end())
      return bad_file(path, "has contours of structure {}, which is not in its list", number);
    SourceSegment& segment = image.segments[static_cast<std::size_t>(region - regions.begin())];
    SPLATLAS_RETURN_IF_ERROR(read_contours_of(*item, path, *region, segment.structure, image.notes));
  }
  return regions;
}

/// The indices of a range of voxel centres: from `low` to below `high`.
std::pair<std::size_t, std::size_t> indices_in(double low, double high, std::int64_t size) {
  const auto index = [&](double x) {
    return static_cast<std::size_t>(std::clamp(std::ceil(x), 0.0, static_cast<double>(size)));
  };
  return {index(low), index(high)};
}

/// The voxels of a slice within an odd number of contours, whose points are indices.
std::vector<bool> filled(const std::vector<Contour>& contours, const Grid& grid) {
  const auto columns = static_cast<std::size_t>(grid.size[0]), rows = static_cast<std::size_t>(grid.size[1]);
  std::vector<std::vector<double>> crossings(rows);
  for (const Contour& contour : contours) {
    for (std::size_t n = 0; n < contour.size(); ++n) {
      const Vec3 &a = contour[n], &b = contour[(n + 1) % contour.size()];
      const auto [first, last] = indices_in(std::min(a[1], b[1]), std::max(a[1], b[1]), grid.size[1]);
      for (std::size_t j = first; j < last; ++j)
        crossings[j].push_back(a[0] + (static_cast<double>(j) - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
    }
  }
  std::vector<bool> voxels(columns * rows);
  for (std::size_t j = 0; j < rows; ++j) {
    std::ranges::sort(crossings[j]);
    for (std::size_t n = 0; n + 1 < crossings[j].size(); n += 2) {
      const auto [first, last] = indices_in(crossings[j][n], crossings[j][n + 1], grid.size[0]);
      std::fill(voxels.begin() + static_cast<std::ptrdiff_t>(j * columns + first),
                voxels.begin() + static_cast<std::ptrdiff_t>(j * columns + last), true);
    }
  }
  return voxels;
}

/// Contours by their place along k, in indices.
using Planes = std::map<double, std::vector<Contour>>;

Result<Planes> planes_of(const Region& region, const Grid& grid, const std::filesystem::path& path,
                         bool& is_cut) {
  constexpr double kDigits = 1e6, kPlaceDigits = 100;  // straight edges stay straight, and planes together
  constexpr double kHalf = 0.501;
  const Affine to_index = lps_mm_to_index(grid);
  Planes planes;
  for (Contour contour : region.contours) {
    for (Vec3& point : contour) {
      point = to_index.apply(point);
      for (std::size_t a = 0; a < 3; ++a) {
        point[a] = std::round(point[a] * kDigits) / kDigits;
        is_cut = is_cut || point[a] < -kHalf || point[a] > static_cast<double>(grid.size[a] - 1) + kHalf;
      }
    }
    const auto [low, high] = std::ranges::minmax(contour, {}, [](const Vec3& point) { return point[2]; });
    if (high[2] - low[2] > 1.0 / 2)
      return bad_file(path, "has contours across slices; give the --volume of their slices");
    planes[std::round((low[2] + high[2]) / 2 * kPlaceDigits) / kPlaceDigits].push_back(std::move(contour));
  }
  return planes;
}

/// A plane reaches halfway to the next one. Where planes are missing, at twice the least step, it reaches as
/// far as at the ends: half a step, at least half a slice.
std::vector<SliceMask> masks_of(const Planes& planes, const Grid& grid) {
  constexpr double kMissing = 1.9;
  double step = static_cast<double>(grid.size[2]);
  for (auto plane = planes.begin(); plane != planes.end() && std::next(plane) != planes.end(); ++plane)
    step = std::min(step, std::next(plane)->first - plane->first);
  step = planes.size() > 1 ? std::max(step, 1.0) : 1;
  std::vector<SliceMask> masks;
  double reach = step / 2;
  for (auto plane = planes.begin(); plane != planes.end(); ++plane) {
    const double low = plane->first - reach;
    const double gap = std::next(plane) == planes.end() ? step : std::next(plane)->first - plane->first;
    reach = (gap < kMissing * step ? gap : step) / 2;
    const auto [first, last] = indices_in(low, plane->first + reach, grid.size[2]);
    if (first == last) continue;
    const std::vector<bool> voxels = filled(plane->second, grid);
    for (std::size_t k = first; k < last; ++k) masks.push_back({k, voxels});
  }
  return masks;
}

}  // namespace

Result<SourceImage> read_contours(const std::filesystem::path& path, const std::optional<Grid>& grid) {
  if (!grid)
    return bad_file(path,
                    "holds contours without a grid; give their series as --volume, or the folder of both");
  SourceImage image;
  image.is_segmentation = true;
  image.grid = *grid;
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Region> regions, read_regions(path, image));
  // Told by their note. An isocentre is a point.
  std::erase_if(image.segments, [&](const SourceSegment& segment) {
    const Region& region = regions[static_cast<std::size_t>(segment.value - 1)];
    return region.has_open && region.contours.empty();
  });
  MaskLayers<std::uint16_t> layers(image.grid);
  for (SourceSegment& segment : image.segments) {
    const Region& region = regions[static_cast<std::size_t>(segment.value - 1)];
    bool is_cut = false;
    SPLATLAS_ASSIGN_OR_RETURN(const Planes planes, planes_of(region, image.grid, path, is_cut));
    if (is_cut) image.notes.add("contours-outside", segment.structure.name);
    segment.layer = layers.add(masks_of(planes, image.grid), static_cast<std::uint16_t>(segment.value));
  }
  layers.hand_over(image);
  return image;
}

}  // namespace splatlas
