// Decoding of whole atlases: Atlas::read_all, read_classes and read_value_volume, and Atlas::verify:
// checksums of all chunks and consistency of all sections.
#include <algorithm>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

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

/// Verifies the run models class by class; reading checks each list. Memory: the runs of the largest class
/// and 24 bytes per run of the z model, but no volume.
class RunVerifier {
 public:
  explicit RunVerifier(const Atlas& atlas) : atlas_(atlas) {}

  [[nodiscard]] Result<void> verify() {
    check_memory(static_cast<double>(atlas_.runs(Axis::kZ)) * sizeof(Span));
    spans_.reserve(atlas_.runs(Axis::kZ));  // more are refused when they are read
    for (ClassId c = 1; c < atlas_.classes().size(); ++c) {
      SPLATLAS_ASSIGN_OR_RETURN(const ClassRuns runs, atlas_.read_runs(c, Axis::kZ));
      add(c, runs);
      for (const Axis axis : {Axis::kX, Axis::kY}) {
        SPLATLAS_ASSIGN_OR_RETURN(const ClassRuns others, atlas_.read_runs(c, axis));
        totals_[static_cast<std::size_t>(axis)] += others.size();
      }
    }
    SPLATLAS_RETURN_IF_ERROR(check_totals());
    SPLATLAS_RETURN_IF_ERROR(check_overlap());
    return check_empty_class();
  }

 private:
  struct Span {
    std::uint64_t scanline;
    std::uint32_t start, end;
    ClassId of;
    friend auto operator<=>(const Span&, const Span&) = default;
  };

  template <typename... Args>
  [[nodiscard]] tl::unexpected<Error> invalid(fmt::format_string<Args...> text, Args&&... args) const {
    return invalid_atlas("{}: invalid: {}", atlas_.name(), fmt::format(text, std::forward<Args>(args)...));
  }

  void add(ClassId c, const ClassRuns& runs) {
    for (const Run& run : runs) spans_.push_back({run.scanline, run.start, run.start + run.length, c});
    totals_[2] += runs.size();
  }

  [[nodiscard]] Result<void> check_totals() const {
    for (const Axis axis : kAxes) {
      const std::uint64_t counted = totals_[static_cast<std::size_t>(axis)];
      if (counted != atlas_.runs(axis)) {
        return invalid("{} has {} runs, the directory says {}", section_name(run_section(axis)), counted,
                       atlas_.runs(axis));
      }
    }
    return {};
  }

  /// Checks that no two classes contain the same voxel. validate() has checked the total number of voxels.
  [[nodiscard]] Result<void> check_overlap() {
    TaskPace pace;
    std::ranges::sort(spans_, [&](const Span& a, const Span& b) {
      pace.step();
      return a < b;
    });
    const auto overlap = std::adjacent_find(spans_.begin(), spans_.end(), [](const Span& a, const Span& b) {
      return a.scanline == b.scanline && a.end > b.start;
    });
    if (overlap == spans_.end()) return {};
    return invalid("runs_z of classes {} and {} overlap in scanline {}", overlap->of, (overlap + 1)->of,
                   overlap->scanline);
  }

  /// Checks the box of class 0, the complement of the other classes. An empty box is valid.
  [[nodiscard]] Result<void> check_empty_class() const {
    const IndexBox& box = atlas_.classes().box(kEmptyClass);
    if (box.empty() || box == box_of_gaps()) return {};
    return invalid("the box of class 0 does not match its voxels");
  }

  /// Bounding box of the complement of the sorted spans.
  [[nodiscard]] IndexBox box_of_gaps() const {
    const Index3& size = atlas_.grid().size;
    IndexBox box;
    const auto include = [&](std::uint64_t scanline, std::int64_t first, std::int64_t end) {
      const auto j = static_cast<std::int64_t>(scanline) % size[1];
      const auto k = static_cast<std::int64_t>(scanline) / size[1];
      if (first < end) box.include(IndexBox{{first, j, k}, {end - 1, j, k}});
    };
    std::uint64_t next = 0;  // scanline
    // The box of whole scanlines follows from the first, the last, and both sides of a slice boundary.
    const auto include_until = [&](std::uint64_t end) {
      if (next == end) return;
      const std::uint64_t last = end - 1, slice = last - last % static_cast<std::uint64_t>(size[1]);
      include(next, 0, size[0]);
      include(last, 0, size[0]);
      if (slice <= next) return;
      include(slice - 1, 0, size[0]);
      include(slice, 0, size[0]);
    };
    TaskPace pace;
    for (auto span = spans_.begin(); span != spans_.end(); ++next) {
      pace.step();
      include_until(span->scanline);
      next = span->scanline;
      std::int64_t at = 0;
      for (; span != spans_.end() && span->scanline == next; ++span) {
        include(next, at, span->start);
        at = span->end;
      }
      include(next, at, size[0]);
    }
    include_until(static_cast<std::uint64_t>(size[1] * size[2]));
    return box;
  }

  const Atlas& atlas_;
  std::vector<Span> spans_;
  std::array<std::uint64_t, 3> totals_{};
};

Result<void> verify_order(const Atlas& atlas) {
  const std::vector<ClassId> order = storage_order(atlas.classes(), atlas.graph());
  if (std::ranges::is_sorted(order)) return {};
  return fail(ErrorCode::kInvalidAtlas, atlas.name() + ": invalid: classes are not in storage order");
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

Result<void> Atlas::verify() const {
  return impl_->guarded([&]() -> Result<void> {
    for (const SectionLayout& section : impl_->layout.sections) {
      const auto n = static_cast<std::size_t>(&section - impl_->layout.sections.data());
      for (std::uint32_t chunk = 0; chunk < impl_->directory.sections[n].chunks; ++chunk) {
        if (auto sound = impl_->sections.check_chunk_of(section, chunk); !sound)
          return impl_->named(sound.error());
      }
    }
    SPLATLAS_RETURN_IF_ERROR(verify_order(*this));
    SPLATLAS_RETURN_IF_ERROR(RunVerifier(*this).verify());
    for (std::size_t g = 0; g < impl_->groups.size(); ++g) SPLATLAS_RETURN_IF_ERROR(impl_->verify_values(g));
    for (StructureIndex s = 0; s < graph().size(); ++s) SPLATLAS_RETURN_IF_ERROR(read_surface(s));
    return {};
  });
}

}  // namespace splatlas
