#include "preprocess/classify/classify_voxels.h"

#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>

#include "format/result_macros.h"
#include "format/tasks/free_memory.h"
#include "format/tasks/thread_pool.h"

namespace splatlas {
namespace {

using SetId = MembershipVolume::SetId;

/// A combination of memberships, before classes are assigned.
struct Combination {
  SetId set = 0;               ///< structures that contain the voxel
  std::uint32_t crossing = 0;  ///< number of the set of crossing surfaces; 0: none
  std::uint64_t boundary = 0;  ///< bit n: boundary of the n-th structure of `set`
  friend auto operator<=>(const Combination&, const Combination&) = default;
};

struct CombinationHash {
  std::size_t operator()(const Combination& c) const {
    return (c.boundary * 0x9e3779b97f4a7c15u) ^ (c.set * 0xc2b2ae3d27d4eb4fu) ^
           (c.crossing * 0x165667b19e3779f9u);
  }
};

/// Numbers combinations by first occurrence. One table per band of slices.
class CombinationTable {
 public:
  std::uint32_t number(const Combination& c) {
    if (!combinations.empty() && c == combinations[last_]) return last_;
    const auto [entry, is_new] = index_.try_emplace(c, static_cast<std::uint32_t>(combinations.size()));
    if (is_new) combinations.push_back(c);
    return last_ = entry->second;
  }
  std::vector<Combination> combinations;

 private:
  std::unordered_map<Combination, std::uint32_t, CombinationHash> index_;
  std::uint32_t last_ = 0;
};

/// One of the nine rows that contain the 18 neighbours of a voxel.
struct NeighbourRow {
  int dj, dk;

