#include "format/file/encode_group.h"

#include "format/codec/value_codec.h"
#include "format/derive/block_means.h"

namespace splatlas {

EncodedMeans encode_group(const AtlasContent& content, const RunModel& runs, const ValueGroups& groups,
                          std::size_t group, bool means, std::span<std::byte> code) {
  // Gather the values in memory order
  const Index3 size = storage_grid(content).size;
  const VoxelType type = content.values.type;
  std::vector<ClassRuns> of_classes;
  for (const ClassId c : groups.locating_classes(group)) of_classes.push_back(runs.classes[c]);
  const std::vector<ClassSpan> spans = group_spans(groups, group, of_classes, size);
  const GroupVoxels voxels{spans, group_voxels(groups, content.classes, group),
                           group_box(groups, content.classes, group, size), size[1]};
  std::vector<std::byte> values;
  const std::size_t value_bytes = bytes_of(type);
  values.reserve(voxels.voxels * value_bytes);
  for (const ClassSpan& span : spans) {
    const std::uint64_t first = span.run.scanline * static_cast<std::uint64_t>(size[0]) + span.run.start;
    const std::byte* const from = content.values.bytes.data() + first * value_bytes;
    values.insert(values.end(), from, from + span.run.length * value_bytes);
  }

  encode_values(voxels, type, values, code);
  if (!means || !may_have_means(voxels.box)) return {};
  const GroupBlocks blocks = blocks_of(spans, voxels.box, size);
  const GroupVoxels coarse{blocks.spans, blocks.voxels.size(), box_of_blocks(voxels.box),
                           blocks_of_grid(size)[1]};
  return {static_cast<std::uint32_t>(coarse.voxels),
          encode_values(coarse, type, block_means(spans, voxels.box, size, type, values))};
}

}  // namespace splatlas
