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
    if (large_) chunk->memory.expect_dense(0, chunk->memory.size());
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

void light_rows(const SliceSpans& slice, const RowRange& rows, std::span<const Blocks> hidden,
                std::span<const float> factors, SliceSpans& lit) {
  lit.number = slice.number;
  lit.emissions = slice.emissions;
  lit.first_row = std::max(rows.first, slice.first_row);
  lit.last_row = std::max(lit.first_row, std::min(rows.last, slice.last_row));
  lit.first_span.clear();
  lit.spans.clear();
  lit.optics.clear();
  if (lit.first_row == lit.last_row) return;

  // Copy the spans. They, and thus their blocks, follow each other
  const std::uint32_t* const first_span =
      &slice.first_span[static_cast<std::size_t>(lit.first_row - slice.first_row)];
  const std::uint32_t* const last_span = first_span + (lit.last_row - lit.first_row);
  for (const std::uint32_t* span = first_span; span <= last_span; ++span)
    lit.first_span.push_back(*span - *first_span);
  lit.spans.assign(slice.spans.begin() + *first_span, slice.spans.begin() + *last_span);
  if (lit.spans.empty()) return;
  const std::uint32_t begin = lit.spans.front().offset,
                      end = lit.spans.back().offset + lit.spans.back().blocks;
  for (Span& span : lit.spans) span.offset -= begin;

  // Light the blocks
  const auto floats = static_cast<std::size_t>(slice.block_floats());
  const float* const from = slice.optics.data();
  float* const to = lit.optics.append((end - begin) * floats);
  const LightKernels kernels = light_kernels();
  auto lights = std::ranges::lower_bound(slice.lights, begin, {}, &BlockLights::block);
  const auto light = [&](std::uint32_t first, std::uint32_t last) {
    while (lights != slice.lights.end() && lights->block < first) ++lights;
    const auto first_light = lights;
    while (lights != slice.lights.end() && lights->block < last) ++lights;
    kernels.emit({first, last - first, slice.emissions, from + first * floats, {first_light, lights}},
                 factors.data(), to + (first - begin) * floats);
  };
  if (hidden.empty()) return light(begin, end);
  for (std::int64_t row = lit.first_row; row < lit.last_row; ++row) {
    for (const Span& span : slice.row(row)) {
      const auto number = [&](std::int64_t block) {
        return span.offset + static_cast<std::uint32_t>(block - span.first_block);
      };
      const Blocks all{span.first_block, std::int64_t{span.first_block} + span.blocks};
      for (const Blocks& part : parts_outside(all, hidden[static_cast<std::size_t>(row - rows.first)])) {
        if (part.first < part.last) light(number(part.first), number(part.last));
      }
    }
  }
}

}  // namespace splatlas
