#include "preprocess/import/labels/segment_layers.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "preprocess/import/images/import_image.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/structure_name.h"

namespace splatlas {
namespace {

const NoteKind kEmptySegments{"empty-segments", "segment without voxels is dropped",
                              "segments without voxels are dropped", true};
const NoteKind kNoSegment{"values-without-segment", "value belongs to no segment; its voxels are background",
                          "values belong to no segment; their voxels are background", true};
const NoteKind kBadSegmentName{"bad-segment-names", "segment has a name that cannot be used",
                               "segments have names that cannot be used", true};

/// Adds the segments of one layer, and counts their voxels.
class LayerReader {
 public:
  LayerReader(const std::vector<SourceSegment>& segments, std::size_t layer) : layer_(layer) {
    for (StructureIndex n = 0; n < segments.size(); ++n) {
      if (segments[n].layer == layer) structure_of_value_.emplace(segments[n].value, n);
    }
  }

  template <typename T>
  void read(const VoxelBuffer& voxels, MembershipVolume& memberships, std::vector<std::uint64_t>& counts,
            Notes& notes) {
    std::vector<StructureIndex> structures(voxels.bytes.size() / sizeof(T), kNoStructure);
    T last_value = 0;
    StructureIndex last = kNoStructure;
    for (std::size_t v = 0; v < structures.size(); ++v) {
      if (const T value = voxels.as<T>()[v]; !(value == last_value)) {
        last = structure_of(value, notes);
        last_value = value;
      }
      structures[v] = last;
      if (last != kNoStructure) ++counts[last];
    }
    memberships.add_each(structures);
  }

 private:
  template <typename T>
  StructureIndex structure_of(T value, Notes& notes) {
    if (!(value > 0 || value < 0)) return kNoStructure;
    const auto key = static_cast<std::int64_t>(static_cast<double>(value));  // exact: values have 32 bits
    const auto [found, is_new] = structure_of_value_.emplace(key, kNoStructure);
    if (is_new) notes.add(kNoSegment, fmt::format("{} (layer {})", value, layer_ + 1));
    return found->second;
  }

  std::size_t layer_;
  std::map<std::int64_t, StructureIndex> structure_of_value_;
};

/// Drops structures without voxels; the others keep their order.
void drop_empty(ImportedLabels& labels, std::vector<std::uint64_t>& counts) {
  std::vector<StructureIndex> new_numbers(counts.size(), 0);
  std::vector<SourceStructure> kept;
  std::vector<std::uint64_t> kept_counts;
  for (std::size_t n = 0; n < counts.size(); ++n) {
    new_numbers[n] = static_cast<StructureIndex>(kept.size());
    if (counts[n] == 0) {
      labels.notes.add(kEmptySegments, labels.structures[n].name);
    } else {
      kept.push_back(std::move(labels.structures[n]));
      kept_counts.push_back(counts[n]);
    }
  }
  labels.structures = std::move(kept);
  counts = std::move(kept_counts);
  labels.memberships.renumber(new_numbers);
}

}  // namespace

Result<ImportedLabels> read_segments(SourceImage image, const std::string& name) {
  ImportedLabels result;
  result.source_grid = image.grid;
  result.source = name;
  result.notes = std::move(image.notes);
  const AxisOrder order = storage_order(image.grid);
  result.memberships = MembershipVolume(reordered(image.grid, order).size);
  for (const SourceSegment& segment : image.segments) {
    SourceStructure structure = segment.structure;
    if (const auto fit = check_structure_name(structure.name); !fit) {
      structure.name = fmt::format("Segment {}", result.structures.size() + 1);
      result.notes.add(kBadSegmentName, structure.name);
    }
    if (image.layers == 1) structure.label = segment.value;
    result.structures.push_back(std::move(structure));
  }
  std::vector<std::uint64_t> counts(result.structures.size(), 0);
  VoxelBuffer layer{image.voxels.type, {}};
  const std::size_t bytes = static_cast<std::size_t>(image.grid.voxels()) * bytes_of(layer.type);
  for (std::size_t n = 0; n < image.layers; ++n) {
    const auto first = image.voxels.bytes.begin() + static_cast<std::ptrdiff_t>(n * bytes);
    layer.bytes.assign(first, first + static_cast<std::ptrdiff_t>(bytes));
    layer = to_storage_order(std::move(layer), image.grid);
    visit_voxel_type(layer.type, [&]<typename T>(T) {
      LayerReader(image.segments, n).template read<T>(layer, result.memberships, counts, result.notes);
    });
  }
  drop_empty(result, counts);
  if (result.structures.empty()) return bad_file(name, "holds no segment with voxels");
  if (image.layers == 1) {
    result.type = image.voxels.type;
  } else {
    sort_by_size(result, counts);
  }
  return result;
}

void sort_by_size(ImportedLabels& labels, const std::vector<std::uint64_t>& counts) {
  std::vector<StructureIndex> order(counts.size());
  std::iota(order.begin(), order.end(), StructureIndex{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return counts[a] > counts[b]; });
  std::vector<StructureIndex> new_numbers(order.size());
  std::vector<SourceStructure> sorted;
  for (StructureIndex n = 0; n < order.size(); ++n) {
    new_numbers[order[n]] = n;
    sorted.push_back(std::move(labels.structures[order[n]]));
  }
  labels.structures = std::move(sorted);
  labels.memberships.renumber(new_numbers);
}

}  // namespace splatlas
