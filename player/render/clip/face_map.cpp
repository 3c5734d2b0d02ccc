#include "player/render/clip/face_map.h"

#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "player/transfer_function.h"

namespace splatlas {
namespace {

/// Slack of the layers of a column for rounding.
constexpr double kRounding = 1e-6;
/// Share of the maximum extinction from which on a voxel has a whole face.
constexpr float kWholeFace = 0.125f;
/// Grey values further outside the display window, in its widths, count as this far.
constexpr double kMaxWindows = 100;

/// Bounding box of all voxels with faces.
IndexBox box_of(const std::vector<FaceClass>& faces, const ClassTable& classes) {
  IndexBox box;
  for (ClassId c = 0; c < faces.size(); ++c) {
    if (faces[c].has_face()) box.include(classes.box(c));
  }
  return box;
}

/// Grey values relative to the display window.
class Window {
 public:
  explicit Window(const Display& display)
      : low_(display.window_low), width_(display.window_high - display.window_low) {}

  [[nodiscard]] bool is_empty() const { return !(width_ > 0) || !std::isfinite(width_); }
  template <typename T>
  [[nodiscard]] float position(T value) const {
    if (is_empty()) return 1;
    const auto grey = static_cast<double>(value);
    if (std::isnan(grey)) return 0;
    return static_cast<float>(std::clamp((grey - low_) / width_, -kMaxWindows, kMaxWindows));
  }

 private:
  double low_, width_;
};

/// The style of a solid, which has the opacity of its surface.
FaceStyle solid_style(StructureIndex structure, const Selection& selection) {
  const StructureDraw& draw = selection.structures[structure];
  return {structure,
          draw.term,
          draw.opacity.value_or(1.0f),
          {srgb_to_linear(draw.color.r), srgb_to_linear(draw.color.g), srgb_to_linear(draw.color.b)}};
}

/// The style of a structure's voxels: of a solid if it is one. Volumes have full opacity, ghosts no face.
FaceStyle face_style(StructureIndex structure, const Selection& selection) {
  const StructureDraw& draw = selection.structures[structure];
  if (draw.mode == DrawMode::kOff || (draw.mode == DrawMode::kSurface && draw.ghost)) return {};
  FaceStyle style = solid_style(structure, selection);
  if (!is_solid(draw)) style.opacity = full_opacity(draw);
  return style;
}

}  // namespace

std::vector<FaceClass> face_classes(const ClassTable& classes, const Selection& selection,
                                    const DrawPlan& plan, const std::vector<bool>& without) {
  constexpr std::uint32_t kNotDrawn = FaceClass::kEveryVoxel;
  std::vector<std::uint32_t> draw_of_class(classes.size(), kNotDrawn);
  for (std::uint32_t n = 0; n < plan.classes.size(); ++n) {
    if (draws_volume(plan.classes[n].role)) draw_of_class[plan.classes[n].id] = n;
  }
  std::vector<FaceStyle> styles;
  for (StructureIndex s = 0; s < selection.structures.size(); ++s) {
    const bool is_left_out = s < without.size() && without[s];
    styles.push_back(is_left_out ? FaceStyle() : face_style(s, selection));
  }
  std::vector<FaceClass> faces(classes.size());
  for (ClassId c = 0; c < classes.size(); ++c) {
    FaceClass& face = faces[c];
    for (const Membership& member : classes.members(c)) {
      if (!member.holds() || member.structure >= styles.size()) continue;
      const FaceStyle& style = styles[member.structure];
      if (style.hides(face)) static_cast<FaceStyle&>(face) = style;
    }
    if (!face.has_face() || is_solid(selection.structures[face.structure])) continue;
    const std::uint32_t draw = draw_of_class[c];
    if (draw == kNotDrawn) {
      face = {};  // a damaged part
    } else if (plan.classes[draw].volume_of == face.structure) {
      face.draw = draw;
    }
  }
  return faces;
}

/// Collects the voxels of runs near the plane.
class FaceMap::Builder {
 public:
  Builder(FaceMap& map, const FaceScene& scene)
      : map_(map),
        scene_(scene),
        order_(ScanOrder::of(scene.axis)),
        window_(scene.atlas.display()),
        texels_(reinterpret_cast<Texel*>(map.texels_.data())) {}

  void add_slice(std::int64_t slice) {
    check_task();
    for (const ClassRun& run : scene_.cache.runs(scene_.axis).slice(slice)) {
      if ((*map_.classes_)[run.id].has_face()) add_run(slice, run);
    }
  }

 private:
  /// Layers of a column: [first, last].
  [[nodiscard]] std::pair<std::int64_t, std::int64_t> layers(const Index3& voxel) const {
    const double height =
        map_.height(static_cast<double>(voxel[map_.b_]), static_cast<double>(voxel[map_.c_]));
    return {static_cast<std::int64_t>(std::floor(height - map_.reach_)),
            static_cast<std::int64_t>(std::floor(height + map_.reach_)) + 1};
  }

