#include "tests/preprocess/import/side_volumes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tests/preprocess/raw_image_files.h"

namespace splatlas {

Vec3 Body::position(const Index3& index) const {
  Vec3 at = origin_lps_mm;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t row = 0; row < 3; ++row)
      at[row] += axes_lps[a][row] * spacing_mm[a] * static_cast<double>(index[a]);
  }
  return at;
}

std::uint8_t Body::mark(const Index3& index) const {
  const auto [l, p, s] = index;
  if (l == size[0] - 1 && (p == 1 || p == 2) && s == 1) return 1;
  if (p == 0 && l >= 1 && l <= 3 && s <= 1) return 2;
  if (s == size[2] - 1 && l == 1 && p >= 2) return 3;
  return 0;
}

Vec3 Body::centroid(std::uint8_t wanted) const {
  Vec3 sum{0, 0, 0};
  double count = 0;
  for (std::int64_t s = 0; s < size[2]; ++s) {
    for (std::int64_t p = 0; p < size[1]; ++p) {
      for (std::int64_t l = 0; l < size[0]; ++l) {
        if (mark({l, p, s}) != wanted) continue;
        const Vec3 at = position({l, p, s});
        for (std::size_t a = 0; a < 3; ++a) sum[a] += at[a];
        ++count;
      }
    }
  }
  return {sum[0] / count, sum[1] / count, sum[2] / count};
}

std::array<Vec3, 3> oblique_axes() {
  // Columns of the rotation of the unit quaternion (8 + i + 2 j + 3 k) / sqrt(78): less than 45 degrees.
  return {Vec3{52. / 78, 52. / 78, -26. / 78}, Vec3{-44. / 78, 58. / 78, 28. / 78},
          Vec3{38. / 78, -4. / 78, 68. / 78}};
}

PlacedVolume placed(const Body& body, const AxisOrder& order) {
  PlacedVolume volume{};
  Index3 first{0, 0, 0};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t from = order.from[a];
    volume.size[a] = body.size[from];
    volume.spacing_mm[a] = body.spacing_mm[from];
    const double sign = order.flipped[a] ? -1 : 1;
    for (std::size_t row = 0; row < 3; ++row) volume.axes_lps[a][row] = sign * body.axes_lps[from][row];
    if (order.flipped[a]) first[from] = body.size[from] - 1;
  }
  volume.first_lps_mm = body.position(first);
  for (std::int64_t k = 0; k < volume.size[2]; ++k) {
    for (std::int64_t j = 0; j < volume.size[1]; ++j) {
      for (std::int64_t i = 0; i < volume.size[0]; ++i) {
        Index3 index = first;
        const Index3 steps{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) index[order.from[a]] += (order.flipped[a] ? -1 : 1) * steps[a];
        volume.values.push_back(body.mark(index));
      }
    }
  }
  return volume;
}

