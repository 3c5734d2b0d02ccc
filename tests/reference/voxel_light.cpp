#include "tests/reference/voxel_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <type_traits>

#include "format/content/voxel_type.h"
#include "player/transfer_function.h"
#include "tests/reference/optical_field.h"

namespace splatlas::reference {
namespace {

/// As a number of 32 bits.
bool is_finite(double value) {
  return std::isfinite(static_cast<float>(value));
}

double ramp(double x, double low, double high) {
  return std::clamp((x - low) / (high - low), 0.0, 1.0);
}

/// The gradient of the grey values around a voxel: in LPS, its squared length, and the mean square.
struct Gradient {
  Vec3 lps{};
  double squared_length = 0, mean_square = 0;
};

class Lighter {
 public:
  Lighter(const AtlasContent& content, const Selection& selection)
      : content_(content),
        selection_(selection),
        grid_(storage_grid(content)),
        to_index_(lps_mm_to_index(grid_)),
        plan_(DecisionTree(content.graph, content.classes).plan(selection)),
        draw_of_(content.classes.size(), nullptr) {
    for (const ClassDraw& draw : plan_.classes) {
      if (draws_volume(draw.role)) draw_of_[draw.id] = &draw;
    }
  }

  LitVoxel at(const Index3& voxel, std::size_t number_in_class) const {
    const ClassId c = content_.class_volume[number(voxel)];
    if (draw_of_[c] == nullptr) return {};
    const bool boundary = draw_of_[c]->boundary;
    LitVoxel light{boundary ? 1.0 : 0.0,
                   boundary ? content_.boundary_normals[c][number_in_class] : PackedNormal{0}};
    if (content_.values.empty()) return light;
    const Gradient gradient = gradient_at(voxel);
    const double coherence = ramp(gradient.squared_length / gradient.mean_square, 0.3, 0.6);
    if (!(coherence > 0)) return light;  // also of NaN
    if (boundary) {
      const auto label = unpack_normal(light.normal);
      const double length = std::sqrt(dot(gradient.lps, gradient.lps));
      const double cosine = dot(gradient.lps, Vec3{label[0], label[1], label[2]}) / length;
      const double share = coherence * ramp(std::abs(cosine), 0.3, 0.8);
      if (share <= 0) return light;
      Vec3 mixed;
      for (std::size_t a = 0; a < 3; ++a) {
        mixed[a] = share * (cosine < 0 ? -1 : 1) * gradient.lps[a] / length +
                   (1 - share) * static_cast<double>(label[a]);
      }
      light.normal = packed(mixed);
      return light;
    }
    const double value = value_of(content_.values, number(voxel)), grey = is_finite(value) ? value : 0;
    const double reach = 3 * voxel_side_mm(grid_) * std::sqrt(gradient.squared_length);
    const TransferCurve curve =
        transfer_curve(selection_.structures[draw_of_[c]->volume_of], content_.display);
    const double below = extinction_near(curve, grey - reach), above = extinction_near(curve, grey + reach);
    if (!(std::max(below, above) > 0)) return light;
    light.lit = coherence * ramp(std::abs(above - below) / std::max(below, above), 0.01, 0.05);
    const double sign = above > below ? -1 : 1;
    light.normal = packed({sign * gradient.lps[0], sign * gradient.lps[1], sign * gradient.lps[2]});
    return light;
  }

 private:
  /// Values of 8 and 16 bits: linear between whole numbers.
  [[nodiscard]] double extinction_near(const TransferCurve& curve, double grey) const {
    const auto at = [&](double value) { return transfer(curve, value, 1).extinction_per_mm; };
    return visit_voxel_type(content_.values.type, [&](auto tag) {
      using T = decltype(tag);
      if (!std::is_integral_v<T> || sizeof(T) > 2) return at(grey);
      const double in_range = std::clamp(grey, static_cast<double>(std::numeric_limits<T>::lowest()),
                                         static_cast<double>(std::numeric_limits<T>::max()));
      return std::lerp(at(std::floor(in_range)), at(std::ceil(in_range)), in_range - std::floor(in_range));
    });
  }

