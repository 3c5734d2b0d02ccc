#include <algorithm>
#include <iterator>
#include <limits>
#include <tuple>

#include "player/render/decode/class_cache.h"

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
  std::vector<std::int64_t> slices;    // with runs, ascending
  std::vector<std::size_t> first_run;  // of each of them, and the end
  std::uint32_t scan_voxels = 0;       // upper bound of the first voxels of runs

  NewRuns() = default;
  NewRuns(ClassId of, std::span<const Run> all, std::uint64_t rows) : id(of), runs(all) {
    std::uint64_t end_of_slice = 0;  // scanline
    for (std::size_t n = 0; n < all.size(); ++n) {
      if (all[n].scanline >= end_of_slice) {
        const std::uint64_t slice = all[n].scanline / rows;
        slices.push_back(static_cast<std::int64_t>(slice));
        first_run.push_back(n);
        end_of_slice = (slice + 1) * rows;
      }
      scan_voxels = std::max(scan_voxels, all[n].start + 1);
    }
    first_run.push_back(all.size());
  }
  [[nodiscard]] std::span<const Run> of_slice(std::int64_t slice) const {
    const auto found = std::ranges::lower_bound(slices, slice);
    if (found == slices.end() || *found != slice) return {};
    const std::size_t* const first = &first_run[static_cast<std::size_t>(found - slices.begin())];
    return runs.subspan(first[0], first[1] - first[0]);
  }
};

/// Numbers of the slices with runs to insert, ascending.
std::vector<std::int64_t> slices_of(std::span<const NewRuns> classes) {
  std::int64_t first = std::numeric_limits<std::int64_t>::max(), last = -1;
  std::vector<std::int64_t> numbers;
  for (const NewRuns& of_class : classes) {
    if (of_class.slices.empty()) continue;
    first = std::min(first, of_class.slices.front());
    last = std::max(last, of_class.slices.back());
    numbers.insert(numbers.end(), of_class.slices.begin(), of_class.slices.end());
  }
  if (last - first > std::ssize(numbers)) {  // sparse
    std::ranges::sort(numbers);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    return numbers;
  }
  std::vector<bool> occupied(numbers.empty() ? 0 : static_cast<std::size_t>(last - first + 1));
  for (const std::int64_t slice : numbers) occupied[static_cast<std::size_t>(slice - first)] = true;
  numbers.clear();
  for (std::size_t n = 0; n < occupied.size(); ++n) {
    if (occupied[n]) numbers.push_back(first + static_cast<std::int64_t>(n));
  }
  return numbers;
}

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

std::span<const ClassRun> ScanlineRuns::slice(std::int64_t n) const {
  const auto found = std::ranges::lower_bound(numbers_, n);
  if (found == numbers_.end() || *found != n) return {};
  return slices_[static_cast<std::size_t>(found - numbers_.begin())];
}

std::span<const std::int64_t> ScanlineRuns::occupied(std::int64_t first, std::int64_t last) const {
  const auto begin = std::ranges::lower_bound(numbers_, first) - numbers_.begin();
  const auto end = std::ranges::upper_bound(numbers_, last) - numbers_.begin();
  return std::span(numbers_).subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
}

/// Adds the slices that are missing.
void ScanlineRuns::make_room(std::span<const std::int64_t> numbers) {
  std::vector<std::int64_t> all;
  std::set_union(numbers_.begin(), numbers_.end(), numbers.begin(), numbers.end(), std::back_inserter(all));
  if (all.size() == numbers_.size()) return;
  std::vector<std::vector<ClassRun>> slices(all.size());
  for (std::size_t n = 0, before = 0; before < numbers_.size(); ++n) {
    if (all[n] == numbers_[before]) slices[n] = std::move(slices_[before++]);
  }
  numbers_ = std::move(all);
  slices_ = std::move(slices);
}

void ScanlineRuns::insert(std::span<const std::pair<ClassId, const ClassRuns*>> classes, std::int64_t rows,
                          ThreadPool& pool) {
  // Index the new runs by slice
  std::vector<NewRuns> inserted(classes.size());
  pool.for_each(classes.size(), [&](std::size_t n) {
    inserted[n] = NewRuns(classes[n].first, *classes[n].second, static_cast<std::uint64_t>(rows));
  });
  const std::vector<std::int64_t> numbers = slices_of(inserted);
  make_room(numbers);

  // Merge slices in parallel
  pool.for_each(numbers.size(), [&](std::size_t n) {
    const auto place = std::ranges::lower_bound(numbers_, numbers[n]) - numbers_.begin();
    std::vector<ClassRun>& existing = slices_[static_cast<std::size_t>(place)];
    const SliceRuns runs(existing, inserted, numbers[n], rows);
    if (runs.changed()) existing = runs.ordered();
  });
}

}  // namespace splatlas
