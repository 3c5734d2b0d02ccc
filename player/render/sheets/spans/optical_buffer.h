// Arena memory for the optical properties of spans.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace splatlas {

/// Growable array of floats, aligned to cache lines. clear() keeps its capacity.
class OpticalBuffer {
 public:
  OpticalBuffer() = default;
  /// An empty buffer on existing memory of `capacity` floats.
  OpticalBuffer(std::shared_ptr<float> room, std::size_t capacity)
      : floats_(std::move(room)), capacity_(capacity) {}
  OpticalBuffer(OpticalBuffer&& other) noexcept { *this = std::move(other); }
  OpticalBuffer& operator=(OpticalBuffer&& other) noexcept {
    floats_ = std::move(other.floats_);
    size_ = std::exchange(other.size_, 0);
    capacity_ = std::exchange(other.capacity_, 0);
    return *this;
  }
  ~OpticalBuffer() = default;
  [[nodiscard]] const float* data() const { return floats_.get(); }
  [[nodiscard]] float* data() { return floats_.get(); }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  void clear() { size_ = 0; }
  /// Appends uninitialised floats and returns a pointer to them. Throws std::bad_alloc.
  float* append(std::size_t floats) {
    if (size_ + floats > capacity_) grow(size_ + floats);
    size_ += floats;
    return floats_.get() + (size_ - floats);
  }
  /// Reduces the capacity to the size; the memory beyond belongs to the arena again.
  void fit() { capacity_ = size_; }

 private:
  void grow(std::size_t floats);

  std::shared_ptr<float> floats_;
  std::size_t size_ = 0, capacity_ = 0;
};

/// Arena of the buffers of successive selections. Page faults would cost more than writing, so that chunks
/// are reused. Many slices share a chunk, which may be backed by large pages.
class OpticalArena {
 public:
  /// Announces the total size of the next buffers, which decides their page size. They share no chunk with
  /// those before, which are usually freed soon.
  void expect(std::uint64_t bytes);
  /// An empty buffer with a capacity of at least `floats`. The caller fills it and passes it to settle().
  /// Throws std::bad_alloc. Thread-safe.
  [[nodiscard]] OpticalBuffer lend(std::size_t floats);
  /// Returns the unused capacity of a buffer to the arena. Thread-safe.
  void settle(OpticalBuffer& buffer);

  /// Bytes written so far, in use or not.
  [[nodiscard]] std::uint64_t bytes() const;
  /// Bytes that cannot be reused: those of chunks with at least one live buffer.
  [[nodiscard]] std::uint64_t bytes_in_use() const;
  /// Frees unused chunks until at most `bytes` of them remain.
  void trim(std::uint64_t bytes);

 private:
  static constexpr std::uint64_t kLargePages = std::uint64_t{1} << 20;
  struct Chunk;

  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
  std::vector<std::shared_ptr<Chunk>> chunks_;
  bool large_ = false;
};

}  // namespace splatlas