  /// The octahedral map with each component rounded by itself.
  static PackedNormal packed(const Vec3& n) {
    const double sum = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
    std::array<double, 2> p{n[0] / sum, n[1] / sum};
    if (n[2] < 0) {
      p = {(1 - std::abs(n[1] / sum)) * (n[0] < 0 ? -1 : 1),
           (1 - std::abs(n[0] / sum)) * (n[1] < 0 ? -1 : 1)};
    }
    const auto code = [](double x) {
      return static_cast<std::uint8_t>(static_cast<int>(std::floor(127 * x + 0.5)));
    };
    return static_cast<PackedNormal>(code(p[0]) | code(p[1]) << 8);
  }
  [[nodiscard]] std::size_t number(const Index3& v) const {
    return static_cast<std::size_t>(grid_.offset(v[0], v[1], v[2]));
  }
  /// True for a voxel inside the structure with a grey value.
  [[nodiscard]] bool counts(const Index3& v, StructureIndex structure) const {
    if (!grid_.contains(v[0], v[1], v[2]) || !is_finite(value_of(content_.values, number(v)))) return false;
    const auto members = content_.classes.members(content_.class_volume[number(v)]);
    return std::ranges::any_of(
        members, [&](const Membership& m) { return m.structure == structure && m.part != Part::kCrossed; });
  }

  [[nodiscard]] Gradient gradient_at(const Index3& voxel) const {
    Gradient gradient;
    const StructureIndex structure = draw_of_[content_.class_volume[number(voxel)]]->volume_of;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double pairs = 0, sum = 0, squares = 0;
      for (std::int64_t n = 0; n < 27; ++n) {
        const std::array<std::int64_t, 3> step{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        if (step[axis] == 1) continue;  // the pairs begin before the voxel, and at it
        double weight = 1;
        for (std::size_t a = 0; a < 3; ++a) weight /= a != axis && step[a] != 0 ? 2 : 1;
        Index3 first = voxel;
        for (std::size_t a = 0; a < 3; ++a) first[a] += step[a];
        Index3 second = first;
        ++second[axis];
        if (!counts(first, structure) || !counts(second, structure)) continue;
        const double difference =
            value_of(content_.values, number(second)) - value_of(content_.values, number(first));
        pairs += weight;
        sum += weight * difference;
        squares += weight * difference * difference;
      }
      if (pairs == 0) continue;
      const double mm = grid_.spacing_mm[axis], mean = sum / pairs;
      gradient.squared_length += mean * mean / (mm * mm);
      gradient.mean_square += squares / pairs / (mm * mm);
      for (std::size_t a = 0; a < 3; ++a) gradient.lps[a] += mean * to_index_.linear[3 * axis + a];
    }
    return gradient;
  }

  const AtlasContent& content_;
  const Selection& selection_;
  const Grid grid_;
  const Affine to_index_;
  const DrawPlan plan_;
  std::vector<const ClassDraw*> draw_of_;
};

}  // namespace

std::vector<LitVoxel> lit_voxels(const AtlasContent& content, const Selection& selection) {
  const Lighter lighter(content, selection);
  const Grid grid = storage_grid(content);
  std::vector<LitVoxel> lit(content.class_volume.size());
  std::vector<std::size_t> met(content.classes.size(), 0);  // voxels per class so far
  for (std::int64_t k = 0; k < grid.size[2]; ++k) {
    for (std::int64_t j = 0; j < grid.size[1]; ++j) {
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const auto n = static_cast<std::size_t>(grid.offset(i, j, k));
        lit[n] = lighter.at({i, j, k}, met[content.class_volume[n]]++);
      }
    }
  }
  return lit;
}

}  // namespace splatlas::reference
