#include "player/render/sheets/spans/span_model.h"

#include <new>

#include "player/render/decode/sparse_bytes.h"
#include "player/render/light/voxel_light.h"

namespace splatlas {
namespace {

constexpr std::align_val_t kAlignment{64};
constexpr std::size_t kAlignedFloats = 64 / sizeof(float);
constexpr std::size_t kChunkBytes = std::size_t{4} << 20;

std::shared_ptr<float> allocate(std::size_t floats) {
  return {static_cast<float*>(::operator new(floats * sizeof(float), kAlignment)),
          [](float* memory) { ::operator delete(memory, kAlignment); }};
}

}  // namespace

void OpticalBuffer::grow(std::size_t floats) {
  const std::size_t capacity = std::max(floats, capacity_ + capacity_ / 2);
  std::shared_ptr<float> larger = allocate(capacity);
  std::copy_n(floats_.get(), size_, larger.get());
  floats_ = std::move(larger);
  capacity_ = capacity;
}

/// Chunk of memory whose ownership its buffers share. Sizes are in floats.
struct OpticalArena::Chunk {
  SparseBytes memory;
  std::size_t size = 0, used = 0, touched = 0;
  bool lent = false;

  [[nodiscard]] float* data() const { return reinterpret_cast<float*>(memory.data()); }
};

void OpticalArena::expect(std::uint64_t bytes) {
  large_ = bytes >= kLargePages;
  for (const std::shared_ptr<Chunk>& chunk : chunks_) chunk->lent = true;
}

OpticalBuffer OpticalArena::lend(std::size_t floats) {
  const std::lock_guard lock(*mutex_);
  const auto lend_rest = [&](const std::shared_ptr<Chunk>& chunk) {
    chunk->lent = true;
    if (large_) chunk->memory.expect_dense();
    return OpticalBuffer({chunk, chunk->data() + chunk->used}, chunk->size - chunk->used);
  };
  for (const std::shared_ptr<Chunk>& chunk : chunks_) {
    if (chunk.use_count() == 1) {
      chunk->used = 0;
      chunk->lent = false;
    }
    if (chunk->lent) continue;
    if (chunk->size - chunk->used >= floats) return lend_rest(chunk);
    chunk->lent = true;  // full
    if (2 * floats * sizeof(float) >= kLargePages) chunk->memory.drop(chunk->used * sizeof(float));
    chunk->size = chunk->memory.size() / sizeof(float);
  }
  const auto chunk = std::make_shared<Chunk>();
  Result<SparseBytes> memory = SparseBytes::reserve(std::max(kChunkBytes, 2 * floats * sizeof(float)));
  if (!memory) throw std::bad_alloc();
  chunk->memory = std::move(*memory);
  chunk->size = chunk->memory.size() / sizeof(float);
  chunks_.push_back(chunk);
  return lend_rest(chunk);
}

void OpticalArena::settle(OpticalBuffer& buffer) {
  const std::lock_guard lock(*mutex_);
  for (const std::shared_ptr<Chunk>& chunk : chunks_) {
    if (!chunk->lent || buffer.data() != chunk->data() + chunk->used) continue;
    const std::size_t aligned = (buffer.size() + kAlignedFloats - 1) / kAlignedFloats * kAlignedFloats;
    chunk->used = std::min(chunk->used + aligned, chunk->size);
    chunk->touched = std::max(chunk->touched, chunk->used);
    chunk->lent = false;
    buffer.fit();
    if (buffer.size() == 0) buffer = {};
    return;
  }
}

std::uint64_t OpticalArena::bytes() const {
  const std::lock_guard lock(*mutex_);
  std::uint64_t floats = 0;
  for (const std::shared_ptr<Chunk>& chunk : chunks_) floats += chunk->touched;
  return floats * sizeof(float);
}

std::uint64_t OpticalArena::bytes_in_use() const {
  const std::lock_guard lock(*mutex_);
  std::uint64_t floats = 0;
  for (const std::shared_ptr<Chunk>& chunk : chunks_) {
    if (chunk.use_count() > 1) floats += chunk->used;
  }
  return floats * sizeof(float);
}

void OpticalArena::trim(std::uint64_t bytes) {
  const std::lock_guard lock(*mutex_);
  std::uint64_t kept = 0;
  std::erase_if(chunks_, [&](const std::shared_ptr<Chunk>& chunk) {
    const std::uint64_t more = chunk->touched * sizeof(float);
    if (chunk.use_count() == 1 && kept + more > bytes) return true;
    if (chunk.use_count() == 1) kept += more;
    return false;
  });
}

void light_rows(const SliceSpans& slice, const RowRange& rows, std::span<const Blocks> visible,
                std::span<const Blocks> hidden, std::span<const float> factors, SliceSpans& lit) {
  lit.number = slice.number;
  lit.emissions = slice.emissions;
  lit.first_row = std::max(rows.first, slice.first_row);
  lit.last_row = std::max(lit.first_row, std::min(rows.last, slice.last_row));
  lit.first_span.clear();
  lit.spans.clear();
  lit.optics.clear();
  const LightKernels kernels = light_kernels();
  const auto floats = static_cast<std::size_t>(slice.block_floats());
  const BlockLights* lights = slice.lights.data();  // of the next blocks
  const BlockLights* const all_lights = lights + slice.lights.size();
  for (std::int64_t row = lit.first_row; row < lit.last_row; ++row) {
    const auto n = static_cast<std::size_t>(row - rows.first);
    const Blocks hole = hidden.empty() ? Blocks{} : hidden[n];
    lit.first_span.push_back(static_cast<std::uint32_t>(lit.spans.size()));
    for (const Span& span : slice.row(row)) {
      Blocks shown{span.first_block, std::int64_t{span.first_block} + span.blocks};
      if (!visible.empty())
        shown = {std::max(shown.first, visible[n].first), std::min(shown.last, visible[n].last)};
      if (shown.first >= shown.last) continue;
      if (lit.spans.empty())
        lights = std::ranges::lower_bound(lights, all_lights, span.offset, {}, &BlockLights::block);
      const auto count_of = [](std::int64_t first, std::int64_t last) {
        return static_cast<std::uint32_t>(last - first);
      };
      const std::uint32_t blocks = count_of(shown.first, shown.last);
      lit.spans.push_back({static_cast<std::uint32_t>(shown.first), blocks, span.voxels,
                           static_cast<std::uint32_t>(lit.optics.size() / floats)});
      float* const to = lit.optics.append(blocks * floats);
      for (const Blocks& part : parts_outside(shown, hole)) {
        if (part.first == part.last) continue;
        const std::uint32_t first = span.offset + count_of(span.first_block, part.first),
                            count = count_of(part.first, part.last);
        while (lights != all_lights && lights->block < first) ++lights;
        const BlockLights* const first_light = lights;
        while (lights != all_lights && lights->block < first + count) ++lights;
        kernels.emit(
            {first, count, slice.emissions, slice.optics.data() + first * floats, {first_light, lights}},
            factors.data(), to + count_of(shown.first, part.first) * floats);
      }
    }
  }
  lit.first_span.push_back(static_cast<std::uint32_t>(lit.spans.size()));
}

}  // namespace splatlas
