#include "format/codec/run_codec.h"

#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {

namespace {

/// The list, and copies of its runs in other forms.
constexpr double kBytesPerReadRun = 3 * sizeof(Run);

/// Valid scanline numbers are below 2^40. Refusing larger values prevents overflow of sums.
constexpr std::uint64_t kMaxScanline = std::uint64_t{1} << 48;

/// LEB128 varint: seven bits per byte, the high bit set on all bytes but the last.
void append_varint(std::uint64_t value, std::vector<std::byte>& bytes) {
  for (; value >= 0x80; value >>= 7) bytes.push_back(static_cast<std::byte>((value & 0x7f) | 0x80));
  bytes.push_back(static_cast<std::byte>(value));
}

class VarintReader {
 public:
  explicit VarintReader(std::span<const std::byte> bytes) : next_(bytes.data()), end_(next_ + bytes.size()) {}

  /// False at the end of the bytes, or if the varint exceeds 64 bits.
  bool read(std::uint64_t& value) {
    if (next_ != end_ && *next_ < std::byte{0x80}) {  // fast path
      value = std::to_integer<std::uint64_t>(*next_++);
      return true;
    }
    value = 0;
    for (unsigned shift = 0; shift < 64 && next_ != end_; shift += 7) {
      const auto byte = std::to_integer<std::uint64_t>(*next_++);
      if (shift == 63 && byte > 1) return false;
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) return true;
    }
    return false;
  }
  [[nodiscard]] bool at_end() const { return next_ == end_; }

 private:
  const std::byte* next_;
  const std::byte* end_;
};

/// Predicts the length and start of each run from previous runs.
class Predictor {
 public:
  explicit Predictor(std::span<const Run> runs) : runs_(runs) {}

  /// Advances to run n. Call in order for all runs.
  void advance(std::size_t n) {
    n_ = n;
    if (n == 0 || runs_[n].scanline == runs_[n - 1].scanline) return;
    previous_ = current_;
    current_ = n;
  }
  [[nodiscard]] std::int64_t length() const {
    if (const Run* above = same_rank()) return above->length;
    return n_ == 0 ? 1 : runs_[n_ - 1].length;
  }
  /// Requires the lengths of all runs.
  [[nodiscard]] std::int64_t start() const {
    if (const Run* above = same_rank()) return above->start;
    if (n_ == current_) return 0;
    return std::int64_t{runs_[n_ - 1].start} + runs_[n_ - 1].length + 1;
  }

 private:
  /// The run of the same rank in the previous non-empty scanline, or null.
  [[nodiscard]] const Run* same_rank() const {
    const std::size_t n = previous_ + (n_ - current_);
    return n < current_ ? &runs_[n] : nullptr;
  }

  std::span<const Run> runs_;
  std::size_t n_ = 0, current_ = 0, previous_ = 0;  // run; first runs of its scanline and the previous one
};

tl::unexpected<Error> not_a_run_list(std::uint64_t run) {
  return invalid_atlas("not a run list (run {})", run);
}

}  // namespace

void append_run_list(std::span<const Run> runs, std::vector<std::byte>& bytes) {
  if (runs.empty()) return;
  append_varint(runs.size(), bytes);
  std::uint64_t scanline = 0;
  for (const Run& run : runs) {
    append_varint(run.scanline - scanline, bytes);
    scanline = run.scanline;
  }
  Predictor lengths(runs);
  for (std::size_t n = 0; n < runs.size(); ++n) {
    lengths.advance(n);
    append_varint(zigzag(runs[n].length - lengths.length()), bytes);
  }
  Predictor starts(runs);
  for (std::size_t n = 0; n < runs.size(); ++n) {
    starts.advance(n);
    append_varint(zigzag(runs[n].start - starts.start()), bytes);
  }
}

Result<ClassRuns> decode_run_list(std::span<const std::byte> bytes, std::uint64_t max_runs) {
  if (bytes.empty()) return ClassRuns{};
  VarintReader reader(bytes);
  std::uint64_t count = 0, code = 0;
  if (!reader.read(count) || count == 0 || count > max_runs || count > bytes.size() / 3) {
    return invalid_atlas("run list says it has {} runs", count);
  }
  check_memory(static_cast<double>(count) * kBytesPerReadRun);
  TaskPace pace;
  ClassRuns runs(count);
  std::uint64_t scanline = 0;
  for (std::uint64_t n = 0; n < count; ++n) {
    pace.step();
    if (!reader.read(code) || code > kMaxScanline) return not_a_run_list(n);
    scanline += code;
    if (scanline > kMaxScanline) return not_a_run_list(n);
    runs[n].scanline = scanline;
  }
  constexpr std::int64_t kMax = std::numeric_limits<std::uint32_t>::max();
  const auto read_difference = [&](std::int64_t predicted, std::uint32_t& value) {
    if (!reader.read(code) || code > 4 * static_cast<std::uint64_t>(kMax)) return false;
    const std::int64_t sum = predicted + unzigzag(code);
    if (sum < 0 || sum > kMax) return false;
    value = static_cast<std::uint32_t>(sum);
    return true;
  };
  Predictor lengths(runs);
  for (std::uint64_t n = 0; n < count; ++n) {
    pace.step();
    lengths.advance(n);
    if (!read_difference(lengths.length(), runs[n].length)) return not_a_run_list(n);
  }
  Predictor starts(runs);
  for (std::uint64_t n = 0; n < count; ++n) {
    pace.step();
    starts.advance(n);
    if (!read_difference(starts.start(), runs[n].start)) return not_a_run_list(n);
  }
  if (!reader.at_end()) return invalid_atlas("trailing bytes after the run list");
  return runs;
}

}  // namespace splatlas
