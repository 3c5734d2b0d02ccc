// Reading of runs, stored or derived, and their checks.

#include "format/codec/mask_codec.h"
#include "format/codec/run_codec.h"
#include "format/derive/distinct_colors.h"
#include "format/file/reader/atlas_impl.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// Limit of derive_runs(): its memory may grow with the number of voxels.
constexpr std::uint64_t kMaxDerivedVoxels = std::uint64_t{1} << 32;

}  // namespace

Result<ClassRuns> Atlas::Impl::read_stored_runs(ClassId c, Axis axis) const {
  if (shares_runs(c, axis)) {
    SPLATLAS_ASSIGN_OR_RETURN(const SharedSplit split, read_split_runs(c, axis));
    return c == run_streams.pair_of(c)[0] ? split->interior : split->boundary;
  }
  SPLATLAS_ASSIGN_OR_RETURN(ClassRuns runs,
                            read_run_list(c, axis, c == kEmptyClass ? 0 : directory.classes.voxels(c)));
  SPLATLAS_RETURN_IF_ERROR(count_runs(c, axis, runs.size()));
  SPLATLAS_RETURN_IF_ERROR(check_voxels(c, axis, runs));
  return runs;
}

Result<void> Atlas::Impl::count_runs(ClassId c, Axis axis, std::size_t runs) const {
  const auto a = static_cast<std::size_t>(axis);
  {
    const std::lock_guard lock(runs_mutex);
    if (runs_counted[a][c]) return {};
    if (runs <= directory.run_totals[a] - runs_read[a]) {
      runs_read[a] += runs;
      runs_counted[a][c] = true;
      return {};
    }
  }
  return named(ErrorCode::kInvalidAtlas, "invalid: {} has more than the {} runs that the directory states",
               section_name(run_section(axis)), directory.run_totals[a]);
}

bool Atlas::Impl::shares_runs(ClassId c, Axis axis) const {
  return run_streams.is_shared(directory.classes, c, [&](ClassId of) {
    return directory.run_bytes[of][static_cast<std::size_t>(axis)];
  });
}

Result<Atlas::Impl::SharedSplit> Atlas::Impl::read_split_runs(ClassId c, Axis axis) const {
  const ClassId first = run_streams.pair_of(c)[0];
  {
    const std::lock_guard lock(recent_mutex);
    for (const RecentSplit& recent : recent_splits) {
      if (recent.first == first && recent.axis == axis) return recent.runs;
    }
  }
  SPLATLAS_ASSIGN_OR_RETURN(SplitRuns split, split_runs(c, axis));
  const SharedSplit shared = std::make_shared<const SplitRuns>(std::move(split));
  const std::lock_guard lock(recent_mutex);
  recent_splits.push_back({first, axis, shared});
  if (recent_splits.size() > kMaxRecentSplits) recent_splits.pop_front();
  return shared;
}

Result<SplitRuns> Atlas::Impl::split_runs(ClassId c, Axis axis) const {
  const auto pair = run_streams.pair_of(c);
  const std::uint64_t interior = directory.classes.voxels(pair[0]);
  const std::uint64_t boundary = directory.classes.voxels(pair[1]);
  SPLATLAS_ASSIGN_OR_RETURN(const ClassRuns runs, read_run_list(pair[0], axis, interior + boundary));
  SplitRuns split = split_boundary(runs, grid.size, axis);
  std::uint64_t found = 0;
  for (const Run& run : split.interior) found += run.length;
  if (found != interior) {
    return named(ErrorCode::kInvalidAtlas,
                 "invalid: {} of class {}: {} voxels are interior to classes {} and {}, expected {}",
                 section_name(run_section(axis)), pair[0], found, pair[0], pair[1], interior);
  }
  SPLATLAS_RETURN_IF_ERROR(count_runs(pair[0], axis, split.interior.size() + split.boundary.size()));
  SPLATLAS_RETURN_IF_ERROR(check_voxels(pair[0], axis, split.interior));
  SPLATLAS_RETURN_IF_ERROR(check_voxels(pair[1], axis, split.boundary));
  return split;
}