  void add_run(std::int64_t slice, const ClassRun& run) {
    Index3 voxel{};
    voxel[order_.slice_axis] = slice;
    voxel[order_.row_axis] = run.row;
    const std::size_t scan = order_.scan_axis;
    std::int64_t first = run.start, last = first + run.length - 1;
    if (scan == map_.a_) {
      const auto [first_layer, last_layer] = layers(voxel);
      first = std::max(first, first_layer);
      last = std::min(last, last_layer);
    } else {
      // Solve |height - a| <= reach + 2 along the scanline
      const double slope = scan == map_.b_ ? map_.per_b_ : map_.per_c_;
      voxel[scan] = 0;
      const double above =
          map_.height(static_cast<double>(voxel[map_.b_]), static_cast<double>(voxel[map_.c_])) -
          static_cast<double>(voxel[map_.a_]);
      const double reach = map_.reach_ + 2;
      if (slope == 0) {
        if (std::abs(above) > reach) return;
      } else {
        const double one = (-reach - above) / slope, other = (reach - above) / slope;
        const auto voxels = [&](double position) {
          return static_cast<std::int64_t>(
              std::clamp(position, static_cast<double>(first - 1), static_cast<double>(last + 1)));
        };
        const std::int64_t from = voxels(std::floor(std::min(one, other)));
        const std::int64_t to = voxels(std::ceil(std::max(one, other)));
        first = std::max(first, from);
        last = std::min(last, to);
      }
    }
    for (voxel[scan] = first; voxel[scan] <= last; ++voxel[scan]) add_voxel(voxel, run.id);
  }

  void add_voxel(const Index3& voxel, ClassId id) {
    const auto [first, last] = layers(voxel);
    const std::int64_t a = voxel[map_.a_];
    if (a < first || a > last) return;
    const Grid& grid = scene_.atlas.grid();
    const auto offset = static_cast<std::size_t>(grid.offset(voxel[0], voxel[1], voxel[2]));
    const float own_share = share((*map_.apart_)[id], offset);
    const float of_face = own_share > 0 ? own_share : share((*map_.classes_)[id], offset);
    if (of_face == 0) return;
    const std::byte* values = scene_.cache.values();
    float grey = 1;
    if (values != nullptr) {
      grey = visit_voxel_type(scene_.atlas.value_type(), [&](auto tag) {
        return window_.position(reinterpret_cast<const decltype(tag)*>(values)[offset]);
      });
    }
    texels_[map_.place(a, voxel[map_.b_], voxel[map_.c_])] = {grey, own_share > 0 ? id | kOwnFace : id,
                                                              of_face};
  }

  /// Share of a voxel that has a face: 0 where a transfer function gives it no extinction.
  [[nodiscard]] float share(const FaceClass& face, std::size_t offset) const {
    if (!face.has_face()) return 0;
    if (face.draw == FaceClass::kEveryVoxel) return 1;
    const VolumeAppearance& appearance = scene_.appearances[face.draw];
    ClassifiedVoxel classified;
    appearance.look_up(scene_.cache.values(), offset, 1, 1, &classified);
    const float extinction = classified.extinction_per_mm;
    return extinction > 0 ? std::min(extinction / (kWholeFace * appearance.extinction_per_mm), 1.0f) : 0;
  }

