// Decoding of whole atlases: Atlas::read_all, read_classes and read_value_volume.
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "format/file/reader/atlas_impl.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {

namespace {

Result<std::vector<ClassId>> read_class_volume(const Atlas& atlas) {
  check_memory(static_cast<double>(atlas.grid().voxels()) * sizeof(ClassId) +
               static_cast<double>(atlas.runs(Axis::kZ)) * sizeof(Run));
  RunModel model{Axis::kZ, std::vector<ClassRuns>(atlas.classes().size())};
  for (ClassId c = 1; c < model.classes.size(); ++c) {
    SPLATLAS_ASSIGN_OR_RETURN(model.classes[c], atlas.read_runs(c, Axis::kZ));
  }
  auto volume = decode_runs(model, atlas.grid().size);
  if (!volume) return fail(volume.error().code, atlas.name() + ": invalid: " + volume.error().message);
  return volume;
}

/// Scatters values sorted by class to the voxels of the class volume.
VoxelBuffer assemble_values(VoxelType type, const std::vector<std::vector<std::byte>>& of_class,
                            std::span<const ClassId> class_volume) {
  VoxelBuffer values{type, {}};
  const std::size_t voxel_bytes = bytes_of(values.type);
  values.bytes.resize(class_volume.size() * voxel_bytes);
  std::vector<std::size_t> next(of_class.size(), 0);
  TaskPace pace;
  for (std::size_t v = 0; v < class_volume.size();) {
    pace.step();
    const ClassId c = class_volume[v];
    std::size_t end = v + 1;
    while (end < class_volume.size() && class_volume[end] == c) ++end;
    const std::size_t run_bytes = (end - v) * voxel_bytes;
    std::memcpy(values.bytes.data() + v * voxel_bytes, of_class[c].data() + next[c], run_bytes);
    next[c] += run_bytes;
    v = end;
  }
  return values;
}

}  // namespace

Result<AtlasContent> Atlas::read_classes() const {
  return impl_->guarded([&]() -> Result<AtlasContent> {
    AtlasContent content;
    content.source_grid = source_grid();
    content.source_to_storage = source_to_storage();
    content.graph = graph();
    content.classes = classes();
    content.label_type = label_type();
    content.display = display();
    content.scenes = scenes();
    content.provenance = provenance();
    SPLATLAS_ASSIGN_OR_RETURN(content.class_volume, read_class_volume(*this));
    return content;
  });
}

Result<VoxelBuffer> Atlas::read_value_volume(std::span<const ClassId> class_volume) const {
  return impl_->guarded([&]() -> Result<VoxelBuffer> {
    if (value_type() == VoxelType::kNone) return VoxelBuffer{};
    check_memory(2 * static_cast<double>(grid().voxels()) * static_cast<double>(bytes_of(value_type())));
    std::vector<std::vector<std::byte>> of_class(classes().size());
    for (ClassId c = 0; c < of_class.size(); ++c) {
      SPLATLAS_ASSIGN_OR_RETURN(of_class[c], read_values(c));
    }
    return assemble_values(value_type(), of_class, class_volume);
  });
}

Result<AtlasContent> Atlas::read_all() const {
  return impl_->guarded([&]() -> Result<AtlasContent> {
    SPLATLAS_ASSIGN_OR_RETURN(AtlasContent content, read_classes());
    SPLATLAS_ASSIGN_OR_RETURN(content.values, read_value_volume(content.class_volume));
    for (StructureIndex s = 0; s < graph().size(); ++s) {
      SPLATLAS_ASSIGN_OR_RETURN(SurfaceMesh mesh, read_surface(s));
      content.surfaces.push_back(std::move(mesh));
    }
    for (ClassId c = 0; c < classes().size(); ++c) {
      SPLATLAS_ASSIGN_OR_RETURN(auto normals, read_normals(c));
      content.boundary_normals.push_back(std::move(normals));
    }
    return content;
  });
}

}  // namespace splatlas