namespace {

std::string pixels(const PlacedVolume& volume) {
  return {reinterpret_cast<const char*>(volume.values.data()), volume.values.size()};
}

/// Row `row` of the map from indices to RAS mm: three steps and an offset.
std::array<double, 4> ras_row(const PlacedVolume& volume, std::size_t row) {
  const double sign = row < 2 ? -1 : 1;
  std::array<double, 4> numbers{};
  for (std::size_t a = 0; a < 3; ++a) numbers[a] = sign * volume.axes_lps[a][row] * volume.spacing_mm[a];
  numbers[3] = sign * volume.first_lps_mm[row];
  return numbers;
}

/// A header of NIfTI-1 without orientation, for voxels of one byte.
std::string nifti_header_of(const PlacedVolume& volume) {
  std::string h = with_number<std::int16_t>(nifti_header(), 254, 0);
  for (std::size_t a = 0; a < 3; ++a) {
    h = with_number(h, 42 + 2 * a, static_cast<std::int16_t>(volume.size[a]));
    h = with_number(h, 80 + 4 * a, static_cast<float>(volume.spacing_mm[a]));
  }
  return with_number<std::int16_t>(with_number<std::int16_t>(h, 70, 2), 72, 8);
}

/// The quaternion (b, c, d) with a >= 0 of a rotation whose columns are `axes`.
Vec3 quaternion_of(const std::array<Vec3, 3>& axes) {
  const auto r = [&](std::size_t row, std::size_t column) { return axes[column][row]; };
  // Each square from the diagonal; signs from the differences and sums of the other elements.
  const double a = std::sqrt(std::max(0., 1 + r(0, 0) + r(1, 1) + r(2, 2))) / 2;
  std::array<double, 3> q{std::sqrt(std::max(0., 1 + r(0, 0) - r(1, 1) - r(2, 2))) / 2,
                          std::sqrt(std::max(0., 1 - r(0, 0) + r(1, 1) - r(2, 2))) / 2,
                          std::sqrt(std::max(0., 1 - r(0, 0) - r(1, 1) + r(2, 2))) / 2};
  if (a > 1e-6) {
    q[0] = (r(2, 1) - r(1, 2)) / (4 * a);
    q[1] = (r(0, 2) - r(2, 0)) / (4 * a);
    q[2] = (r(1, 0) - r(0, 1)) / (4 * a);
    return q;
  }
  const std::size_t largest = static_cast<std::size_t>(std::ranges::max_element(q) - q.begin());
  for (std::size_t n = 0; n < 3; ++n) {
    if (n != largest) q[n] = (r(largest, n) + r(n, largest)) / (4 * q[largest]);
  }
  return q;
}

double determinant_of(const std::array<Vec3, 3>& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

}  // namespace

std::string nifti_by_sform(const PlacedVolume& volume) {
  std::string h = with_number<std::int16_t>(nifti_header_of(volume), 254, 1);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t n = 0; n < 4; ++n)
      h = with_number(h, 280 + 16 * row + 4 * n, static_cast<float>(ras_row(volume, row)[n]));
  }
  return h + pixels(volume);
}

std::string nifti_by_qform(const PlacedVolume& volume) {
  std::string h = with_number<std::int16_t>(nifti_header_of(volume), 252, 1);
  std::array<Vec3, 3> axes = volume.axes_lps;
  for (Vec3& axis : axes) axis = {-axis[0], -axis[1], axis[2]};
  const bool is_mirrored = determinant_of(axes) < 0;
  if (is_mirrored) axes[2] = {-axes[2][0], -axes[2][1], -axes[2][2]};
  h = with_number<float>(h, 76, is_mirrored ? -1 : 1);  // qfac
  const Vec3 quaternion = quaternion_of(axes);
  for (std::size_t n = 0; n < 3; ++n) {
    h = with_number(h, 256 + 4 * n, static_cast<float>(quaternion[n]));
    h = with_number(h, 268 + 4 * n, static_cast<float>(ras_row(volume, n)[3]));
  }
  return h + pixels(volume);
}

std::string nifti2_by_sform(const PlacedVolume& volume) {
  std::string h(544, '\0');
  h.replace(4, 8, std::string("n+2\0\r\n\x1a\n", 8));
  h = with_number<std::int16_t>(with_number<std::int16_t>(with_number<std::int32_t>(h, 0, 540), 12, 2), 14,
                                8);
  for (std::size_t n = 0; n < 8; ++n) h = with_number<std::int64_t>(h, 16 + 8 * n, 1);
  h = with_number<double>(with_number<std::int64_t>(h, 16, 3), 104, 1);
  for (std::size_t a = 0; a < 3; ++a) {
    h = with_number<std::int64_t>(h, 24 + 8 * a, volume.size[a]);
    h = with_number<double>(h, 112 + 8 * a, volume.spacing_mm[a]);
    for (std::size_t n = 0; n < 4; ++n)
      h = with_number<double>(h, 400 + 32 * a + 8 * n, ras_row(volume, a)[n]);
  }
  h = with_number<double>(with_number<std::int64_t>(h, 168, 544), 176, 1);
  return with_number<std::int32_t>(h, 348, 1) + pixels(volume);
}

