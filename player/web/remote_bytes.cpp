#include <algorithm>
#include <utility>

#include "format/result_macros.h"
#include "player/web/page_engine.h"

namespace splatlas {

Result<void> RemoteBytes::read(std::uint64_t offset, std::span<std::byte> to) {
  const std::lock_guard lock(mutex_);
  const auto after = pieces_.upper_bound(offset);
  if (after != pieces_.begin()) {
    const auto& [begin, piece] = *std::prev(after);
    const std::uint64_t skipped = offset - begin;
    if (skipped <= piece.size() && to.size() <= piece.size() - skipped) {
      std::copy_n(piece.begin() + static_cast<std::ptrdiff_t>(skipped), to.size(), to.begin());
      return {};
    }
  }
  missed_.push_back({offset, to.size()});
  return fail(ErrorCode::kFailed, "bytes {} to {} are not loaded", offset, offset + to.size());
}

void RemoteBytes::give(std::uint64_t offset, std::vector<std::byte> bytes) {
  const std::lock_guard lock(mutex_);
  std::vector<std::byte>& piece = pieces_[offset];
  if (bytes.size() > piece.size()) piece = std::move(bytes);
}

std::vector<ByteRange> RemoteBytes::take_missed() {
  constexpr std::uint64_t kMaxGap = 2048;  // about the head of one more answer
  const std::lock_guard lock(mutex_);
  std::ranges::sort(missed_, {}, &ByteRange::offset);
  std::vector<ByteRange> merged;
  for (const ByteRange& range : std::exchange(missed_, {})) {
    if (merged.empty() || range.offset > merged.back().offset + merged.back().bytes + kMaxGap) {
      merged.push_back(range);
      continue;
    }
    ByteRange& last = merged.back();
    last.bytes = std::max(last.bytes, range.offset + range.bytes - last.offset);
  }
  return merged;
}

}  // namespace splatlas
