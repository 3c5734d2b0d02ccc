#include "preprocess/classify/segment_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <type_traits>

#include <fmt/format.h>
#include <itkBinaryImageToLabelMapFilter.h>
#include <itkHistogram.h>
#include <itkLabelMap.h>
#include <itkLabelObject.h>
#include <itkOtsuThresholdCalculator.h>

#include "format/result_macros.h"
#include "preprocess/classify/morphology.h"
#include "preprocess/import/images/itk/itk_call.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

constexpr double kMaxClosingMm = 50;

using Mask = std::vector<std::uint8_t>;

/// Otsu's threshold of the finite values, from a histogram of 256 bins.
template <typename T>
double otsu_threshold(std::span<const T> values) {
  using Histogram = itk::Statistics::Histogram<double>;
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
  for (const T voxel : values) {
    const auto value = static_cast<double>(voxel);
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (!(low < high)) return high;

  constexpr unsigned kBins = 256;
  auto histogram = Histogram::New();
  histogram->SetMeasurementVectorSize(1);
  Histogram::SizeType bins(1);
  bins[0] = kBins;
  Histogram::MeasurementVectorType first(1), last(1);
  first[0] = low;
  last[0] = high;
  histogram->Initialize(bins, first, last);
  std::array<std::uint64_t, kBins> counts{};
  const double scale = kBins / (high - low);
  for (const T voxel : values) {
    const auto value = static_cast<double>(voxel);
    if (!std::isfinite(value)) continue;
    ++counts[std::min<std::size_t>(static_cast<std::size_t>((value - low) * scale), kBins - 1)];
  }
  for (unsigned bin = 0; bin < kBins; ++bin) histogram->SetFrequency(bin, counts[bin]);
  auto calculator = itk::OtsuThresholdCalculator<Histogram, double>::New();
  calculator->SetInput(histogram);
  calculator->Update();
  return calculator->GetThreshold();
}

Mask threshold(const VoxelBuffer& values, const SegmentRule& rule) {
  Mask mask(values.bytes.size() / bytes_of(values.type));
  visit_voxel_type(values.type, [&]<typename T>(T) {
    // Thresholds are rounded to the type of the values, so that 0.7 includes the nearest float to 0.7.
    using Real = std::conditional_t<std::is_same_v<T, float> || sizeof(T) <= 2, float, double>;
    const std::span<const T> voxels(values.as<T>(), mask.size());
    const double low = rule.kind == SegmentRule::Kind::kOtsu ? otsu_threshold(voxels) : rule.low;
    constexpr double kMax = std::numeric_limits<Real>::max();
    const auto first = static_cast<Real>(std::clamp(low, -kMax, kMax));
    const auto last = static_cast<Real>(std::clamp(rule.high, -kMax, kMax));
    for (std::size_t v = 0; v < mask.size(); ++v)
      mask[v] = static_cast<Real>(voxels[v]) >= first && static_cast<Real>(voxels[v]) <= last;
  });
  return mask;
}

template <unsigned kDimension>
using MaskImage = itk::Image<std::uint8_t, kDimension>;
template <unsigned kDimension>
using Component = itk::LabelObject<std::uint32_t, kDimension>;

/// An image of the voxels of `mask`, which it does not own.
template <unsigned kDimension>
typename MaskImage<kDimension>::Pointer image_of(Mask& mask, const itk::Size<kDimension>& size) {
  auto image = MaskImage<kDimension>::New();
  image->SetRegions(size);
  image->GetPixelContainer()->SetImportPointer(mask.data(), mask.size(), false);
  return image;
}

/// The face-connected components of the voxels of `value`.
template <unsigned kDimension>
auto components_of(const MaskImage<kDimension>& image, std::uint8_t value) {
  auto filter =
      itk::BinaryImageToLabelMapFilter<MaskImage<kDimension>, itk::LabelMap<Component<kDimension>>>::New();
  filter->SetInput(&image);
  filter->SetInputForegroundValue(value);
  filter->SetOutputBackgroundValue(0);
  filter->Update();
  return filter->GetOutput()->GetLabelObjects();
}

template <unsigned kDimension>
void paint(const Component<kDimension>& component, std::uint8_t value, MaskImage<kDimension>& image) {
  for (itk::SizeValueType n = 0; n < component.GetNumberOfLines(); ++n) {
    const auto& line = component.GetLine(n);
    std::fill_n(image.GetBufferPointer() + image.ComputeOffset(line.GetIndex()), line.GetLength(), value);
  }
}

void keep_largest_component(MaskImage<3>& image) {
  const auto components = components_of(image, 1);
  std::vector<itk::SizeValueType> sizes;  // ITK counts voxels anew with every call
  for (const auto& component : components) sizes.push_back(component->Size());
  const auto largest = static_cast<std::size_t>(std::ranges::max_element(sizes) - sizes.begin());
  for (std::size_t n = 0; n < components.size(); ++n) {
    if (n != largest) paint<3>(*components[n], 0, image);
  }
}

template <unsigned kDimension>
bool is_at_border(const Component<kDimension>& component, const itk::Size<kDimension>& size) {
  for (itk::SizeValueType n = 0; n < component.GetNumberOfLines(); ++n) {
    auto first = component.GetLine(n).GetIndex(), last = first;
    last[0] += static_cast<itk::IndexValueType>(component.GetLine(n).GetLength()) - 1;
    for (unsigned a = 0; a < kDimension; ++a) {
      if (first[a] == 0 || last[a] + 1 == static_cast<itk::IndexValueType>(size[a])) return true;
    }
  }
  return false;
}

/// Fills enclosed background.
template <unsigned kDimension>
void fill_holes(MaskImage<kDimension>& image) {
  for (const auto& component : components_of(image, 0)) {
    if (!is_at_border<kDimension>(*component, image.GetBufferedRegion().GetSize()))
      paint<kDimension>(*component, 1, image);
  }
}

/// Fills the background that the mask encloses within each of the six faces of the grid. Structures may be
/// open where the scan ends, such as the skull at the neck.
void close_at_border(MaskImage<3>& image) {
  const auto size = image.GetBufferedRegion().GetSize();
  for (unsigned normal = 0; normal < 3; ++normal) {
    const unsigned u = normal == 0 ? 1 : 0, v = normal == 2 ? 1 : 2;
    const itk::Size<2> face_size{{size[u], size[v]}};
    for (const itk::SizeValueType side : {itk::SizeValueType{0}, size[normal] - 1}) {
      Mask voxels(size[u] * size[v]);
      const auto face = image_of<2>(voxels, face_size);
      const auto for_each_voxel = [&](const auto& visit) {
        itk::Index<3> at;
        at[normal] = static_cast<itk::IndexValueType>(side);
        std::size_t n = 0;
        for (at[v] = 0; at[v] < static_cast<itk::IndexValueType>(size[v]); ++at[v]) {
          for (at[u] = 0; at[u] < static_cast<itk::IndexValueType>(size[u]); ++at[u])
            visit(image.GetPixel(at), voxels[n++]);
        }
      };
      for_each_voxel([](std::uint8_t from, std::uint8_t& to) { to = from; });
      fill_holes(*face);
      for_each_voxel([](std::uint8_t& to, std::uint8_t from) { to = from; });
    }
  }
}

Index3 radii_of(const Grid& grid, double radius_mm) {
  Index3 radii;
  for (std::size_t a = 0; a < 3; ++a) radii[a] = std::lround(radius_mm / grid.spacing_mm[a]);
  return radii;
}

Result<Mask> run_filters(const VoxelBuffer& values, const Grid& grid, const SegmentRule& rule) {
  Mask mask = threshold(values, rule);
  if (std::ranges::find(mask, 1) == mask.end()) {
    return fail(ErrorCode::kFailed, "--segment \"{}\": no voxel of the volume is within its thresholds",
                rule.name);
  }
  itk::Size<3> size;
  for (unsigned a = 0; a < 3; ++a) size[a] = static_cast<itk::SizeValueType>(grid.size[a]);
  const auto image = image_of<3>(mask, size);
  keep_largest_component(*image);
  if (rule.close_mm > 0) close_mask(mask, grid.size, radii_of(grid, rule.close_mm));
  close_at_border(*image);
  fill_holes(*image);
  return mask;
}

/// Takes "name=MM" off the end of a rule. nullopt if MM is not from 0 to kMaxClosingMm.
std::optional<double> take_radius(std::string_view name, std::vector<std::string_view>& parts) {
  const auto radius = parse_number(parts.back().substr(name.size()));
  if (!radius || !(*radius >= 0 && *radius <= kMaxClosingMm)) return std::nullopt;
  parts.pop_back();
  return radius;
}

/// Parses LEVEL[,inside=STRUCTURE]. Returns false if it is not valid.
bool parse_isosurface(std::string_view text, SegmentRule& rule) {
  rule.kind = SegmentRule::Kind::kIsosurface;
  constexpr std::string_view kInside = ",inside=";
  if (const std::size_t at = text.find(kInside); at != std::string_view::npos) {
    rule.inside = std::string(trimmed(text.substr(at + kInside.size())));
    if (rule.inside.empty()) return false;
    text = text.substr(0, at);
  }
  const auto level = parse_number(trimmed(text));
  if (!level || !std::isfinite(*level)) return false;
  rule.low = *level;
  return true;
}

}  // namespace

