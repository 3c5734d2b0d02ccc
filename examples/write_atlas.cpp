// Atlas from arrays in memory: a ball with grey values, as a volume.
//
//   write_atlas ball.atlas
//
// A class is a set of structures, each with interior or boundary. A boundary voxel has at least one of its 18
// face and edge neighbours outside the structure, and a normal for shading. Triangles belong to
// content.surfaces; splatlas-preprocess extracts them from labels.
#include <cmath>
#include <cstdio>

#include <splatlas/format/atlas_writer.h>

using namespace splatlas;

constexpr std::int64_t kSide = 32;
constexpr double kCenter = 15.5;

bool holds(const Vec3& at) {
  return std::hypot(at[0] - kCenter, at[1] - kCenter, at[2] - kCenter) < 12;
}

bool is_boundary(const Vec3& at) {
  int held = 0;
  for (int n = 0; n < 27; ++n) {
    const int i = n % 3 - 1, j = n / 3 % 3 - 1, k = n / 9 - 1;
    held += i * j * k == 0 && holds({at[0] + i, at[1] + j, at[2] + k});
  }
  return held < 19;
}

AtlasContent make_content() {
  AtlasContent content;
  content.source_grid.size = {kSide, kSide, kSide};  // voxels of 1 mm; axes run to L, P and S
  content.graph = *StructureGraph::build({{.id = "Ball", .name = "Ball", .color = {240, 120, 40}}});
  content.surfaces.resize(1);
  content.display = {.window_high = 255, .center_lps_mm = {kCenter, kCenter, kCenter}, .radius_mm = 13};
  content.values.type = VoxelType::kUInt8;
  const ClassId interior = content.classes.intern({{0, Part::kInterior}});
  const ClassId boundary = content.classes.intern({{0, Part::kBoundary}});  // in storage_order()
  content.boundary_normals.resize(content.classes.size());
  for (std::int64_t n = 0; n < kSide * kSide * kSide; ++n) {  // i runs fastest
    const Index3 voxel{n % kSide, n / kSide % kSide, n / (kSide * kSide)};
    const Vec3 at{double(voxel[0]), double(voxel[1]), double(voxel[2])};
    const ClassId c = !holds(at) ? kEmptyClass : is_boundary(at) ? boundary : interior;
    content.class_volume.push_back(c);
    content.classes.count(c, 1, {voxel, voxel});
    content.values.bytes.push_back(static_cast<std::byte>(8 * voxel[2]));
    const std::array<float, 3> outwards{float(at[0] - kCenter), float(at[1] - kCenter),
                                        float(at[2] - kCenter)};
    if (c == boundary) content.boundary_normals[c].push_back(pack_normal(outwards));
  }
  return content;
}

int main(int argc, char** argv) {
  const auto written = write_atlas(make_content(), argc > 1 ? argv[1] : "ball.atlas");
  if (!written) std::fprintf(stderr, "write_atlas: %s\n", printable(written.error().message).c_str());
  return written ? 0 : 1;
}