  const FaceMap& map_;
  const FaceScene& scene_;
  ScanOrder order_;
  Window window_;
  Texel* texels_;
};

void FaceMap::add_solids(const VoxelPlane& plane, const FaceScene& scene, ThreadPool& pool) {
  for (const StructureIndex s : scene.plan.surfaces) {
    if (is_solid(scene.selection.structures[s])) solids_.push_back(solid_style(s, scene.selection));
  }
  std::ranges::sort(solids_, [](const FaceStyle& a, const FaceStyle& b) { return b.hides(a); });
  std::vector<const SurfaceMesh*> meshes;
  for (const FaceStyle& solid : solids_) meshes.push_back(&scene.cache.surface(solid.structure).mesh);
  // Of surfaces in the plane, those of the kept side count
  const VoxelPlane inside{plane.normal, plane.offset - kTie};
  outlines_ = SolidOutlines(inside, b_, c_, meshes, pool);
  std::vector<bool> outlined(scene.selection.structures.size());
  for (std::uint32_t n = 0; n < solids_.size(); ++n) outlined[solids_[n].structure] = outlines_.is_closed(n);
  apart_ = std::make_shared<const std::vector<FaceClass>>(
      face_classes(scene.atlas.classes(), scene.selection, scene.plan, outlined));
}

FaceMap::Cell FaceMap::cell_at(std::int64_t a, std::int64_t b, std::int64_t c) const {
  Cell cell;
  cell.a = a, cell.b = b, cell.c = c;
  const std::int64_t layers = (std::int64_t{1} << layer_bits_) - 1;
  for (std::size_t n = 0; n < 8; ++n) {
    const std::int64_t column = (c + (n >= 4 ? 1 : 0)) * columns_ + b + (n % 4 >= 2 ? 1 : 0);
    const Texel* const texel = texels() + (column << layer_bits_) + ((a + (n % 2 == 1 ? 1 : 0)) & layers);
    cell.texels[n] = texel;
    if ((texel->id & kOwnFace) != 0) cell.faces[n] = &(*apart_)[texel->class_id()];
  }
  const auto all = [&](const auto& has) { return std::ranges::all_of(cell.texels, has); };
  cell.is_empty = all([](const Texel* texel) { return !texel->has_face(); });
  cell.is_whole = all([](const Texel* texel) { return texel->share >= 1; });
  const auto structure = [](const FaceStyle* face) { return face ? face->structure : kNoStructure; };
  cell.is_plain = all([](const Texel* texel) { return texel->share > 0.5 + 2 * kTie; }) &&
                  std::ranges::count(cell.faces, structure(cell.faces[0]), structure) == 8;
  if (!solids_.empty()) cell.outlines = outlines_.cell(b + first_b_, c + first_c_);
  return cell;
}

std::optional<FaceSample> FaceMap::between(const Cell& cell, double in_a, double in_b, double in_c) const {
  const auto a1 = static_cast<float>(in_a), b1 = static_cast<float>(in_b), c1 = static_cast<float>(in_c);
  const float of_column[4] = {(1 - b1) * (1 - c1), b1 * (1 - c1), (1 - b1) * c1, b1 * c1};
  std::array<float, 8> shares{};
  float grey = 0, sum = 0, own = 0;
  for (std::size_t n = 0; n < 8; ++n) {
    const float weight = of_column[n / 2] * (n % 2 == 0 ? 1 - a1 : a1);
    if (!cell.texels[n]->has_face()) continue;
    sum += weight;
    grey += weight * cell.texels[n]->grey;
    if (cell.faces[n] != nullptr) own += shares[n] = weight * cell.texels[n]->share;
  }
  if (!(sum > 0)) return std::nullopt;
  grey /= sum;
  const FaceStyle* largest = cell.faces[nearest(in_a, in_b, in_c)];
  if (own < 0.5 - kTie || (own <= 0.5 + kTie && largest == nullptr)) return FaceSample{nullptr, grey};
  const auto share_of = [&](const FaceStyle* face) {
    float share = 0;
    for (std::size_t n = 0; n < 8; ++n) {
      if (shares[n] > 0 && cell.faces[n]->structure == face->structure) share += shares[n];
    }
    return share;
  };
  float largest_share = largest == nullptr ? 0 : share_of(largest);
  for (const FaceStyle* face : cell.faces) {
    if (face == nullptr || face == largest) continue;
    if (const float share = share_of(face); share > largest_share + kTie) {
      largest = face;
      largest_share = share;
    }
  }
  return FaceSample{largest, grey};
}

Result<FaceMap> FaceMap::build(const VoxelPlane& plane, const FaceScene& scene, ThreadPool& pool) {
  // Choose the axis nearest to the normal
  FaceMap map;
  for (const std::size_t axis : {1u, 0u}) {
    if (std::abs(plane.normal[axis]) > std::abs(plane.normal[map.a_])) map.a_ = axis;
  }
  map.b_ = map.a_ == 0 ? 1 : 0;
  map.c_ = map.a_ == 2 ? 1 : 2;
  const double along = plane.normal[map.a_];
  map.at_origin_ = plane.offset / along;
  map.per_b_ = -plane.normal[map.b_] / along;
  map.per_c_ = -plane.normal[map.c_] / along;
  map.to_kept_ = along > 0 ? -kTie : kTie;

  // Reserve the columns of the box of voxels with faces, padded by one voxel
  map.classes_ = map.apart_ = scene.classes;
  map.has_greys_ = scene.cache.values() != nullptr && !Window(scene.atlas.display()).is_empty();
  const IndexBox box = box_of(*scene.classes, scene.atlas.classes());
  if (box.empty()) return map;
  const double tilt = std::abs(map.per_b_) + std::abs(map.per_c_);  // at most 2
  map.reach_ = tilt > 0 ? tilt + kRounding : 0;
  const int layers = tilt > 0 ? static_cast<int>(2 * map.reach_) + 3 : 2;
  while ((1 << map.layer_bits_) < layers) ++map.layer_bits_;
  map.first_b_ = box.first[map.b_] - 1;
  map.first_c_ = box.first[map.c_] - 1;
  map.columns_ = box.last[map.b_] - map.first_b_ + 2;
  map.rows_ = box.last[map.c_] - map.first_c_ + 2;
  const auto columns = static_cast<std::uint64_t>(map.columns_) * static_cast<std::uint64_t>(map.rows_);
  SPLATLAS_ASSIGN_OR_RETURN(map.texels_, SparseBytes::reserve((columns << map.layer_bits_) * sizeof(Texel)));

  if (!scene.plan.surfaces.empty()) map.add_solids(plane, scene, pool);
  Builder builder(map, scene);
  const std::span<const std::int64_t> slices =
      scene.cache.runs(scene.axis).occupied(0, std::numeric_limits<std::int64_t>::max());
  pool.for_each(slices.size(), [&](std::size_t n) { builder.add_slice(slices[n]); });
  return map;
}

}  // namespace splatlas
