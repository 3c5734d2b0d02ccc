// A voxel is predicted from preceding neighbours by a linear filter fitted to its group. Residuals are sorted
// into buckets by the prediction errors of the neighbours, so that each bucket has one distribution. The
// decoder's dependency on the previous voxel is only one product. See docs/atlas_format.md, Values.
#include "format/codec/value_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>

#include "format/codec/run_codec.h"
#include "format/codec/value_window.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

constexpr std::size_t kBuckets = 16;
constexpr std::size_t kCountsBytes = kBuckets * sizeof(std::uint32_t);
/// Bucket counts, weights, error shift and one byte that is 0.
constexpr std::size_t kHeaderBytes = kCountsBytes + sizeof(ValueWeights) + 2;
constexpr std::uint64_t kMaxWindowVoxels = std::uint64_t{1} << 24;
constexpr std::uint8_t kMaxErrorShift = 15;

/// Bucket by neighbour error: half octaves.
constexpr auto kBucketOf = [] {
  std::array<std::uint8_t, 256> buckets{};
  for (unsigned errors = 1; errors < buckets.size(); ++errors) {
    const auto octave = static_cast<unsigned>(std::bit_width(errors)) - 1;
    const unsigned half = octave == 0 ? 0 : errors >> (octave - 1) & 1;
    buckets[errors] = static_cast<std::uint8_t>(std::min<std::size_t>(2 * octave + half + 1, kBuckets - 1));
  }
  return buckets;
}();

/// Calls code_run(begin, end) for the maximal runs of the group: merges adjacent spans.
template <typename Lane, typename CodeRun>
void walk(const GroupVoxels& group, ValueWindow<Lane>& window, CodeRun&& code_run) {
  for (std::size_t n = 0; n < group.spans.size();) {
    const Run& first = group.spans[n].run;
    const auto scanline = static_cast<std::int64_t>(first.scanline);
    std::int64_t end = std::int64_t{first.start} + first.length;
    for (++n; n < group.spans.size(); ++n) {
      const Run& next = group.spans[n].run;
      if (next.scanline != first.scanline || next.start != end) break;
      end += next.length;
    }
    window.go_to(scanline % group.rows, scanline / group.rows);
    code_run(std::int64_t{first.start}, end);
  }
}

/// Offset that maps signed values to 0 and above.
std::int32_t offset_of(VoxelType type) {
  return type == VoxelType::kInt8 ? 0x80 : type == VoxelType::kInt16 ? 0x8000 : 0;
}
/// Stored bytes of a value that is computed in a Lane.
template <typename Lane>
constexpr std::size_t kValueBytes = sizeof(Lane) / 2;

bool spans_fit(const GroupVoxels& group) {
  const IndexBox& box = group.box;
  std::uint64_t voxels = 0;
  for (const ClassSpan& span : group.spans) {
    const auto scanline = static_cast<std::int64_t>(span.run.scanline);
    const std::int64_t j = scanline % group.rows, k = scanline / group.rows;
    if (span.run.start < box.first[0] || std::int64_t{span.run.start} + span.run.length - 1 > box.last[0] ||
        j < box.first[1] || j > box.last[1] || k < box.first[2] || k > box.last[2]) {
      return false;
    }
    voxels += span.run.length;
  }
  return voxels == group.voxels;
}

/// Sequential reader of values with their offset added.
template <typename Lane>
class ValueReader {
 public:
  ValueReader(std::span<const std::byte> values, VoxelType type)
      : next_(values.data()), offset_(offset_of(type)) {}

  std::int32_t read() {
    std::uint16_t bits = 0;
    std::memcpy(&bits, next_, kValueBytes<Lane>);
    next_ += kValueBytes<Lane>;
    return (bits + offset_) & ValueWindow<Lane>::kMaxValue;
  }

 private:
  const std::byte* next_;
  const std::int32_t offset_;
};

/// Fits a model to the group's values. Voxels weigh less near large prediction errors of kMeanWeights.
template <typename Lane>
ValueModel fit_model(const GroupVoxels& group, VoxelType type, std::span<const std::byte> values) {
  constexpr std::uint64_t kMaxSampleVoxels = std::uint64_t{1} << 17;
  ValueModel model{kMeanWeights, 0};
  ValueWindow<Lane> window(group.box, model);
  WeightFit fit;
  ValueReader<Lane> reader(values, type);
  const std::uint64_t every = group.voxels / kMaxSampleVoxels + 1;
  std::uint64_t run = 0;
  double errors = 0;
  walk(group, window, [&](std::int64_t begin, std::int64_t end) {
    const bool is_sample = run++ % every == 0;
    window.code_run(begin, end, [&](const ValuePrediction& prediction) {
      const std::int32_t value = reader.read();
      errors += std::abs(ValueWindow<Lane>::difference(value, prediction.value));
      if (is_sample) {
        const float weight = 1.0f / (4.0f + static_cast<float>(prediction.errors));
        fit.add(window.from_before(prediction), static_cast<float>(value - prediction.before),
                weight * std::sqrt(weight));
      }
      return value;
    });
  });
  model.weights = fit.weights();
  const double mean = errors / static_cast<double>(group.voxels);
  while (model.error_shift < kMaxErrorShift && mean > (4 << model.error_shift)) ++model.error_shift;
  return model;
}