Result<SegmentRule> parse_segment(std::string_view text) {
  const auto refuse = [&] {
    return fail(
        ErrorCode::kUsage,
        "--segment '{}': must be NAME=mask:FILE[:open=MM][:overlap], NAME=threshold:LOW[:HIGH][:close=MM] "
        "with "
        "LOW at most HIGH, NAME=threshold:otsu[:close=MM], or NAME=iso:LEVEL[,inside=STRUCTURE], with "
        "MM from 0 to {}",
        text, kMaxClosingMm);
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos) return refuse();
  SegmentRule rule;
  rule.name = std::string(trimmed(text.substr(0, equals)));
  const std::string_view kind = text.substr(equals + 1);
  if (rule.name.empty()) return refuse();
  constexpr std::string_view kMask = "mask:", kThreshold = "threshold:";
  if (kind.starts_with(kMask) && kind.size() > kMask.size()) {
    rule.kind = SegmentRule::Kind::kMask;
    std::string_view file = kind.substr(kMask.size());
    constexpr std::string_view kOpen = ":open=", kOverlap = ":overlap";
    if (file.ends_with(kOverlap) && file.size() > kOverlap.size()) {
      rule.overlaps = true;
      file.remove_suffix(kOverlap.size());
    }
    if (const std::size_t at = file.rfind(kOpen); at != std::string_view::npos) {
      std::vector<std::string_view> parts{file.substr(at)};
      const auto radius = take_radius(kOpen, parts);
      if (!radius || at == 0) return refuse();
      rule.open_mm = *radius;
      file = file.substr(0, at);
    }
    rule.mask = std::string(file);
    return rule;
  }
  if (constexpr std::string_view kIso = "iso:"; kind.starts_with(kIso)) {
    return parse_isosurface(kind.substr(kIso.size()), rule) ? Result<SegmentRule>(rule) : refuse();
  }
  if (!kind.starts_with(kThreshold)) return refuse();
  std::vector<std::string_view> parts = split(kind.substr(kThreshold.size()), ':');
  if (constexpr std::string_view kClose = "close="; parts.size() > 1 && parts.back().starts_with(kClose)) {
    const auto radius = take_radius(kClose, parts);
    if (!radius) return refuse();
    rule.close_mm = *radius;
  }
  if (parts.size() == 1 && parts[0] == "otsu") {
    rule.kind = SegmentRule::Kind::kOtsu;
    return rule;
  }
  const auto low = parse_number(parts[0]);
  const auto high = parts.size() == 2 ? parse_number(parts[1]) : std::optional(rule.high);
  if (parts.size() > 2 || !low || !high || !(*low <= *high)) return refuse();
  rule.low = *low;
  rule.high = *high;
  return rule;
}

Result<std::vector<std::uint8_t>> segment_volume(const VoxelBuffer& values, const Grid& grid,
                                                 const SegmentRule& rule) {
  return call_itk(fmt::format("--segment \"{}\"", rule.name),
                  [&] { return run_filters(values, grid, rule); });
}

std::vector<std::uint8_t> voxels_from(const VoxelBuffer& values, double level) {
  std::vector<std::uint8_t> mask(values.bytes.size() / bytes_of(values.type));
  visit_voxel_type(values.type, [&]<typename T>(T) {
    for (std::size_t v = 0; v < mask.size(); ++v) {
      const auto value = static_cast<double>(values.as<T>()[v]);
      mask[v] = std::isfinite(value) && value >= level;
    }
  });
  return mask;
}

Result<void> open_mask(std::vector<std::uint8_t>& mask, const Grid& grid, const SegmentRule& rule) {
  return call_itk(fmt::format("--segment \"{}\"", rule.name), [&]() -> Result<void> {
    open_mask(mask, grid.size, radii_of(grid, rule.open_mm));
    return {};
  });
}

}  // namespace splatlas
