// Voxels and grey values of a structure, with splatlas::format only.
//
//   read_voxels brain.atlas Cerebellum
//
// Every voxel belongs to exactly one class, a combination of structures. A structure's voxels are those of
// its interior and boundary classes, and of its descendants'; several structures may share a class.
#include <cstdio>
#include <set>

#include <splatlas/format/atlas_reader.h>
#include <splatlas/format/content/selection.h>

using namespace splatlas;

void run(const char* path, const char* name) {
  const auto opened = value_or_throw(Atlas::open(path));
  const Atlas& atlas = *opened;
  std::set<ClassId> classes;
  for (const StructureIndex s : atlas.graph().descendants(value_or_throw(atlas.graph().find(name)))) {
    for (const ClassId c : atlas.tree().interior_classes(s)) classes.insert(c);
    for (const ClassId c : atlas.tree().boundary_classes(s)) classes.insert(c);
  }

  std::uint64_t voxels = 0;
  double sum = 0;
  for (const ClassId c : classes) {
    for (const Run& run : value_or_throw(atlas.read_runs(c, Axis::kZ))) voxels += run.length;  // along i
    const auto values = value_or_throw(atlas.read_values(c));  // in the order of the runs
    if (values.empty()) continue;
    visit_voxel_type(atlas.value_type(), [&](auto tag) {
      const auto* value = reinterpret_cast<const decltype(tag)*>(values.data());
      for (std::uint64_t n = 0; n < atlas.classes().voxels(c); ++n) sum += static_cast<double>(value[n]);
    });
  }
  std::printf("%s: %llu voxels, %.3f ml, mean grey value %.3f\n", printable(name).c_str(),
              static_cast<unsigned long long>(voxels),
              static_cast<double>(voxels) * voxel_volume_mm3(atlas.grid()) / 1000,
              voxels > 0 ? sum / static_cast<double>(voxels) : 0);
}

int main(int argc, char** argv) try {
  if (argc != 3) throw std::runtime_error("usage: read_voxels ATLAS STRUCTURE");
  run(argv[1], argv[2]);
} catch (const std::exception& error) {
  std::fprintf(stderr, "read_voxels: %s\n", printable(error.what()).c_str());
  return 1;
}
