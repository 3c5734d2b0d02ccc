#include "preprocess/classify/segment_volume.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <itkBinaryBallStructuringElement.h>
#include <itkBinaryFillholeImageFilter.h>
#include <itkBinaryMorphologicalClosingImageFilter.h>
#include <itkBinaryMorphologicalOpeningImageFilter.h>
#include <itkBinaryThresholdImageFilter.h>
#include <itkConnectedComponentImageFilter.h>
#include <itkHistogram.h>
#include <itkImageRegionIteratorWithIndex.h>
#include <itkOtsuThresholdCalculator.h>
#include <itkRelabelComponentImageFilter.h>

#include "format/result_macros.h"
#include "preprocess/import/images/itk/itk_call.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

constexpr double kMaxClosingMm = 50;

using MaskImage = itk::Image<std::uint8_t, 3>;

template <typename T>
typename itk::Image<T, 3>::Pointer make_image(const Index3& size) {
  auto image = itk::Image<T, 3>::New();
  typename itk::Image<T, 3>::SizeType extent;
  for (unsigned a = 0; a < 3; ++a) extent[a] = static_cast<itk::SizeValueType>(size[a]);
  image->SetRegions(extent);
  image->Allocate();
  return image;
}

/// Converts values to Real, which represents the source type exactly. Values that are not finite become
/// lowest().
template <typename Real>
typename itk::Image<Real, 3>::Pointer real_image(const VoxelBuffer& values, const Index3& size) {
  auto image = make_image<Real>(size);
  Real* const to = image->GetBufferPointer();
  visit_voxel_type(values.type, [&]<typename T>(T) {
    const T* from = values.as<T>();
    const std::size_t count = values.bytes.size() / sizeof(T);
    for (std::size_t v = 0; v < count; ++v) {
      const auto value = static_cast<Real>(from[v]);
      to[v] = std::isfinite(value) ? value : std::numeric_limits<Real>::lowest();
    }
  });
  return image;
}

