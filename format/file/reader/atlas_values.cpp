// Reading of grey values: decoded by group, returned by class.
#include <algorithm>
#include <utility>
#include <vector>

#include "format/codec/value_codec.h"
#include "format/file/reader/atlas_impl.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {

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

Result<ValueCache::GroupValues> Atlas::Impl::decode_group(std::size_t group) const {
  const std::vector<ClassId>& of = groups.classes[group];
  SPLATLAS_ASSIGN_OR_RETURN(std::vector<std::byte> code, read_stream(SectionKind::kValues, group));
  ValueCache::GroupValues values(of.size());
  if (code.empty()) return values;
  const std::uint64_t voxels = group_voxels(groups, directory.classes, group);
  const IndexBox box = group_box(groups, directory.classes, group, grid.size);
  if (of.size() == 1 && !predicts_values(directory.value_type, box, voxels)) {
    values.front() = std::move(code);  // stored unchanged: no runs needed
    return values;
  }
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<ClassSpan> spans, read_spans(group));
  check_memory(3.0 * static_cast<double>(voxels) * static_cast<double>(bytes_of(directory.value_type)));
  auto decoded = decode_values({spans, voxels, box, grid.size[1]}, directory.value_type, code);
  if (!decoded) {
    return named(ErrorCode::kInvalidAtlas, "invalid: values of class {}: {}", of.front(),
                 decoded.error().message);
  }
  check_task();
  if (of.size() == 1) {
    values.front() = std::move(*decoded);
    return values;
  }
  const std::size_t value_bytes = bytes_of(directory.value_type);
  for (std::size_t n = 0; n < of.size(); ++n)
    values[n].reserve(directory.classes.voxels(of[n]) * value_bytes);
  const std::byte* next = decoded->data();
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

}  // namespace splatlas
