#include "format/content/run_model.h"

#include <algorithm>
#include <limits>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// Sizes and memory strides of the scanlines of one principal axis.
struct Scanlines {
  std::int64_t slices, rows, length;
  std::int64_t slice_stride, row_stride, scan_stride;  // strides in voxels

  Scanlines(const Index3& size, Axis axis) {
    const std::array<std::int64_t, 3> step{1, size[0], size[0] * size[1]};
    const ScanOrder order = ScanOrder::of(axis);
    slices = size[order.slice_axis];
    rows = size[order.row_axis];
    length = size[order.scan_axis];
    slice_stride = step[order.slice_axis];
    row_stride = step[order.row_axis];
    scan_stride = step[order.scan_axis];
  }

  [[nodiscard]] std::uint64_t count() const {
    return static_cast<std::uint64_t>(slices) * static_cast<std::uint64_t>(rows);
  }
  /// Memory offset of the first voxel of a scanline.
  [[nodiscard]] std::int64_t offset(std::uint64_t scanline) const {
    const auto n = static_cast<std::int64_t>(scanline);
    return n / rows * slice_stride + n % rows * row_stride;
  }
};

/// Calls emit(class, start, length) for the runs of one scanline, except those of the empty class.
template <typename Emit>
void cut_scanline(const ClassId* voxels, std::uint32_t length, const Emit& emit) {
  for (std::uint32_t start = 0; start < length;) {
    const ClassId c = voxels[start];
    std::uint32_t end = start + 1;
    while (end < length && voxels[end] == c) ++end;
    if (c != kEmptyClass) emit(c, start, end - start);
    start = end;
  }
}

/// Scanlines along i: contiguous in memory.
void encode_along_i(std::span<const ClassId> volume, const Scanlines& lines, RunModel& model) {
  const auto length = static_cast<std::uint32_t>(lines.length);
  for (std::uint64_t scanline = 0; scanline < lines.count(); ++scanline) {
    cut_scanline(volume.data() + lines.offset(scanline), length,
                 [&](ClassId c, std::uint32_t start, std::uint32_t n) {
                   model.classes[c].push_back({scanline, start, n});
                 });
  }
}

/// Scanlines along j, in blocks of sixteen slices i: one cache line of class ids covers the block.
void encode_along_j(std::span<const ClassId> volume, const Scanlines& lines, RunModel& model) {
  constexpr std::int64_t kBlock = 16;
  struct ClassRun {
    ClassId id;
    Run run;
  };
  const auto length = static_cast<std::size_t>(lines.length);
  std::vector<ClassId> block(kBlock * length);
  std::array<std::vector<ClassRun>, kBlock> pending;  // per slice, until all earlier slices are done
  for (std::int64_t first = 0; first < lines.slices; first += kBlock) {
    const auto width = static_cast<std::size_t>(std::min(kBlock, lines.slices - first));
    for (std::int64_t k = 0; k < lines.rows; ++k) {
      const ClassId* plane = volume.data() + k * lines.row_stride + first;
      for (std::size_t j = 0; j < length; ++j) {
        const ClassId* row = plane + static_cast<std::int64_t>(j) * lines.scan_stride;
        for (std::size_t i = 0; i < width; ++i) block[i * length + j] = row[i];
      }
      for (std::size_t i = 0; i < width; ++i) {
        const auto scanline =
            static_cast<std::uint64_t>((first + static_cast<std::int64_t>(i)) * lines.rows + k);
        cut_scanline(&block[i * length], static_cast<std::uint32_t>(length),
                     [&](ClassId c, std::uint32_t start, std::uint32_t n) {
                       pending[i].push_back({c, {scanline, start, n}});
                     });
      }
    }
    for (auto& slice : pending) {
      for (const auto& [c, run] : slice) model.classes[c].push_back(run);
      slice.clear();
    }
  }
}

Result<void> check_inside(const Run& run, const Scanlines& lines) {
  const std::uint64_t end = std::uint64_t{run.start} + run.length;
  if (run.length > 0 && run.scanline < lines.count() && end <= static_cast<std::uint64_t>(lines.length))
    return {};
  return invalid_atlas("run of {} voxels at {} of scanline {} is not inside {} scanlines of {} voxels",
                       run.length, run.start, run.scanline, lines.count(), lines.length);
}

