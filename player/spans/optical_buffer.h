// Memory for the light of spans.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace splatlas {

/// Floats aligned to cache lines. Keeps its memory when it is filled anew.
class OpticalBuffer {
 public:
  OpticalBuffer() = default;
  /// Without floats, with room for some.
  OpticalBuffer(std::shared_ptr<float> room, std::size_t capacity)
      : floats_(std::move(room)), capacity_(capacity) {}
  OpticalBuffer(OpticalBuffer&& other) noexcept
      : floats_(std::move(other.floats_)),
        size_(std::exchange(other.size_, 0)),
        capacity_(std::exchange(other.capacity_, 0)) {}
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
  /// Makes room for `floats` more, which are not set, and says where.
  float* append(std::size_t floats) {
    if (size_ + floats > capacity_) grow(size_ + floats);
    size_ += floats;
    return floats_.get() + (size_ - floats);
  }
  /// Leaves the room behind the last float to others.
  void fit() { capacity_ = size_; }

 private:
  void grow(std::size_t floats);

  std::shared_ptr<float> floats_;
  std::size_t size_ = 0, capacity_ = 0;
};

/// Memory that the light of one selection after another is written to. Fresh pages would cost more than what
/// is written to them: pages stay, and many slices share those that are large.
class OpticalArena {
 public:
  OpticalArena() = default;
  OpticalArena(OpticalArena&& other) noexcept : chunks_(std::move(other.chunks_)), large_(other.large_) {}
  OpticalArena& operator=(OpticalArena&& other) noexcept {
    chunks_ = std::move(other.chunks_);
    large_ = other.large_;
    return *this;
  }
  ~OpticalArena() = default;

  /// Before buffers are lent for about `bytes` in all: decides what pages these get.
  void expect(std::uint64_t bytes) { large_ = bytes >= kLargePages; }
  /// A buffer with room for `floats` at least, and maybe for many more: to be given to settle() when it holds
  /// what it is to hold. Throws std::bad_alloc. Safe to call from several threads.
  [[nodiscard]] OpticalBuffer lend(std::size_t floats);
  /// What the buffer has left over is lent again. Safe to call from several threads.
  void settle(OpticalBuffer& buffer);

  /// Bytes that have been written to, whether they are in use or not.
  [[nodiscard]] std::uint64_t bytes() const;
  /// Of those, what cannot be lent again because buffers beside it are in use, these included.
  [[nodiscard]] std::uint64_t held_bytes() const;
  /// Gives back memory that nobody uses, as far as it is more than that.
  void trim(std::uint64_t bytes);

 private:
  static constexpr std::uint64_t kLargePages = std::uint64_t{1} << 20;
  struct Chunk;

  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<Chunk>> chunks_;
  bool large_ = false;
};

}  // namespace splatlas