std::string nrrd_in(const PlacedVolume& volume, const std::string& space) {
  const std::array<double, 3> sign{space[0] == 'L' ? 1. : -1., space[1] == 'P' ? 1. : -1., 1.};
  const auto vector = [&](const Vec3& lps, double scale) {
    return fmt::format("({:.17g},{:.17g},{:.17g})", sign[0] * scale * lps[0], sign[1] * scale * lps[1],
                       scale * lps[2]);
  };
  return fmt::format(
      "NRRD0005\ntype: uint8\ndimension: 3\nspace: {}-{}-superior\nsizes: {}\nspace directions: {} {} {}\n"
      "kinds: domain domain domain\nencoding: raw\nspace origin: {}\n\n{}",
      space[0] == 'L' ? "left" : "right", space[1] == 'P' ? "posterior" : "anterior",
      fmt::join(volume.size, " "), vector(volume.axes_lps[0], volume.spacing_mm[0]),
      vector(volume.axes_lps[1], volume.spacing_mm[1]), vector(volume.axes_lps[2], volume.spacing_mm[2]),
      vector(volume.first_lps_mm, 1), pixels(volume));
}

std::string seg_nrrd(const PlacedVolume& volume) {
  std::string segments;
  for (int n = 0; n < 3; ++n) {
    segments += fmt::format(
        "Segment{0}_ID:=Segment_{1}\nSegment{0}_LabelValue:={1}\nSegment{0}_Layer:=0\n"
        "Segment{0}_Name:={2}\n",
        n, n + 1, std::array{"left", "front", "top"}[static_cast<std::size_t>(n)]);
  }
  return replaced(nrrd_in(volume, "LPS"), "\n\n", "\n" + segments + "\n");
}

std::string meta_image_of(const PlacedVolume& volume) {
  std::string matrix;
  for (const Vec3& axis : volume.axes_lps) matrix += fmt::format(" {:.17g}", fmt::join(axis, " "));
  return fmt::format(
      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
      "CompressedData = False\nTransformMatrix ={}\nOffset = {:.17g}\nElementSpacing = {}\nDimSize = {}\n"
      "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n{}",
      matrix, fmt::join(volume.first_lps_mm, " "), fmt::join(volume.spacing_mm, " "),
      fmt::join(volume.size, " "), pixels(volume));
}

std::string mgh_of(const PlacedVolume& volume) {
  std::string h(284, '\0');
  const auto put = [&]<typename T>(std::size_t offset, T value) {
    h = with_number(h, offset, value);
    std::reverse(h.begin() + static_cast<std::ptrdiff_t>(offset),
                 h.begin() + static_cast<std::ptrdiff_t>(offset + sizeof(T)));
  };
  put(0, std::int32_t{1});
  for (std::size_t a = 0; a < 3; ++a) put(4 + 4 * a, static_cast<std::int32_t>(volume.size[a]));
  put(16, std::int32_t{1});
  put(28, std::int16_t{1});
  for (std::size_t row = 0; row < 3; ++row) {
    put(30 + 4 * row, static_cast<float>(volume.spacing_mm[row]));
    const auto numbers = ras_row(volume, row);
    double center = numbers[3];
    for (std::size_t a = 0; a < 3; ++a) {
      put(42 + 12 * a + 4 * row, static_cast<float>((row < 2 ? -1 : 1) * volume.axes_lps[a][row]));
      center += numbers[a] * static_cast<double>(volume.size[a]) / 2;
    }
    put(78 + 4 * row, static_cast<float>(center));
  }
  return h + pixels(volume);
}

}  // namespace splatlas
