// Atlas::verify: checksums of all chunks and consistency of all sections.
#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "format/file/reader/atlas_impl.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {

namespace {

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
