#include "player/spans/scanline_runs.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace splatlas {
namespace {

bool in_order(const ClassRun& a, const ClassRun& b) {
  return std::tie(a.row, a.start) < std::tie(b.row, b.start);
}

/// Bitmap of the first voxels of a slice's runs, with prefix sums. The rank of its bit is the index of a run,
/// so that the runs of many classes merge without comparisons.
class RunPlaces {
 public:
  /// Covers voxels [0, scan_voxels) of rows [first_row, last_row).
  RunPlaces(std::uint32_t first_row, std::uint32_t last_row, std::uint32_t scan_voxels)
      : first_row_(first_row),
        row_words_(words_of(scan_voxels)),
        words_((last_row - first_row) * row_words_) {}

  static std::uint64_t words_of(std::uint32_t scan_voxels) { return (std::uint64_t{scan_voxels} + 63) / 64; }

  void mark(const ClassRun& run) { words_[word_of(run)].begins |= std::uint64_t{1} << (run.start % 64); }
  /// Computes the prefix sums, after the last mark(); returns the number of distinct first voxels.
  std::size_t number() {
    std::size_t before = 0;
    for (Word& word : words_) {
      word.before = before;
      before += ones_of(word.begins);
    }
    return before;
  }
  [[nodiscard]] std::size_t place_of(const ClassRun& run) const {
    const Word& word = words_[word_of(run)];
    return word.before + ones_of(word.begins & ((std::uint64_t{1} << (run.start % 64)) - 1));
  }

 private:
  struct Word {
    std::uint64_t begins = 0;
    std::size_t before = 0;
  };
  /// Population count. std::popcount() is a function call for baseline x86-64.
  static std::size_t ones_of(std::uint64_t bits) {
    bits -= (bits >> 1) & 0x5555555555555555;
    bits = (bits & 0x3333333333333333) + ((bits >> 2) & 0x3333333333333333);
    return (((bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0f) * 0x0101010101010101) >> 56;
  }
  [[nodiscard]] std::size_t word_of(const ClassRun& run) const {
    return (run.row - first_row_) * row_words_ + run.start / 64;
  }

  std::uint32_t first_row_;
  std::uint64_t row_words_;
  std::vector<Word> words_;
};

/// The runs of a class to insert, indexed by slice.
struct NewRuns {
  ClassId id = kEmptyClass;
  std::span<const Run> runs;
  std::int64_t first_slice = 0;
  std::vector<std::size_t> first_run;  // of each slice from first_slice on, and the end
  std::uint32_t scan_voxels = 0;       // upper bound of the first voxels of runs

  NewRuns() = default;
  NewRuns(ClassId of, std::span<const Run> all, std::uint64_t rows) : id(of), runs(all) {
    if (all.empty()) return;
    first_slice = static_cast<std::int64_t>(all.front().scanline / rows);
    std::uint64_t slice_begins = static_cast<std::uint64_t>(first_slice) * rows;
    for (std::size_t n = 0; n < all.size(); ++n) {
      for (; all[n].scanline >= slice_begins; slice_begins += rows) first_run.push_back(n);
      scan_voxels = std::max(scan_voxels, all[n].start + 1);
    }
    first_run.push_back(all.size());
  }
  [[nodiscard]] std::int64_t end_slice() const { return first_slice + std::ssize(first_run) - 1; }
  [[nodiscard]] std::span<const Run> of_slice(std::int64_t slice) const {
    if (runs.empty() || slice < first_slice || slice >= end_slice()) return {};
    const std::size_t* const first = &first_run[static_cast<std::size_t>(slice - first_slice)];
    return runs.subspan(first[0], first[1] - first[0]);
  }
};

/// The existing runs of a slice and the runs to insert.
class SliceRuns {
 public:
  SliceRuns(std::span<const ClassRun> existing, std::span<const NewRuns> classes, std::int64_t slice,
            std::int64_t rows)
      : existing_(existing), first_scanline_(static_cast<std::uint64_t>(slice * rows)) {
    if (!existing.empty()) include(existing.front().row, existing.back().row, existing.size());
    for (const ClassRun& run : existing) scan_voxels_ = std::max(scan_voxels_, run.start + 1);
    for (const NewRuns& of_class : classes) {
      const std::span<const Run> runs = of_class.of_slice(slice);
      if (runs.empty()) continue;
      added_.push_back({of_class.id, runs});
      include(row_of(runs.front()), row_of(runs.back()), runs.size());
      scan_voxels_ = std::max(scan_voxels_, of_class.scan_voxels);
    }
  }
  [[nodiscard]] bool changed() const { return !added_.empty(); }

