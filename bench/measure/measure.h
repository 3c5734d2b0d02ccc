// Interleaved measurement of contenders, and peak memory.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "format/result.h"
#include "player/render/frame/stopwatch.h"

namespace splatlas {

/// Median; mean of the two middle values for an even number; 0 for none.
[[nodiscard]] double median(std::vector<double> values);
/// Medians of wall clock and CPU time, separately.
[[nodiscard]] Elapsed median(std::span<const Elapsed> values);

/// Medians over the repeats of each frame. Turn n draws frame n % frames.
[[nodiscard]] std::vector<Elapsed> medians_by_frame(std::span<const Elapsed> turns, int frames);
/// As medians_by_frame(), but minima: other load only adds time.
[[nodiscard]] std::vector<Elapsed> best_of_repeats(std::span<const Elapsed> turns, int frames);
/// Median over frames of the ratios of their times.
[[nodiscard]] Elapsed median_ratio(std::vector<Elapsed> frames, std::span<const Elapsed> units);
/// Cost of `turns` relative to `unit`: median over frames of the ratio of medians over repeats.
[[nodiscard]] Elapsed median_ratio(std::span<const Elapsed> turns, std::span<const Elapsed> unit, int frames);

/// Does its work once and returns the time of each stage, always the same stages. Work outside stages is not
/// measured.
using Contender = std::function<Result<std::vector<Elapsed>>(int turn)>;
/// A contender of one stage: the time of `work`.
[[nodiscard]] Contender timed(std::function<Result<void>(int turn)> work);

/// times[stage][turn] of one contender.
using StageTimes = std::vector<std::vector<Elapsed>>;

/// `turns` turns of every contender, interleaved, so that other load affects all of them alike. The first one
/// rotates from turn to turn. Stops at the first failure.
[[nodiscard]] Result<std::vector<StageTimes>> measure_interleaved(std::span<const Contender> contenders,
                                                                  int turns);

/// Peak resident memory of the process, from start() on. One instance at a time: the system keeps one peak
/// per process.
class PeakMemory {
 public:
  /// kFailed if the system has no peak that can be reset (Linux has).
  [[nodiscard]] static Result<PeakMemory> start();
  /// Peak resident bytes since start(), minus those at the start.
  [[nodiscard]] Result<std::uint64_t> grown_bytes() const;

 private:
  explicit PeakMemory(std::uint64_t before) : before_(before) {}
  std::uint64_t before_;
};

}  // namespace splatlas