template <typename Lane>
void encode(const GroupVoxels& group, VoxelType type, std::span<const std::byte> values,
            std::span<std::byte> code) {
  const ValueModel model = fit_model<Lane>(group, type, values);
  ValueWindow<Lane> window(group.box, model);
  std::array<std::deque<std::uint16_t>, kBuckets> residuals;  // vectors take up to three times as much
  ValueReader<Lane> reader(values, type);
  walk(group, window, [&](std::int64_t begin, std::int64_t end) {
    window.code_run(begin, end, [&](const ValuePrediction& prediction) {
      const std::int32_t value = reader.read();
      const std::int32_t residual = ValueWindow<Lane>::difference(value, prediction.value);
      residuals[kBucketOf[prediction.errors]].push_back(static_cast<std::uint16_t>(zigzag(residual)));
      return value;
    });
  });
  for (std::size_t b = 0; b < kBuckets; ++b) {
    const auto count = static_cast<std::uint32_t>(residuals[b].size());
    std::memcpy(code.data() + b * sizeof count, &count, sizeof count);
  }
  std::memcpy(code.data() + kCountsBytes, model.weights.data(), sizeof model.weights);
  code[kHeaderBytes - 2] = static_cast<std::byte>(model.error_shift);
  code[kHeaderBytes - 1] = {};
  std::byte* to = &code[kHeaderBytes];
  for (std::size_t byte = 0; byte < bytes_of(type); ++byte) {
    for (const std::deque<std::uint16_t>& bucket : residuals) {
      for (const std::uint16_t residual : bucket) *to++ = static_cast<std::byte>(residual >> 8 * byte);
    }
  }
}

/// Sequential reader of the residuals of every bucket.
template <typename Lane>
class ResidualReader {
 public:
  [[nodiscard]] Result<void> open(const GroupVoxels& group, std::span<const std::byte> code) {
    std::array<std::uint32_t, kBuckets> counts{};
    std::memcpy(counts.data(), code.data(), kCountsBytes);
    std::uint64_t sum = 0;
    for (std::size_t b = 0; b < kBuckets; ++b) {
      if (counts[b] > group.voxels - sum) return invalid_atlas("buckets contain more residuals than voxels");
      next_[b] = code.data() + kHeaderBytes + sum;
      sum += counts[b];
      end_[b] = code.data() + kHeaderBytes + sum;
    }
    if (sum != group.voxels) return invalid_atlas("buckets contain fewer residuals than voxels");
    to_high_byte_ = group.voxels;
    return {};
  }

  std::uint32_t read(std::size_t bucket) {
    const std::byte*& from = next_[bucket];
    if (from == end_[bucket]) {
      ran_out_ = true;
      return 0;
    }
    auto residual = std::to_integer<std::uint32_t>(*from);
    if constexpr (sizeof(Lane) == 4) residual |= std::to_integer<std::uint32_t>(from[to_high_byte_]) << 8;
    ++from;
    return residual;
  }
  [[nodiscard]] bool ran_out() const { return ran_out_; }

 private:
  std::array<const std::byte*, kBuckets> next_{}, end_{};
  std::size_t to_high_byte_ = 0;
  bool ran_out_ = false;
};

/// Stores values minus `offset` as bytes of their type.
void put_values(std::span<const std::int16_t> values, std::int32_t offset, std::byte* to) {
  for (std::size_t n = 0; n < values.size(); ++n) to[n] = static_cast<std::byte>(values[n] - offset);
}
void put_values(std::span<const std::int32_t> values, std::int32_t offset, std::byte* to) {
  for (const std::int32_t value : values) {
    const auto bits = static_cast<std::uint16_t>(value - offset);
    std::memcpy(to, &bits, sizeof bits);
    to += sizeof bits;
  }
}

