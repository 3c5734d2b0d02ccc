// Reading of grey values: decoded by group, returned by class.
#include <algorithm>
#include <utility>
#include <vector>

#include "format/codec/value_codec.h"
#include "format/derive/value_groups.h"
#include "format/file/reader/atlas_impl.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// Upper bound of the memory of the means of a group: of a slice of blocks, all blocks, and their runs.
double bytes_of_blocks(const IndexBox& box, std::uint64_t voxels, std::size_t spans,
                       std::size_t value_bytes) {
  constexpr double kPerColumn = 10, kGrowth = 2;
  const IndexBox in_blocks = box_of_blocks(box);
  const auto blocks = static_cast<double>(std::min(voxels, in_blocks.voxels()));
  const double columns = static_cast<double>(in_blocks.voxels()) /
                         static_cast<double>(in_blocks.last[2] - in_blocks.first[2] + 1);
  const double runs = std::min(blocks, static_cast<double>(spans));
  return kPerColumn * columns + kGrowth * (blocks * static_cast<double>(1 + value_bytes) +
                                           runs * static_cast<double>(sizeof(ClassSpan) + sizeof(Run)));
}

}  // namespace

Result<std::vector<ClassSpan>> Atlas::Impl::read_spans(std::size_t group) const {
  const std::vector<ClassId> of = groups.locating_classes(group);
  std::vector<ClassRuns> runs;
  runs.reserve(of.size());
  if (of.front() != kEmptyClass && shares_runs(of.front(), Axis::kZ)) {
    SPLATLAS_ASSIGN_OR_RETURN(const SharedSplit split, read_split_runs(of.front(), Axis::kZ));
    runs = {split->interior, split->boundary};
  }
  for (std::size_t n = runs.size(); n < of.size(); ++n) {
    SPLATLAS_ASSIGN_OR_RETURN(runs.emplace_back(), read_stored_runs(of[n], Axis::kZ));
  }
  return group_spans(groups, group, runs, grid.size);
}

Result<std::vector<std::byte>> Atlas::Impl::decode_values_of(std::size_t group, SectionKind kind,
                                                             const GroupVoxels& voxels) const {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> code, read_stream(kind, group));
  check_memory(3.0 * static_cast<double>(voxels.voxels) *
               static_cast<double>(bytes_of(directory.value_type)));
  auto decoded = decode_values(voxels, directory.value_type, code);
  if (decoded) return decoded;
  return named(ErrorCode::kInvalidAtlas, "invalid: {} of class {}: {}", section_name(kind),
               groups.classes[group].front(), decoded.error().message);
}

Result<ValueCache::GroupValues> Atlas::Impl::decode_group(std::size_t group) const {
  const std::vector<ClassId>& of = groups.classes[group];
  ValueCache::GroupValues values(of.size());
  const std::uint64_t voxels = group_voxels(groups, directory.classes, group);
  if (voxels == 0 || directory.value_type == VoxelType::kNone) return values;
  const IndexBox box = group_box(groups, directory.classes, group, grid.size);
  if (of.size() == 1 && !predicts_values(directory.value_type, box, voxels)) {
    SPLATLAS_ASSIGN_OR_RETURN(values.front(), read_stream(SectionKind::kValues, group));
    return values;  // stored unchanged: no runs needed
  }
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<ClassSpan> spans, read_spans(group));
  SPLATLAS_ASSIGN_OR_RETURN(
      std::vector<std::byte> decoded,
      decode_values_of(group, SectionKind::kValues, {spans, voxels, box, grid.size[1]}));
  check_task();
  if (of.size() == 1) {
    values.front() = std::move(decoded);
    return values;
  }
  const std::size_t value_bytes = bytes_of(directory.value_type);
  for (std::size_t n = 0; n < of.size(); ++n)
    values[n].reserve(directory.classes.voxels(of[n]) * value_bytes);
  const std::byte* next = decoded.data();
  TaskPace pace;
  for (const ClassSpan& span : spans) {
    pace.step();
    const auto n = static_cast<std::size_t>(std::ranges::lower_bound(of, span.of) - of.begin());
    const std::byte* const end = next + span.run.length * value_bytes;
    values[n].insert(values[n].end(), next, end);
    next = end;
  }
  return values;
}

Result<std::vector<std::byte>> Atlas::Impl::read_class_values(ClassId c) const {
  const std::size_t group = groups.group_of[c];
  const std::vector<ClassId>& of = groups.classes[group];
  const auto n = static_cast<std::size_t>(std::ranges::lower_bound(of, c) - of.begin());
  return value_cache.take(group, n, [&] { return decode_group(group); });
}

