#include "format/derive/distinct_colors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "format/derive/value_groups.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

using Matrix = std::array<Vec3, 3>;

/// Linear RGB to what each of kSights sees of it (Machado et al. 2009, severity 1).
constexpr std::array<Matrix, kSights.size()> kSeen{{
    {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
    {{{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}},
    {{{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}},
    {{{1.255528, -0.076749, -0.178779}, {-0.078411, 0.930809, 0.147602}, {0.004733, 0.691367, 0.303900}}},
}};

// OKLab: linear sRGB to cones, and their cube roots to lightness and two axes of colour.
constexpr Matrix kCones{{{0.4122214708, 0.5363325363, 0.0514459929},
                         {0.2119034982, 0.6806995451, 0.1073969566},
                         {0.0883024619, 0.2817188376, 0.6299787005}}};
constexpr Matrix kLab{{{0.2104542553, 0.7936177850, -0.0040720468},
                       {1.9779984951, -2.4285922050, 0.4505937099},
                       {0.0259040371, 0.7827717662, -0.8086757660}}};

// Their inverses.
constexpr Matrix kFromLab{
    {{1, 0.3963377774, 0.2158037573}, {1, -0.1055613458, -0.0638541728}, {1, -0.0894841775, -1.2914855480}}};
constexpr Matrix kFromCones{{{4.0767416621, -3.3077115913, 0.2309699292},
                             {-1.2684380046, 2.6097574011, -0.3413193965},
                             {-0.0041960863, -0.7034186147, 1.7076147010}}};

Vec3 times(const Matrix& m, const Vec3& v) {
  return {dot(m[0], v), dot(m[1], v), dot(m[2], v)};
}

/// A colour in OKLab, as each of kSights sees it.
using SeenColor = std::array<Vec3, kSights.size()>;

SeenColor seen(Rgb color) {
  const Vec3 linear{decode_srgb(color.r / 255.0), decode_srgb(color.g / 255.0), decode_srgb(color.b / 255.0)};
  SeenColor seen;
  for (std::size_t n = 0; n < kSights.size(); ++n) {
    Vec3 rgb = times(kSeen[n], linear);
    for (double& channel : rgb) channel = std::clamp(channel, 0.0, 1.0);
    Vec3 cones = times(kCones, rgb);
    for (double& cone : cones) cone = std::cbrt(cone);
    seen[n] = times(kLab, cones);
  }
  return seen;
}

double distance(const Vec3& a, const Vec3& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Of the sight that sees least of it.
double distance(const SeenColor& a, const SeenColor& b) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < kSights.size(); ++n) least = std::min(least, distance(a[n], b[n]));
  return least;
}

/// Distance of colours clearly apart: as any two of the palette, five times the just noticeable one.
constexpr double kApart = 0.112;

using Shade = std::array<int, 4>;  ///< change, and steps of lightness, chroma and hue

std::array<Shade, 63> all_shades() {
  std::array<Shade, 63> shades{};
  for (int n = 0; n < 63; ++n) {
    const int lightness = n / 9 - 3, chroma = n / 3 % 3 - 1, hue = n % 3 - 1;
    shades[n] = {lightness * lightness + 4 * (chroma * chroma + hue * hue), lightness, chroma, hue};
  }
  std::ranges::sort(shades);
  return shades;
}

/// The colour itself if it would be too dark or is none of sRGB.
Rgb shade_of(Rgb color, const Shade& shade) {
  const Vec3 lab = seen(color)[0];
  const double lightness = lab[0] + 0.115 * shade[1], turn = std::numbers::pi / 9 * shade[3],
               chroma = (1 + 0.5 * shade[2]) * std::min(1.0, lightness / lab[0]);  // darker as in shadow
  const double x = chroma * std::cos(turn), y = chroma * std::sin(turn);
  Vec3 linear = times(kFromLab, {lightness, lab[1] * x - lab[2] * y, lab[1] * y + lab[2] * x});
  for (double& cone : linear) cone = cone * cone * cone;
  linear = times(kFromCones, linear);
  if (lightness < 0.3 || *std::ranges::min_element(linear) < -0.02 ||
      *std::ranges::max_element(linear) > 1.02)
    return color;
  for (double& channel : linear) channel = 255 * encode_srgb(std::clamp(channel, 0.0, 1.0)) + 0.5;
  return {static_cast<std::uint8_t>(linear[0]), static_cast<std::uint8_t>(linear[1]),
          static_cast<std::uint8_t>(linear[2])};
}

/// Sorts, and leaves each value once.
template <typename T>
void sort_once(std::vector<T>& values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// Appends a value. Where the capacity ends, it leaves each value once, so memory is that of the different
/// ones. `bytes`: the sum of all capacities. Throws as check_memory().
template <typename T>
void add_once(std::vector<T>& values, T value, double& bytes) {
  if (values.size() == values.capacity()) {
    sort_once(values);
    if (2 * values.size() >= values.capacity()) {
      const std::size_t more = std::max<std::size_t>(values.capacity(), 16);
      bytes += static_cast<double>(more * sizeof(T));
      check_memory(bytes);
      values.reserve(values.capacity() + more);
    }
  }
  values.push_back(value);
}

/// Classes that touch, in pairs a < b; the empty class has no part in them.
std::vector<std::pair<ClassId, ClassId>> touching_classes(const ClassTable& classes,
                                                          std::span<const ClassRuns> runs,
                                                          const Index3& size) {
  std::vector<ClassId> ids(runs.size());
  std::iota(ids.begin(), ids.end(), kEmptyClass);
  const auto end = [](const Run& run) { return std::uint64_t{run.start} + run.length; };
  const ValueGroups groups(classes);  // of classes of the same structures: the first one stands for all
  std::vector<ClassSpan> spans;
  for (ClassSpan span : merge_runs(ids, runs)) {
    span.of = groups.classes[groups.group_of[span.of]].front();
    const bool continues = !spans.empty() && spans.back().of == span.of &&
                           spans.back().run.scanline == span.run.scanline &&
                           end(spans.back().run) == span.run.start;
    if (continues) spans.back().run.length += span.run.length;
    if (!continues) spans.push_back(span);
  }
  std::vector<std::pair<ClassId, ClassId>> pairs;
  double bytes = 0;
  std::vector<ClassId> latest(classes.size(), kEmptyClass);  // [smaller class]: most pairs come in sequence
  const auto rows = static_cast<std::uint64_t>(size[1]);
  TaskPace pace;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint64_t voxels = axis == 0 ? 1 : 0, scanlines = axis == 2 ? rows : axis;
    std::size_t first = 0;
    for (const ClassSpan& span : spans) {
      const std::uint64_t row = span.run.scanline + scanlines;
      if (axis == 1 && row % rows == 0) continue;
      while (first < spans.size() && std::pair(spans[first].run.scanline, end(spans[first].run)) <=
                                         std::pair(row, span.run.start + voxels))
        ++first;
      for (std::size_t n = first; n < spans.size(); ++n) {
        if (spans[n].run.scanline != row || spans[n].run.start >= end(span.run) + voxels) break;
        pace.step();
        const auto [a, b] = std::minmax(span.of, spans[n].of);
        if (a != b && std::exchange(latest[a], b) != b) add_once(pairs, std::pair(a, b), bytes);
      }
    }
  }
  sort_once(pairs);
  return pairs;
}

}  // namespace

std::vector<std::vector<StructureIndex>> touching_structures(std::size_t structures,
                                                             const ClassTable& classes,
                                                             std::span<const ClassRuns> runs,
                                                             const Index3& size) {
  std::vector<std::vector<StructureIndex>> touching(structures);
  double bytes = 0;
  TaskPace pace;
  const auto add = [&](ClassId a, ClassId b) {
    for (const Membership& of_a : classes.members(a)) {
      for (const Membership& of_b : classes.members(b)) {
        pace.step();
        if (of_a.structure == of_b.structure) continue;
        add_once(touching[of_a.structure], of_b.structure, bytes);
        add_once(touching[of_b.structure], of_a.structure, bytes);
      }
    }
  };
  for (ClassId c = 0; c < classes.size(); ++c) add(c, c);
  for (const auto& [a, b] : touching_classes(classes, runs, size)) add(a, b);
  std::ranges::for_each(touching, sort_once<StructureIndex>);
  return touching;
}

double color_distance(Rgb a, Rgb b, Sight sight) {
  const auto n = static_cast<std::size_t>(sight);
  return distance(seen(a)[n], seen(b)[n]);
}

std::vector<Rgb> distinct_colors(std::span<const std::vector<StructureIndex>> neighbors,
                                 std::span<const std::optional<Rgb>> given,
                                 std::span<const std::optional<Rgb>> wished) {
  static const std::array<Shade, 63> shades = all_shades();
  std::vector<Rgb> colors(neighbors.size());
  std::vector<std::optional<SeenColor>> found(neighbors.size());
  std::vector<StructureIndex> order;
  for (StructureIndex s = 0; s < neighbors.size(); ++s) {
    if (given[s]) found[s] = seen(colors[s] = *given[s]);
    if (!given[s]) order.push_back(s);
  }
  std::ranges::stable_sort(order, std::greater(), [&](StructureIndex s) { return neighbors[s].size(); });
  std::array<std::pair<std::size_t, std::size_t>, kDefaultColors> palette;  // uses, index
  for (std::size_t n = 0; n < palette.size(); ++n) palette[n] = {0, n};
  for (const StructureIndex s : order) {
    const bool has_wish = !wished.empty() && wished[s];
    std::ranges::sort(palette);
    double farthest = -1;
    std::size_t best = 0;
    for (std::size_t n = 0; n < (has_wish ? shades.size() : palette.size()) && farthest < kApart; ++n) {
      const Rgb color = has_wish ? shade_of(*wished[s], shades[n]) : default_color(palette[n].second);
      const SeenColor looks = seen(color);
      double apart = kApart;
      for (const StructureIndex other : neighbors[s])
        if (found[other]) apart = std::min(apart, distance(looks, *found[other]));
      if (apart <= farthest) continue;
      farthest = apart;
      best = n;
      colors[s] = color;
      found[s] = looks;
    }
    if (!has_wish) ++palette[best].first;
  }
  return colors;
}

}  // namespace splatlas
