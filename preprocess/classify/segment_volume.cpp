#include "preprocess/classify/segment_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <type_traits>

#include <fmt/format.h>
#include <itkBinaryImageToLabelMapFilter.h>
#include <itkHistogram.h>
#include <itkLabelMap.h>
#include <itkLabelObject.h>
#include <itkOtsuThresholdCalculator.h>

#include "format/result_macros.h"
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

/// True for a component with a voxel at an end of the first `axes` axes.
template <unsigned kDimension>
bool is_at_border(const Component<kDimension>& component, const itk::Size<kDimension>& size, unsigned axes) {
  for (itk::SizeValueType n = 0; n < component.GetNumberOfLines(); ++n) {
    auto first = component.GetLine(n).GetIndex(), last = first;
    last[0] += static_cast<itk::IndexValueType>(component.GetLine(n).GetLength()) - 1;
    for (unsigned a = 0; a < axes; ++a) {
      if (first[a] == 0 || last[a] + 1 == static_cast<itk::IndexValueType>(size[a])) return true;
    }
  }
  return false;
}

void keep_pieces(const SegmentRule& rule, const Grid& grid, MaskImage<3>& image) {
  auto components = components_of(image, 1);
  itk::Index<3> seed{};
  if (rule.seed_lps_mm) {
    const Vec3 at = lps_mm_to_index(grid).apply(*rule.seed_lps_mm);
    for (unsigned a = 0; a < 3; ++a) seed[a] = std::lround(at[a]);
  }
  std::vector<std::pair<itk::SizeValueType, std::size_t>> kept;  // ITK counts voxels anew with every call
  for (std::size_t n = 0; n < components.size(); ++n) {
    const bool is_outer =
        rule.inner && is_at_border<3>(*components[n], image.GetBufferedRegion().GetSize(), 2);
    const bool has_seed = !rule.seed_lps_mm || components[n]->HasIndex(seed);
    if (!is_outer && has_seed) kept.emplace_back(components[n]->Size(), n);
  }
  std::ranges::stable_sort(kept, std::greater{}, [](const auto& piece) { return piece.first; });
  kept.resize(std::min(kept.size(), rule.pieces));
  std::ranges::fill_n(image.GetBufferPointer(), static_cast<std::ptrdiff_t>(grid.voxels()), std::uint8_t{0});
  for (const auto& [size, n] : kept) paint<3>(*components[n], 1, image);
}