/// Otsu's threshold of the finite values, from a histogram of 256 bins.
template <typename Real>
double otsu_threshold(const itk::Image<Real, 3>& image) {
  using Histogram = itk::Statistics::Histogram<double>;
  const std::size_t count = image.GetBufferedRegion().GetNumberOfPixels();
  const Real* const values = image.GetBufferPointer();
  Real low = std::numeric_limits<Real>::max(), high = std::numeric_limits<Real>::lowest();
  for (std::size_t v = 0; v < count; ++v) {
    if (values[v] == std::numeric_limits<Real>::lowest()) continue;
    low = std::min(low, values[v]);
    high = std::max(high, values[v]);
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
  const double scale = kBins / (static_cast<double>(high) - low);
  for (std::size_t v = 0; v < count; ++v) {
    if (values[v] < low) continue;
    const auto bin = static_cast<std::size_t>((static_cast<double>(values[v]) - low) * scale);
    ++counts[std::min<std::size_t>(bin, kBins - 1)];
  }
  for (unsigned bin = 0; bin < kBins; ++bin) histogram->SetFrequency(bin, counts[bin]);
  auto calculator = itk::OtsuThresholdCalculator<Histogram, double>::New();
  calculator->SetInput(histogram);
  calculator->Update();
  return calculator->GetThreshold();
}

template <typename Real>
MaskImage::Pointer threshold(const VoxelBuffer& values, const Index3& size, const SegmentRule& rule) {
  using Image = itk::Image<Real, 3>;
  const typename Image::Pointer image = real_image<Real>(values, size);
  const double low = rule.kind == SegmentRule::Kind::kOtsu ? otsu_threshold<Real>(*image) : rule.low;
  const auto clamped = [](double value) {
    constexpr double kMax = std::numeric_limits<Real>::max();
    return static_cast<Real>(std::clamp(value, -kMax, kMax));
  };
  auto filter = itk::BinaryThresholdImageFilter<Image, MaskImage>::New();
  filter->SetInput(image);
  // Exclude lowest(), which marks values that are not finite.
  filter->SetLowerThreshold(
      std::max(clamped(low), std::nextafter(std::numeric_limits<Real>::lowest(), Real(0))));
  filter->SetUpperThreshold(clamped(rule.high));
  filter->SetInsideValue(1);
  filter->SetOutsideValue(0);
  filter->Update();
  return filter->GetOutput();
}

MaskImage::Pointer largest_component(const MaskImage& mask) {
  using Components = itk::Image<std::uint32_t, 3>;
  auto components = itk::ConnectedComponentImageFilter<MaskImage, Components>::New();
  components->SetInput(&mask);
  auto by_size = itk::RelabelComponentImageFilter<Components, Components>::New();
  by_size->SetInput(components->GetOutput());
  auto largest = itk::BinaryThresholdImageFilter<Components, MaskImage>::New();
  largest->SetInput(by_size->GetOutput());
  largest->SetLowerThreshold(1);
  largest->SetUpperThreshold(1);
  largest->SetInsideValue(1);
  largest->SetOutsideValue(0);
  largest->Update();
  return largest->GetOutput();
}

/// Fills enclosed background.
template <unsigned kDimension>
typename itk::Image<std::uint8_t, kDimension>::Pointer without_holes(
    const itk::Image<std::uint8_t, kDimension>& mask) {
  auto filter = itk::BinaryFillholeImageFilter<itk::Image<std::uint8_t, kDimension>>::New();
  filter->SetInput(&mask);
  filter->SetForegroundValue(1);
  filter->Update();
  return filter->GetOutput();
}

using Ball = itk::BinaryBallStructuringElement<std::uint8_t, 3>;

Ball make_ball(const Grid& grid, double radius_mm) {
  Ball ball;
  Ball::SizeType radius;
  for (unsigned a = 0; a < 3; ++a) {
    radius[a] = static_cast<itk::SizeValueType>(std::lround(radius_mm / grid.spacing_mm[a]));
  }
  ball.SetRadius(radius);
  ball.CreateStructuringElement();
  return ball;
}

/// Morphological closing with a ball.
MaskImage::Pointer with_gaps_closed(const MaskImage& mask, const Grid& grid, double radius_mm) {
  auto filter = itk::BinaryMorphologicalClosingImageFilter<MaskImage, MaskImage, Ball>::New();
  filter->SetInput(&mask);
  filter->SetKernel(make_ball(grid, radius_mm));
  filter->SetForegroundValue(1);
  filter->Update();
  return filter->GetOutput();
}

/// Fills the background that the mask encloses within each of the six faces of the grid. Structures may be
/// open where the scan ends, such as the skull at the neck.
void close_at_border(MaskImage& mask) {
  using Face = itk::Image<std::uint8_t, 2>;
  const auto size = mask.GetBufferedRegion().GetSize();
  for (unsigned normal = 0; normal < 3; ++normal) {
    const unsigned u = normal == 0 ? 1 : 0, v = normal == 2 ? 1 : 2;
    for (const itk::SizeValueType side : {itk::SizeValueType{0}, size[normal] - 1}) {
      auto face = Face::New();
      face->SetRegions(Face::SizeType{{size[u], size[v]}});
      face->Allocate();
      const auto in_volume = [&](const Face::IndexType& at) {
        MaskImage::IndexType index;
        index[normal] = static_cast<itk::IndexValueType>(side);
        index[u] = at[0];
        index[v] = at[1];
        return index;
      };
      itk::ImageRegionIteratorWithIndex<Face> copy(face, face->GetBufferedRegion());
      for (; !copy.IsAtEnd(); ++copy) copy.Set(mask.GetPixel(in_volume(copy.GetIndex())));
      const Face::Pointer closed = without_holes<2>(*face);
      itk::ImageRegionConstIteratorWithIndex<Face> back(closed, closed->GetBufferedRegion());
      for (; !back.IsAtEnd(); ++back) mask.SetPixel(in_volume(back.GetIndex()), back.Get());
    }
  }
}

Result<std::vector<std::uint8_t>> run_filters(const VoxelBuffer& values, const Grid& grid,
                                              const SegmentRule& rule) {
  const bool needs_double = bytes_of(values.type) > 2 && values.type != VoxelType::kFloat32;
  MaskImage::Pointer mask =
      needs_double ? threshold<double>(values, grid.size, rule) : threshold<float>(values, grid.size, rule);
  mask = largest_component(*mask);
  if (rule.close_mm > 0) mask = with_gaps_closed(*mask, grid, rule.close_mm);
  close_at_border(*mask);
  mask = without_holes<3>(*mask);
  const std::uint8_t* const first = mask->GetBufferPointer();
  std::vector<std::uint8_t> result(first, first + mask->GetBufferedRegion().GetNumberOfPixels());
  if (std::find(result.begin(), result.end(), 1) == result.end()) {
    return fail(ErrorCode::kFailed, "--segment \"{}\": no voxel of the volume is within its thresholds",
                rule.name);
  }
  return result;
}

std::vector<std::uint8_t> run_opening(const std::vector<std::uint8_t>& mask, const Grid& grid,
                                      double radius_mm) {
  const MaskImage::Pointer image = make_image<std::uint8_t>(grid.size);
  std::ranges::copy(mask, image->GetBufferPointer());
  auto filter = itk::BinaryMorphologicalOpeningImageFilter<MaskImage, MaskImage, Ball>::New();
  filter->SetInput(image);
  filter->SetKernel(make_ball(grid, radius_mm));
  filter->SetForegroundValue(1);
  filter->Update();
  const std::uint8_t* const first = filter->GetOutput()->GetBufferPointer();
  return {first, first + mask.size()};
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

Result<std::vector<std::uint8_t>> open_mask(const std::vector<std::uint8_t>& mask, const Grid& grid,
                                            const SegmentRule& rule) {
  return call_itk(fmt::format("--segment \"{}\"", rule.name), [&]() -> Result<std::vector<std::uint8_t>> {
    return run_opening(mask, grid, rule.open_mm);
  });
}

}  // namespace splatlas