Result<std::vector<std::byte>> Atlas::read_values(ClassId c) const {
  SPLATLAS_RETURN_IF_ERROR(impl_->check_class(c));
  if (value_type() == VoxelType::kNone) return std::vector<std::byte>{};
  const auto read = [&] { return impl_->read_class_values(c); };
  return impl_->guarded(read, " for the values of class {}", c);
}

bool Atlas::has_means(ClassId c) const {
  const std::vector<std::uint32_t>& blocks = impl_->directory.mean_blocks;
  return !blocks.empty() && blocks[impl_->groups.group_of[c]] > 0;
}

/// Does not divide a shared list: that takes longer than all else.
Result<std::vector<ClassSpan>> Atlas::Impl::read_undivided_spans(std::size_t group) const {
  const ClassId first = groups.classes[group].front();
  if (first == kEmptyClass || !shares_runs(first, Axis::kZ)) return read_spans(group);
  SPLATLAS_ASSIGN_OR_RETURN(const ClassRuns runs,
                            read_run_list(first, Axis::kZ, group_voxels(groups, directory.classes, group)));
  const ClassId second = groups.classes[group].back();
  if (box_of(runs, grid.size, Axis::kZ) != list_box(first, Axis::kZ) ||
      fingerprinter.of(runs, Axis::kZ) !=
          add_fingerprints(directory.fingerprints[first], directory.fingerprints[second])) {
    return named(ErrorCode::kInvalidAtlas, "invalid: runs_z of classes {} and {} cover other voxels", first,
                 second);
  }
  std::vector<ClassSpan> spans;
  spans.reserve(runs.size());
  for (const Run& run : runs) spans.push_back({run, first});
  return spans;
}

Result<BlockMeans> Atlas::Impl::read_group_means(std::size_t group) const {
  const std::uint64_t voxels = group_voxels(groups, directory.classes, group);
  if (voxels == 0) return BlockMeans{};
  const IndexBox box = group_box(groups, directory.classes, group, grid.size);
  if (!may_have_means(box))
    return named(ErrorCode::kLimit, "class {} is too wide for means", groups.classes[group].front());
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<ClassSpan> spans, read_undivided_spans(group));
  check_memory(bytes_of_blocks(box, voxels, spans.size(), bytes_of(directory.value_type)));
  GroupBlocks blocks = blocks_of(spans, box, grid.size);
  BlockMeans means;
  for (const ClassSpan& span : blocks.spans) means.runs.push_back(span.run);
  means.voxels = std::move(blocks.voxels);
  if (directory.value_type == VoxelType::kNone) return means;
  const std::uint64_t stored = directory.mean_blocks.empty() ? 0 : directory.mean_blocks[group];
  if (stored == 0) {
    SPLATLAS_ASSIGN_OR_RETURN(
        const std::vector<std::byte> values,
        decode_values_of(group, SectionKind::kValues, {spans, voxels, box, grid.size[1]}));
    means.values = block_means(spans, box, grid.size, directory.value_type, values);
    return means;
  }
  if (stored != means.voxels.size()) {
    return named(ErrorCode::kInvalidAtlas, "invalid: means of class {}: {} blocks, its voxels give {}",
                 groups.classes[group].front(), stored, means.voxels.size());
  }
  const GroupVoxels of_blocks{blocks.spans, stored, box_of_blocks(box), blocks_of_grid(grid.size)[1]};
  SPLATLAS_ASSIGN_OR_RETURN(means.values, decode_values_of(group, SectionKind::kMeans, of_blocks));
  return means;
}

Result<BlockMeans> Atlas::read_means(ClassId c) const {
  SPLATLAS_RETURN_IF_ERROR(impl_->check_class(c));
  const auto read = [&] { return impl_->read_group_means(impl_->groups.group_of[c]); };
  return impl_->guarded(read, " for the means of class {}", c);
}

Result<void> Atlas::Impl::verify_values(std::size_t group) const {
  if (directory.mean_blocks.empty() || directory.mean_blocks[group] == 0)
    return decode_group(group).map([](const auto&) {});
  SPLATLAS_ASSIGN_OR_RETURN(const BlockMeans stored, read_group_means(group));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<ClassSpan> spans, read_spans(group));
  const IndexBox box = group_box(groups, directory.classes, group, grid.size);
  const GroupVoxels voxels{spans, group_voxels(groups, directory.classes, group), box, grid.size[1]};
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> values,
                            decode_values_of(group, SectionKind::kValues, voxels));
  if (block_means(spans, box, grid.size, directory.value_type, values) == stored.values) return {};
  return named(ErrorCode::kInvalidAtlas, "invalid: means of class {} are not those of its values",
               groups.classes[group].front());
}

}  // namespace splatlas
