// Run-length coded frames (PS3.5 annex G).
#include <algorithm>
#include <array>
#include <cstring>

#include "format/result_macros.h"
#include "preprocess/import/images/dicom/decode/frame_codings.h"

namespace splatlas {
namespace {

/// Unpacks runs until `bytes` are full. False if the runs end before, or one of them does.
bool unpack(std::span<const std::byte> runs, std::span<std::byte> bytes) {
  constexpr unsigned kNothing = 128, kRunBase = 257;  // codes of two's complement
  std::size_t at = 0, filled = 0;
  while (filled < bytes.size()) {
    if (at >= runs.size()) return false;
    const auto code = std::to_integer<unsigned>(runs[at++]);
    if (code == kNothing) continue;
    const bool is_literal = code < kNothing;
    const std::size_t count = is_literal ? code + 1 : kRunBase - code;
    const std::size_t needed = is_literal ? count : 1;
    if (runs.size() - at < needed || bytes.size() - filled < count) return false;
    if (is_literal) {
      std::copy_n(&runs[at], count, &bytes[filled]);
    } else {
      std::fill_n(&bytes[filled], count, runs[at]);
    }
    at += needed;
    filled += count;
  }
  return true;
}

}  // namespace

Result<void> decode_run_lengths(std::span<const std::byte> bytes, std::size_t sample_bytes,
                                std::vector<std::int32_t>& values) {
  // DCMTK's decoder fills up cut segments, with wrong pixels.
  const auto damaged = [] {
    return fail(ErrorCode::kFailed, std::string("has damaged run-length coded pixels; get the file again"));
  };
  constexpr std::size_t kMaxSegments = 15;
  std::array<std::uint32_t, kMaxSegments + 1> header{};  // number of segments, and where each starts
  if (bytes.size() < sizeof(header)) return damaged();
  std::memcpy(header.data(), bytes.data(), sizeof(header));
  if (header[0] != sample_bytes) return damaged();
  std::fill(values.begin(), values.end(), 0);
  std::vector<std::byte> plane(values.size());
  for (std::size_t n = 1; n <= sample_bytes; ++n) {
    const std::size_t start = header[n], end = n < sample_bytes ? header[n + 1] : bytes.size();
    if (start < sizeof(header) || start > end || end > bytes.size()) return damaged();
    if (!unpack(bytes.subspan(start, end - start), plane)) return damaged();
    // The most significant bytes come first.
    for (std::size_t v = 0; v < plane.size(); ++v) {
      const std::uint32_t higher = static_cast<std::uint32_t>(values[v]) << 8;
      values[v] = static_cast<std::int32_t>(higher | std::to_integer<std::uint32_t>(plane[v]));
    }
  }
  return {};
}

}  // namespace splatlas