Result<void> Atlas::Impl::check_voxels(ClassId c, Axis axis, const ClassRuns& runs) const {
  if (c == kEmptyClass) return {};
  if (box_of(runs, grid.size, axis) != directory.classes.box(c)) {
    return named(ErrorCode::kInvalidAtlas, "invalid: the box of class {} does not match its {}", c,
                 section_name(run_section(axis)));
  }
  if (fingerprinter.of(runs, axis) == directory.fingerprints[c]) return {};
  return named(ErrorCode::kInvalidAtlas, "invalid: {} of class {} covers other voxels than its fingerprint",
               section_name(run_section(axis)), c);
}

IndexBox Atlas::Impl::list_box(ClassId c, Axis axis) const {
  IndexBox box = directory.classes.box(c);
  if (shares_runs(c, axis)) box.include(directory.classes.box(run_streams.pair_of(c)[1]));
  return box;
}

Result<ClassRuns> Atlas::Impl::read_run_list(ClassId c, Axis axis, std::uint64_t voxels) const {
  SPLATLAS_ASSIGN_OR_RETURN(const auto bytes, read_stream(run_section(axis), c));
  const bool is_mask = !bytes.empty() && bytes.front() == kMaskMark;
  auto runs = is_mask ? decode_mask(bytes, list_box(c, axis), grid.size, axis, voxels)
                      : decode_run_list(bytes, voxels);
  const Result<void> valid =
      runs ? validate_runs(*runs, grid.size, axis, voxels) : tl::unexpected(runs.error());
  if (!valid) {
    return named(ErrorCode::kInvalidAtlas, "invalid: {} of class {}: {}", section_name(run_section(axis)), c,
                 valid.error().message);
  }
  return runs;
}

Result<ClassRuns> Atlas::Impl::derive_runs(ClassId c, Axis axis) const {
  if (const std::uint64_t voxels = directory.classes.voxels(c);
      c != kEmptyClass && voxels > kMaxDerivedVoxels) {
    return named(ErrorCode::kLimit, "class {} has {} voxels, too many to derive a run model from another", c,
                 voxels);
  }
  SPLATLAS_ASSIGN_OR_RETURN(const ClassRuns runs, read_stored_runs(c, Axis::kZ));
  ClassRuns derived = convert_runs(runs, grid.size, Axis::kZ, axis);
  SPLATLAS_RETURN_IF_ERROR(count_runs(c, axis, derived.size()));
  return derived;
}

Result<ClassRuns> Atlas::read_runs(ClassId c, Axis axis) const {
  SPLATLAS_RETURN_IF_ERROR(impl_->check_class(c));
  const auto read = [&] {
    return impl_->layout.find(run_section(axis)) ? impl_->read_stored_runs(c, axis)
                                                 : impl_->derive_runs(c, axis);
  };
  return impl_->guarded(read, " for the runs of class {}", c);
}

void Atlas::forget_runs() const {
  const std::lock_guard lock(impl_->recent_mutex);
  std::size_t runs = 0;
  for (const auto& recent : impl_->recent_splits)
    runs += recent.runs->interior.size() + recent.runs->boundary.size();
  if (runs * sizeof(Run) > (std::size_t{8} << 20)) impl_->recent_splits.clear();
}

Result<std::vector<Rgb>> Atlas::distinct_colors() const {
  const auto find = [&]() -> Result<std::vector<Rgb>> {
    check_memory(static_cast<double>(this->runs(Axis::kZ)) * sizeof(Run));
    std::vector<ClassRuns> runs(classes().size());
    std::vector<std::optional<Rgb>> kept;
    for (const Structure& structure : graph().structures())
      kept.push_back(structure.external ? std::nullopt : std::optional(structure.color));
    for (ClassId c = 0; c < runs.size(); ++c) {
      for (const Membership& member : classes().members(c)) kept[member.structure].reset();
      SPLATLAS_ASSIGN_OR_RETURN(runs[c], impl_->read_stored_runs(c, Axis::kZ));
    }
    return splatlas::distinct_colors(touching_structures(kept.size(), classes(), runs, grid().size), kept);
  };
  return impl_->guarded(find, " for the colours of structures");
}

}  // namespace splatlas