tl::unexpected<Error> out_of_order(const Run& run) {
  return invalid_atlas("run at {} of scanline {} is out of order, or not apart from the run before it",
                       run.start, run.scanline);
}

/// Stable sort by a key below 2^48. Counting sort, in linear time, if keys are dense, as in most classes.
template <typename Key>
void stable_sort_by(ClassRuns& runs, const Key& key) {
  if (runs.empty()) return;
  TaskPace pace;
  const auto by_key = [&](const Run& a, const Run& b) {
    pace.step();
    return key(a) < key(b);
  };
  const auto [smallest, largest] = std::minmax_element(runs.begin(), runs.end(), by_key);
  const std::uint64_t first = key(*smallest);
  const std::uint64_t range = key(*largest) - first + 1;
  if (range > 4 * runs.size() + 1024) {
    std::stable_sort(runs.begin(), runs.end(), by_key);
    return;
  }
  std::vector<std::size_t> next(range + 1);
  for (const Run& run : runs) ++next[key(run) - first + 1];
  for (std::size_t n = 1; n <= range; ++n) next[n] += next[n - 1];
  ClassRuns sorted(runs.size());
  for (const Run& run : runs) sorted[next[key(run) - first]++] = run;
  runs.swap(sorted);
}

/// Transposes each plane k: runs along b, ordered by (k, a, b), become runs along a, ordered by (k, start,
/// b). Scanline numbers are k * 2^32 + a before and k * 2^32 + b after.
ClassRuns transpose_planes(const ClassRuns& runs) {
  std::uint32_t first = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t last = 0;
  for (const Run& run : runs) {
    first = std::min(first, run.start);
    last = std::max(last, run.start + run.length);
  }
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> open(runs.empty() ? 0 : last - first, kNone);  // per b: its latest run in `result`
  ClassRuns result;
  TaskPace pace;
  for (const Run& run : runs) {
    pace.step();
    const std::uint64_t k = run.scanline >> 32u;
    const auto a = static_cast<std::uint32_t>(run.scanline);
    for (std::uint32_t b = run.start; b < run.start + run.length; ++b) {
      std::size_t& latest = open[b - first];
      const std::uint64_t scanline = k << 32u | b;
      if (latest != kNone && result[latest].scanline == scanline &&
          result[latest].start + result[latest].length == a) {
        ++result[latest].length;
      } else {
        latest = result.size();
        if (latest == result.capacity()) check_memory(3.0 * sizeof(Run) * static_cast<double>(latest));
        result.push_back({scanline, a, 1});
      }
    }
  }
  check_memory(3.0 * sizeof(Run) * static_cast<double>(result.size()));  // sorting copies them
  return result;
}

}  // namespace

std::uint64_t RunModel::runs() const {
  std::uint64_t sum = 0;
  for (const ClassRuns& list : classes) sum += list.size();
  return sum;
}

RunModel encode_runs(std::span<const ClassId> volume, const Index3& size, Axis axis,
                     std::size_t class_count) {
  RunModel model{axis, std::vector<ClassRuns>(class_count)};
  const Scanlines lines(size, axis);
  if (lines.scan_stride == 1) {
    encode_along_i(volume, lines, model);
  } else {
    encode_along_j(volume, lines, model);
  }
  return model;
}

Result<std::vector<ClassId>> decode_runs(const RunModel& model, const Index3& size) {
  const Scanlines lines(size, model.axis);
  std::vector<ClassId> volume(static_cast<std::size_t>(size[0] * size[1] * size[2]), kEmptyClass);
  TaskPace pace;
  for (ClassId c = 0; c < model.classes.size(); ++c) {
    if (c == kEmptyClass && !model.classes[c].empty()) return invalid_atlas("the empty class has runs");
    const Run* before = nullptr;
    check_task();
    for (const Run& run : model.classes[c]) {
      pace.step();
      SPLATLAS_RETURN_IF_ERROR(check_inside(run, lines));
      if (before && run < *before) return out_of_order(run);
      before = &run;
      ClassId* voxel = volume.data() + lines.offset(run.scanline) + run.start * lines.scan_stride;
      for (std::uint32_t n = 0; n < run.length; ++n, voxel += lines.scan_stride) {
        if (*voxel != kEmptyClass) {
          return invalid_atlas("runs of classes {} and {} overlap in scanline {}", *voxel, c, run.scanline);
        }
        *voxel = c;
      }
    }
  }
  return volume;
}

