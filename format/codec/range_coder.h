// Adaptive binary range coder (Martin 1979, "Range encoding"), with LZMA's carry propagation.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace splatlas {

/// Adaptive probability of a set bit, in units of 1/65536, and the number of observed bits.
struct AdaptiveBit {
  static constexpr std::int64_t kMin = 16, kMax = 65536 - kMin;
  static constexpr std::uint16_t kMaxSeen = 255;

  std::uint16_t probability = 32768;
  std::uint16_t seen = 0;

  void learn(bool bit) {
    // Running mean of the first kMaxSeen bits, then an exponential moving average.
    const std::int64_t difference = (bit ? 65535 : 0) - std::int64_t{probability};
    const std::int64_t moved = probability + (difference * kShares[seen] >> 16);
    probability = static_cast<std::uint16_t>(std::clamp(moved, kMin, kMax));
    seen = static_cast<std::uint16_t>(seen + (seen < kMaxSeen ? 1 : 0));
  }

 private:
  static constexpr auto kShares = [] {  // 1 / (seen + 1), in units of 1/65536
    std::array<std::int32_t, kMaxSeen + 1> shares{};
    for (std::size_t n = 0; n < shares.size(); ++n)
      shares[n] = static_cast<std::int32_t>(32768 / (n + 1) * 2);
    return shares;
  }();
};

/// Renormalization threshold: ranges keep at least 8 bits more than probabilities.
inline constexpr std::uint32_t kMinRange = std::uint32_t{1} << 24;

class RangeEncoder {
 public:
  void encode(AdaptiveBit& model, bool bit) {
    const std::uint32_t bound = (range_ >> 16) * model.probability;
    if (bit) {
      range_ = bound;
    } else {
      low_ += bound;
      range_ -= bound;
    }
    model.learn(bit);
    for (; range_ < kMinRange; range_ <<= 8) shift_out();
  }

  /// Flushes the code, without its trailing zeros. The encoder cannot be used afterwards.
  [[nodiscard]] std::vector<std::byte> finish() {
    for (int n = 0; n < 5; ++n) shift_out();
    bytes_.erase(bytes_.begin());  // always 0
    while (!bytes_.empty() && bytes_.back() == std::byte{0}) bytes_.pop_back();
    return std::move(bytes_);
  }

 private:
  void shift_out() {
    constexpr std::uint64_t kCarry = std::uint64_t{1} << 32;
    if (low_ < kCarry - kMinRange || low_ >= kCarry) {
      const auto carry = static_cast<std::uint8_t>(low_ >> 32);
      for (; pending_ > 0; --pending_, cache_ = 0xff)
        bytes_.push_back(static_cast<std::byte>(cache_ + carry));
      cache_ = static_cast<std::uint8_t>(low_ >> 24);
    }
    ++pending_;
    low_ = (low_ & (kMinRange - 1)) << 8;
  }

  std::uint64_t low_ = 0;
  std::uint32_t range_ = 0xffffffff;
  std::uint8_t cache_ = 0;
  std::uint64_t pending_ = 1;  // bytes that a carry may still change: cache_, then 0xff
  std::vector<std::byte> bytes_;
};

/// Decoder. Safe on untrusted bytes; reads zeros after their end.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::span<const std::byte> bytes) : bytes_(bytes) {
    for (int n = 0; n < 4; ++n) code_ = code_ << 8 | next();
  }

  [[nodiscard]] bool decode(AdaptiveBit& model) {
    const std::uint32_t bound = (range_ >> 16) * model.probability;
    const bool bit = code_ < bound;
    if (bit) {
      range_ = bound;
    } else {
      code_ -= bound;
      range_ -= bound;
    }
    model.learn(bit);
    for (; range_ < kMinRange; range_ <<= 8) code_ = code_ << 8 | next();
    return bit;
  }

  /// True if all bytes were read.
  [[nodiscard]] bool at_end() const { return at_ >= bytes_.size(); }

 private:
  std::uint32_t next() {
    const std::size_t at = at_++;
    return at < bytes_.size() ? std::to_integer<std::uint32_t>(bytes_[at]) : 0;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::uint32_t range_ = 0xffffffff, code_ = 0;
};

}  // namespace splatlas