  /// All runs in order. Of runs with the same first voxel, which valid classes never have, one remains.
  [[nodiscard]] std::vector<ClassRun> ordered() const {
    if ((last_row_ - first_row_) * RunPlaces::words_of(scan_voxels_) > 1024 + 4 * count_) return sorted();
    RunPlaces places(first_row_, last_row_, scan_voxels_);
    for_each([&](const ClassRun& run) { places.mark(run); });
    std::vector<ClassRun> runs(places.number());
    for_each([&](const ClassRun& run) { runs[places.place_of(run)] = run; });
    return runs;
  }

 private:
  [[nodiscard]] std::uint32_t row_of(const Run& run) const {
    return static_cast<std::uint32_t>(run.scanline - first_scanline_);
  }
  void include(std::uint32_t first_row, std::uint32_t last_row, std::size_t count) {
    first_row_ = std::min(first_row_, first_row);
    last_row_ = std::max(last_row_, last_row + 1);
    count_ += count;
  }
  template <typename Take>
  void for_each(const Take& take) const {
    for (const ClassRun& run : existing_) take(run);
    for (const auto& [id, runs] : added_) {
      for (const Run& run : runs) take(ClassRun{row_of(run), run.start, run.length, id});
    }
  }
  /// Comparison sort for sparse runs.
  [[nodiscard]] std::vector<ClassRun> sorted() const {
    std::vector<ClassRun> runs;
    for_each([&](const ClassRun& run) { runs.push_back(run); });
    std::stable_sort(runs.begin(), runs.end(), in_order);
    const auto same = [](const ClassRun& a, const ClassRun& b) { return !in_order(a, b); };
    runs.erase(std::unique(runs.begin(), runs.end(), same), runs.end());
    return runs;
  }

  std::span<const ClassRun> existing_;
  std::uint64_t first_scanline_;
  std::vector<std::pair<ClassId, std::span<const Run>>> added_;
  std::uint32_t first_row_ = std::numeric_limits<std::uint32_t>::max(), last_row_ = 0, scan_voxels_ = 0;
  std::size_t count_ = 0;
};

}  // namespace

/// Extends the range to include slices [first, last) of the grid.
void ScanlineRuns::make_room(std::int64_t first, std::int64_t last) {
  if (slices_.empty()) first_ = first;
  if (first < first_) {
    slices_.insert(slices_.begin(), static_cast<std::size_t>(first_ - first), {});
    first_ = first;
  }
  slices_.resize(std::max(slices_.size(), static_cast<std::size_t>(last - first_)));
}

void ScanlineRuns::insert(std::span<const std::pair<ClassId, const ClassRuns*>> classes, std::int64_t rows,
                          ThreadPool& pool) {
  // Index the new runs by slice
  std::vector<NewRuns> inserted(classes.size());
  pool.for_each(classes.size(), [&](std::size_t n) {
    inserted[n] = NewRuns(classes[n].first, *classes[n].second, static_cast<std::uint64_t>(rows));
  });
  std::int64_t first = std::numeric_limits<std::int64_t>::max(), last = 0;
  for (const NewRuns& of_class : inserted) {
    if (of_class.runs.empty()) continue;
    first = std::min(first, of_class.first_slice);
    last = std::max(last, of_class.end_slice());
  }
  if (first >= last) return;
  make_room(first, last);

  // Merge slices in parallel
  pool.for_each(static_cast<std::size_t>(last - first), [&](std::size_t n) {
    const std::int64_t slice = first + static_cast<std::int64_t>(n);
    std::vector<ClassRun>& existing = slices_[static_cast<std::size_t>(slice - first_)];
    const SliceRuns runs(existing, inserted, slice, rows);
    if (runs.changed()) existing = runs.ordered();
  });
}

}  // namespace splatlas