template <typename Lane>
Result<std::vector<std::byte>> decode(const GroupVoxels& group, VoxelType type,
                                      std::span<const std::byte> code) {
  ResidualReader<Lane> residuals;
  SPLATLAS_RETURN_IF_ERROR(residuals.open(group, code));
  ValueModel model{{}, std::to_integer<std::uint8_t>(code[kHeaderBytes - 2])};
  std::memcpy(model.weights.data(), code.data() + kCountsBytes, sizeof model.weights);
  if (model.error_shift > kMaxErrorShift || code[kHeaderBytes - 1] != std::byte{0})
    return invalid_atlas("invalid value model");
  const std::int32_t offset = offset_of(type);
  std::vector<std::byte> values(group.voxels * kValueBytes<Lane>);
  std::byte* to = values.data();
  ValueWindow<Lane> window(group.box, model);
  walk(group, window, [&](std::int64_t begin, std::int64_t end) {
    check_task();
    const auto run = window.code_run(begin, end, [&](const ValuePrediction& prediction) {
      const std::uint32_t residual = residuals.read(kBucketOf[prediction.errors]);
      return (prediction.value + unzigzag(residual)) & ValueWindow<Lane>::kMaxValue;
    });
    put_values(run, offset, to);
    to += run.size() * kValueBytes<Lane>;
  });
  if (residuals.ran_out()) return invalid_atlas("a bucket has too few residuals");
  return values;
}

}  // namespace

void WeightFit::add(const std::array<float, kSize>& from_before, float value, float weight) {
  ++voxels_;
  for (std::size_t a = 0; a < kSize; ++a) {
    const float weighted = weight * from_before[a];
    right_side_[a] += weighted * value;
    for (std::size_t b = 0; b <= a; ++b) products_[a][b] += weighted * from_before[b];
  }
}

ValueWeights WeightFit::weights() const {
  constexpr std::uint64_t kMinVoxels = 300;
  if (voxels_ < kMinVoxels) return kMeanWeights;
  // Cholesky decomposition of the normal matrix, regularized on the diagonal (Tikhonov).
  std::array<std::array<double, kSize>, kSize> lower{};
  std::array<double, kSize> solved{};
  for (std::size_t a = 0; a < kSize; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      double left = products_[a][b] + (a == b ? 1e-3 + 1e-6 * products_[a][a] : 0);
      for (std::size_t c = 0; c < b; ++c) left -= lower[a][c] * lower[b][c];
      lower[a][b] = a == b ? std::sqrt(std::max(left, 1e-9)) : left / lower[b][b];
    }
    solved[a] = right_side_[a];
    for (std::size_t c = 0; c < a; ++c) solved[a] -= lower[a][c] * solved[c];
    solved[a] /= lower[a][a];
  }
  ValueWeights weights{};
  for (std::size_t a = kSize; a-- > 0;) {
    for (std::size_t c = a + 1; c < kSize; ++c) solved[a] -= lower[c][a] * solved[c];
    solved[a] /= lower[a][a];
    weights[a] = static_cast<std::int8_t>(std::lround(std::clamp(solved[a] * kWeightUnit, -128.0, 127.0)));
  }
  return weights;
}

bool predicts_values(VoxelType type, const IndexBox& box, std::uint64_t voxels) {
  const bool is_integer = type == VoxelType::kUInt8 || type == VoxelType::kInt8 ||
                          type == VoxelType::kUInt16 || type == VoxelType::kInt16;
  return is_integer && voxels > 0 && voxels <= std::numeric_limits<std::uint32_t>::max() &&
         window_voxels(box) <= kMaxWindowVoxels;
}

std::uint64_t value_code_bytes(VoxelType type, const IndexBox& box, std::uint64_t voxels) {
  return voxels * bytes_of(type) + (predicts_values(type, box, voxels) ? kHeaderBytes : 0);
}

void encode_values(const GroupVoxels& group, VoxelType type, std::span<const std::byte> values,
                   std::span<std::byte> code) {
  if (!predicts_values(type, group.box, group.voxels)) {
    std::ranges::copy(values, code.begin());
  } else if (bytes_of(type) == 1) {
    encode<std::int16_t>(group, type, values, code);
  } else {
    encode<std::int32_t>(group, type, values, code);
  }
}

std::vector<std::byte> encode_values(const GroupVoxels& group, VoxelType type,
                                     std::span<const std::byte> values) {
  std::vector<std::byte> code(value_code_bytes(type, group.box, group.voxels));
  encode_values(group, type, values, code);
  return code;
}

Result<std::vector<std::byte>> decode_values(const GroupVoxels& group, VoxelType type,
                                             std::span<const std::byte> code) {
  if (!spans_fit(group)) return invalid_atlas("runs do not match the box");
  if (!predicts_values(type, group.box, group.voxels))
    return std::vector<std::byte>(code.begin(), code.end());
  return bytes_of(type) == 1 ? decode<std::int16_t>(group, type, code)
                             : decode<std::int32_t>(group, type, code);
}

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