Result<void> validate_runs(std::span<const Run> runs, const Index3& size, Axis axis, std::uint64_t voxels) {
  const Scanlines lines(size, axis);
  std::uint64_t sum = 0;
  const Run* before = nullptr;
  TaskPace pace;
  for (const Run& run : runs) {
    pace.step();
    SPLATLAS_RETURN_IF_ERROR(check_inside(run, lines));
    if (before) {
      const std::uint64_t end = std::uint64_t{before->start} + before->length;
      const bool after =
          run.scanline > before->scanline || (run.scanline == before->scanline && run.start > end);
      if (!after) return out_of_order(run);
    }
    before = &run;
    sum += run.length;  // cannot overflow: ordered runs inside the grid
  }
  if (sum != voxels) return invalid_atlas("runs cover {} voxels, {} expected", sum, voxels);
  return {};
}

IndexBox box_of(std::span<const Run> runs, const Index3& size, Axis axis) {
  const ScanOrder order = ScanOrder::of(axis);
  const auto rows = static_cast<std::uint64_t>(size[order.row_axis]);
  std::uint32_t first = std::numeric_limits<std::uint32_t>::max(), end = 0;
  std::uint64_t first_row = rows, last_row = 0, scanline = ~std::uint64_t{0};
  for (const Run& run : runs) {
    first = std::min(first, run.start);
    end = std::max(end, run.start + run.length);
    if (run.scanline == scanline) continue;
    scanline = run.scanline;
    first_row = std::min(first_row, scanline % rows);
    last_row = std::max(last_row, scanline % rows);
  }
  IndexBox box;
  if (runs.empty()) return box;
  const auto set = [&](std::size_t a, std::uint64_t low, std::uint64_t high) {
    box.first[a] = static_cast<std::int64_t>(low);
    box.last[a] = static_cast<std::int64_t>(high);
  };
  set(order.scan_axis, first, end - 1);
  set(order.row_axis, first_row, last_row);
  set(order.slice_axis, runs.front().scanline / rows, runs.back().scanline / rows);
  return box;
}

ClassRuns convert_runs(std::span<const Run> runs, const Index3& size, Axis from, Axis to) {
  ClassRuns result(runs.begin(), runs.end());
  if (from == to) return result;

  // A scanline number combines index k and another index: move k to the high 32 bits.
  const auto low = [](const Run& run) { return run.scanline & 0xffffffffu; };
  const auto high = [](const Run& run) { return run.scanline >> 32u; };
  const auto rows_of = [&](Axis axis) {
    return static_cast<std::uint64_t>(size[ScanOrder::of(axis).row_axis]);
  };
  const std::uint64_t from_rows = rows_of(from);
  for (Run& run : result) {
    const std::uint64_t slice = run.scanline / from_rows;
    const std::uint64_t row = run.scanline % from_rows;
    run.scanline = from == Axis::kZ ? slice << 32u | row : row << 32u | slice;
  }
  if (from == Axis::kX || to == Axis::kX) {
    if (from != Axis::kZ) stable_sort_by(result, high);
    result = transpose_planes(result);
    stable_sort_by(result, low);
    if (to == Axis::kZ) stable_sort_by(result, high);
  } else if (to == Axis::kZ) {
    stable_sort_by(result, high);
  } else {
    stable_sort_by(result, low);
  }
  const std::uint64_t to_rows = rows_of(to);
  for (Run& run : result) {
    run.scanline = to == Axis::kZ ? high(run) * to_rows + low(run) : low(run) * to_rows + high(run);
  }
  return result;
}

}  // namespace splatlas
