// Measuring contenders side by side.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "format/result.h"
#include "player/frame/stopwatch.h"

namespace splatlas {

/// The middle one; the mean of the two in the middle of an even number; 0 of none.
[[nodiscard]] double median(std::vector<double> values);
/// Of wall clock and CPU time, each for itself.
[[nodiscard]] Elapsed median(std::span<const Elapsed> values);

/// Of times by turn, where turn n draws frame n % frames: the medians over the repeats of each frame.
[[nodiscard]] std::vector<Elapsed> medians_by_frame(std::span<const Elapsed> turns, int frames);
/// The cost of `turns` in units of `unit`: the median over frames of the ratio of the medians over repeats.
[[nodiscard]] Elapsed median_ratio(std::span<const Elapsed> turns, std::span<const Elapsed> unit, int frames);
/// As medians_by_frame(), the least of the repeats: what else the machine does only ever adds.
[[nodiscard]] std::vector<Elapsed> best_of_repeats(std::span<const Elapsed> turns, int frames);

/// Does its work once and tells what each stage of it took; always the same stages. What it does outside of
/// the stages is not measured.
using Contender = std::function<Result<std::vector<Elapsed>>(int turn)>;

/// Of one contender: times[stage][turn].
using StageTimes = std::vector<std::vector<Elapsed>>;

/// `turns` turns of every contender, interleaved, so that whatever else the machine does hits all of them
/// alike; who begins changes from turn to turn. The first failure ends it.
[[nodiscard]] Result<std::vector<StageTimes>> measure_interleaved(std::span<const Contender> contenders,
                                                                  int turns);

}  // namespace splatlas