  /// Only the voxel at the same i is a neighbour.
  [[nodiscard]] bool is_diagonal() const { return dj != 0 && dk != 0; }
};
constexpr std::array<NeighbourRow, 9> kNeighbourRows{
    {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};

/// Consecutive slices, the unit of parallel work.
struct Band {
  std::int64_t first_slice = 0, end_slice = 0;
  std::vector<SetId> before, after;  ///< sets of the slices next to the band; empty beyond the grid
  std::vector<Combination> combinations;
  std::vector<ClassId> class_of;  ///< [combination]
};

/// Determines the combinations of a band of slices in place: sets become combination numbers of `table`.
class BandClassifier {
 public:
  explicit BandClassifier(const MembershipVolume& memberships)
      : size_(memberships.size()),
        sets_(memberships.sets()),
        disjoint_(memberships.disjoint()),
        differs_(static_cast<std::size_t>(size_[0])) {}

  void classify(const Band& band, std::span<SetId> voxels) {
    const auto plane = static_cast<std::size_t>(size_[0] * size_[1]);
    std::vector<SetId> before = band.before, own(plane);
    for (std::int64_t k = band.first_slice; k < band.end_slice; ++k) {
      const std::span<SetId> slice = voxels.subspan(static_cast<std::size_t>(k) * plane, plane);
      std::ranges::copy(slice, own.begin());
      const SetId* const after = k + 1 < band.end_slice ? slice.data() + plane
                                 : band.after.empty()   ? nullptr
                                                        : band.after.data();
      slices_ = {before.empty() ? nullptr : before.data(), own.data(), after};
      for (std::int64_t j = 0; j < size_[1]; ++j) classify_row(j, slice);
      before.resize(plane);
      before.swap(own);
    }
  }

  CombinationTable table;

 private:
  void classify_row(std::int64_t j, std::span<SetId> numbers) {
    find_differences(j);
    const SetId* const own = row(j, 0);
    const std::span<SetId> to = numbers.subspan(static_cast<std::size_t>(j * size_[0]), differs_.size());
    for (std::size_t i = 0; i < differs_.size(); ++i) {
      Combination combination{own[i], 0, 0};
      if (differs_[i] != 0 && own[i] != 0)
        combination.boundary = disjoint_ ? 1 : boundary_of_each(static_cast<std::int64_t>(i), j, own[i]);
      to[i] = table.number(combination);
    }
  }

  /// Sets differs_[i] != 0 if any of 18 neighbours is in another set or beyond the grid. The loops vectorize.
  void find_differences(std::int64_t j) {
    const SetId* const own = row(j, 0);
    const std::size_t n = differs_.size();
    std::fill(differs_.begin(), differs_.end(), 0u);
    differs_.front() = differs_.back() = 1;
    for (const NeighbourRow& neighbour : kNeighbourRows) {
      const SetId* const other = row(j + neighbour.dj, neighbour.dk);
      if (other == nullptr) {
        std::fill(differs_.begin(), differs_.end(), 1u);
        return;
      }
      SetId* const differs = differs_.data();
      for (std::size_t i = 0; i < n; ++i) differs[i] |= own[i] ^ other[i];
      if (neighbour.is_diagonal()) continue;
      for (std::size_t i = 1; i < n; ++i) differs[i] |= own[i] ^ other[i - 1];
      for (std::size_t i = 0; i + 1 < n; ++i) differs[i] |= own[i] ^ other[i + 1];
    }
  }

  /// Bit n: some neighbour is outside the n-th structure of `set`.
  std::uint64_t boundary_of_each(std::int64_t i, std::int64_t j, SetId set) {
    std::uint64_t boundary = 0;
    for (const NeighbourRow& neighbour : kNeighbourRows) {
      const SetId* const others = row(j + neighbour.dj, neighbour.dk);
      const std::int64_t reach = neighbour.is_diagonal() ? 0 : 1;
      for (std::int64_t di = -reach; di <= reach; ++di) {
        const bool beyond = others == nullptr || i + di < 0 || i + di >= size_[0];
        const SetId other = beyond ? 0 : others[i + di];
        if (other != set) boundary |= missing(set, other);
      }
    }
    return boundary;
  }

  /// Bit n: the n-th structure of `set` is not in `other`. Memoized.
  std::uint64_t missing(SetId set, SetId other) {
    const auto [entry, is_new] = missing_.try_emplace(std::uint64_t{set} << 32 | other, 0);
    if (is_new) {
      for (std::size_t n = 0; n < sets_[set].size(); ++n) {
        const auto& others = sets_[other];
        const bool found = std::binary_search(others.begin(), others.end(), sets_[set][n]);
        entry->second |= std::uint64_t{!found} << n;
      }
    }
    return entry->second;
  }

  /// Row j of the slice `dk` slices on. Null beyond the grid.
  [[nodiscard]] const SetId* row(std::int64_t j, int dk) const {
    const SetId* const slice = dk < 0 ? slices_[0] : dk == 0 ? slices_[1] : slices_[2];
    return slice == nullptr || j < 0 || j >= size_[1] ? nullptr : slice + j * size_[0];
  }

  Index3 size_;
  std::span<const std::vector<StructureIndex>> sets_;
  bool disjoint_;
  std::array<const SetId*, 3> slices_{};  // the slices before, of and after the row
  std::vector<SetId> differs_;
  std::unordered_map<std::uint64_t, std::uint64_t> missing_;
};

std::vector<Band> cut_into_bands(const Index3& size, std::span<const SetId> voxels) {
  constexpr std::int64_t kMaxBands = 16;  // enough for load balancing
  const std::int64_t slices = size[2], count = std::min(slices, kMaxBands);
  const auto copy_of = [&](std::int64_t k) {
    const auto plane = static_cast<std::size_t>(size[0] * size[1]);
    if (k < 0 || k >= slices) return std::vector<SetId>{};
    const auto slice = voxels.subspan(static_cast<std::size_t>(k) * plane, plane);
    return std::vector<SetId>(slice.begin(), slice.end());
  };
  std::vector<Band> bands(static_cast<std::size_t>(count));
  for (std::int64_t n = 0; n < count; ++n) {
    Band& band = bands[static_cast<std::size_t>(n)];
    band.first_slice = slices * n / count;
    band.end_slice = slices * (n + 1) / count;
    band.before = copy_of(band.first_slice - 1);
    band.after = copy_of(band.end_slice);
  }
  return bands;
}

/// Adds crossing surfaces to the combinations of crossed voxels. Returns the sets of surfaces;
/// Combination::crossing is their index plus 1.
std::vector<std::vector<StructureIndex>> add_crossings(std::span<const CrossedVoxel> crossed,
                                                       std::int64_t voxels_per_slice,
                                                       std::vector<Band>& bands, std::span<SetId> numbers) {
  std::vector<std::vector<StructureIndex>> crossings;
  std::map<std::vector<StructureIndex>, std::uint32_t> index;
  std::size_t band = 0;
  std::map<Combination, std::uint32_t> number_of;  // combinations of the current band with a crossing
  for (std::size_t n = 0; n < crossed.size();) {
    const std::int64_t voxel = crossed[n].voxel;
    std::vector<StructureIndex> surfaces;
    for (; n < crossed.size() && crossed[n].voxel == voxel; ++n) surfaces.push_back(crossed[n].structure);
    for (; bands[band].end_slice * voxels_per_slice <= voxel; ++band) number_of.clear();
    const auto [crossing, is_new] =
        index.try_emplace(surfaces, static_cast<std::uint32_t>(crossings.size() + 1));
    if (is_new) crossings.push_back(std::move(surfaces));
    std::vector<Combination>& combinations = bands[band].combinations;
    SetId& number = numbers[static_cast<std::size_t>(voxel)];
    Combination combination = combinations[number];
    combination.crossing = crossing->second;
    const auto [entry, unseen] =
        number_of.try_emplace(combination, static_cast<std::uint32_t>(combinations.size()));
    if (unseen) combinations.push_back(combination);
    number = entry->second;
  }
  return crossings;
}

std::vector<Membership> members_of(const Combination& c, std::span<const std::vector<StructureIndex>> sets,
                                   std::span<const std::vector<StructureIndex>> crossings) {
  std::vector<Membership> members;
  for (std::size_t n = 0; n < sets[c.set].size(); ++n) {
    members.push_back({sets[c.set][n], (c.boundary >> n & 1) != 0 ? Part::kBoundary : Part::kInterior});
  }
  if (c.crossing != 0) {
    for (const StructureIndex s : crossings[c.crossing - 1]) members.push_back({s, Part::kCrossed});
  }
  return members;
}

/// True for the combinations of a band that still have voxels after add_crossings().
std::vector<bool> find_used(const Band& band, std::int64_t voxels_per_slice, std::span<const SetId> numbers) {
  std::vector<bool> used(band.combinations.size(), false);
  const auto first = static_cast<std::size_t>(band.first_slice * voxels_per_slice);
  const auto end = static_cast<std::size_t>(band.end_slice * voxels_per_slice);
  for (std::size_t v = first; v < end; ++v) used[numbers[v]] = true;
  return used;
}

/// The runs of the classes of a band along z, with their voxels and boxes.
struct BandRuns {
  explicit BandRuns(std::size_t classes) : runs(classes), voxels(classes), boxes(classes) {}

  void add(const Band& band, const Index3& size, std::span<const SetId> numbers) {
    for (std::int64_t k = band.first_slice; k < band.end_slice; ++k) {
      for (std::int64_t j = 0; j < size[1]; ++j) {
        const std::int64_t scanline = k * size[1] + j;
        const SetId* const row = &numbers[static_cast<std::size_t>(scanline * size[0])];
        for (std::int64_t start = 0, end = 0; start < size[0]; start = end) {
          while (end < size[0] && row[end] == row[start]) ++end;
          const ClassId id = band.class_of[row[start]];
          voxels[id] += static_cast<std::uint64_t>(end - start);
          boxes[id].include(IndexBox{{start, j, k}, {end - 1, j, k}});
          if (id != kEmptyClass)
            runs[id].push_back({static_cast<std::uint64_t>(scanline), static_cast<std::uint32_t>(start),
                                static_cast<std::uint32_t>(end - start)});
        }
      }
    }
  }

  std::vector<ClassRuns> runs;
  std::vector<std::uint64_t> voxels;
  std::vector<IndexBox> boxes;
};

}  // namespace

Result<ClassifiedVoxels> classify_voxels(MembershipVolume memberships, std::span<const CrossedVoxel> crossed,
                                         const StructureGraph& graph, unsigned threads) {
  constexpr std::size_t kMaxStructuresPerVoxel = 64;  // bits of Combination::boundary
  for (const auto& set : memberships.sets()) {
    if (set.size() > kMaxStructuresPerVoxel) {
      return fail(ErrorCode::kLimit,
                  "{} structures hold one voxel ('{}' among them); at most {} may; leave out masks",
                  set.size(), graph[set.front()].name, kMaxStructuresPerVoxel);
    }
  }
  // Number the combinations of all voxels, band by band.
  const Index3 size = memberships.size();
  std::vector<SetId> numbers = memberships.take_voxels();
  std::vector<Band> bands = cut_into_bands(size, numbers);
  parallel_for(bands.size(), threads, [&](std::size_t n) {
    BandClassifier classifier(memberships);
    classifier.classify(bands[n], numbers);
    bands[n].combinations = std::move(classifier.table.combinations);
    free_memory(bands[n].before);
    free_memory(bands[n].after);
  });
  const auto crossings = add_crossings(crossed, size[0] * size[1], bands, numbers);

  // Convert combinations to classes in storage order, independent of bands.
  ClassTable found;
  for (Band& band : bands) {
    const std::vector<bool> used = find_used(band, size[0] * size[1], numbers);
    for (std::size_t n = 0; n < used.size(); ++n) {
      const Combination& combination = band.combinations[n];
      band.class_of.push_back(used[n] ? found.intern(members_of(combination, memberships.sets(), crossings))
                                      : kEmptyClass);
    }
  }
  const std::vector<ClassId> order = storage_order(found, graph);
  std::vector<ClassId> new_number(order.size());
  for (ClassId n = 0; n < order.size(); ++n) new_number[order[n]] = n;
  ClassifiedVoxels result{found.renumbered(order), {Axis::kZ, std::vector<ClassRuns>(order.size())}};
  std::vector<BandRuns> band_runs(bands.size(), BandRuns(order.size()));
  parallel_for(bands.size(), threads, [&](std::size_t n) {
    for (ClassId& id : bands[n].class_of) id = new_number[id];
    band_runs[n].add(bands[n], size, numbers);
  });
  free_memory(numbers);
  for (BandRuns& band : band_runs) {
    for (ClassId id = 0; id < order.size(); ++id) {
      result.classes.count(id, band.voxels[id], band.boxes[id]);
      ClassRuns& all = result.runs.classes[id];
      all.insert(all.end(), band.runs[id].begin(), band.runs[id].end());
      free_memory(band.runs[id]);
    }
  }
  return result;
}

}  // namespace splatlas