/// Fills enclosed background.
template <unsigned kDimension>
void fill_holes(MaskImage<kDimension>& image) {
  for (const auto& component : components_of(image, 0)) {
    if (!is_at_border<kDimension>(*component, image.GetBufferedRegion().GetSize(), kDimension))
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

Result<void> run_filters(Mask& mask, const Grid& grid, const SegmentRule& rule) {
  const auto check_some = [&](const char* what) -> Result<void> {
    if (std::ranges::find(mask, 1) != mask.end()) return {};
    return fail(ErrorCode::kFailed, "--segment \"{}\": no {}", rule.name, what);
  };
  const bool is_mask = rule.kind == SegmentRule::Kind::kMask;
  if (!is_mask) SPLATLAS_RETURN_IF_ERROR(check_some("voxel of the volume is within its thresholds"));
  if (rule.open_mm > 0) open_mask(mask, grid.size, radii_of(grid, rule.open_mm));
  if (is_mask) return {};
  itk::Size<3> size;
  for (unsigned a = 0; a < 3; ++a) size[a] = static_cast<itk::SizeValueType>(grid.size[a]);
  const auto image = image_of<3>(mask, size);
  keep_pieces(rule, grid, *image);
  SPLATLAS_RETURN_IF_ERROR(check_some("piece fits its open, inner and seed"));
  if (rule.close_mm > 0) close_mask(mask, grid.size, radii_of(grid, rule.close_mm));
  if (!rule.fills) return {};
  close_at_border(*image);
  fill_holes(*image);
  return {};
}

/// Sets an option of a rule. Nullopt for a word that is none; false for a value that it cannot have.
std::optional<bool> set_option(std::string_view word, SegmentRule& rule) {
  const std::string_view name = word.substr(0, word.find('='));
  const std::string_view value = word.substr(std::min(name.size() + 1, word.size()));
  const auto number = parse_number(value);
  const auto set = [](auto& to, const auto& from) { return from ? (to = *from, true) : false; };
  const bool is_radius = number && *number >= 0 && *number <= kMaxClosingMm;
  if (name == "open") return is_radius && set(rule.open_mm, number);
  if (name == "close") return is_radius && set(rule.close_mm, number);
  if (name == "pieces") {
    const auto pieces = parse_integer(value);
    return pieces && *pieces > 0 && set(rule.pieces, pieces);
  }
  if (name == "seed") return set(rule.seed_lps_mm, parse_numbers<3>(value));
  if (name == "within") return set(rule.within, std::optional(trimmed(value))) && !rule.within.empty();
  if (name == "color") {
    const auto color = parse_color(value);
    return color && set(rule.color, color);
  }
  if (word == "fill=no") return !(rule.fills = false);
  if (word == "inner") return rule.inner = true;
  if (word == "overlap") return rule.overlaps = true;
  return std::nullopt;
}

/// Reads what stands between the kind of a rule and its options.
bool set_kind(std::string_view kind, SegmentRule& rule) {
  const std::string_view word = kind.substr(0, kind.find(':'));
  const std::string_view value = kind.substr(std::min(word.size() + 1, kind.size()));
  if (word == "mask") {
    rule.kind = SegmentRule::Kind::kMask;
    rule.mask = std::string(value);
    return !value.empty();
  }
  const bool is_isosurface = word == "iso";
  if (!is_isosurface && word != "threshold") return false;
  if (is_isosurface) rule.kind = SegmentRule::Kind::kIsosurface;
  if (value == "otsu" && !is_isosurface) {
    rule.kind = SegmentRule::Kind::kOtsu;
    return true;
  }
  const std::vector<std::string_view> parts = split(value, ':');
  const auto low = parse_number(parts[0]);
  const auto high = parts.size() == 2 ? parse_number(parts[1]) : std::optional(rule.high);
  if (parts.size() > (is_isosurface ? 1u : 2u) || !low || !high || !(*low <= *high)) return false;
  rule.low = *low;
  rule.high = *high;
  return !is_isosurface || std::isfinite(rule.low);
}

}  // namespace

Result<SegmentRule> parse_segment(std::string_view text) {
  SegmentRule rule;
  const std::size_t equals = std::min(text.find('='), text.size());
  rule.name = std::string(trimmed(text.substr(0, equals)));
  std::string_view kind = text.substr(std::min(equals + 1, text.size()));
  bool is_valid = !rule.name.empty();
  for (std::size_t colon = kind.rfind(':'); colon != std::string_view::npos; colon = kind.rfind(':')) {
    const std::optional<bool> option = set_option(kind.substr(colon + 1), rule);
    if (!option) break;
    is_valid = is_valid && *option;
    kind = kind.substr(0, colon);
  }
  is_valid = is_valid && set_kind(kind, rule);
  const bool is_iso = rule.kind == SegmentRule::Kind::kIsosurface,
             is_mask = rule.kind == SegmentRule::Kind::kMask;
  const bool refines = rule.close_mm > 0 || rule.pieces > 1 || rule.inner || rule.seed_lps_mm || !rule.fills;
  if (is_valid && !(refines && (is_iso || is_mask)) && !(is_iso && (rule.open_mm > 0 || rule.overlaps)))
    return rule;
  return fail(ErrorCode::kUsage,
              "--segment '{}': must be NAME=mask:FILE, NAME=threshold:LOW[:HIGH] with LOW at most HIGH, "
              "NAME=threshold:otsu or NAME=iso:LEVEL, with options :open=MM and :close=MM with MM from 0 to "
              "{}, :pieces=N, :inner, "
              ":seed=X,Y,Z, :within=NAME, :fill=no, :overlap, :color=#rrggbb",
              text, kMaxClosingMm);
}

Mask voxels_between(const VoxelBuffer& values, const SegmentRule& rule) {
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

Result<void> refine_segment(Mask& mask, const Grid& grid, const SegmentRule& rule) {
  return call_itk(fmt::format("--segment \"{}\"", rule.name), [&] { return run_filters(mask, grid, rule); });
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

}  // namespace splatlas
