#include "bench/measure/measure.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <utility>

#include "format/result_macros.h"

namespace splatlas {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

Elapsed median(std::span<const Elapsed> values) {
  std::vector<double> wall, cpu;
  for (const Elapsed& elapsed : values) {
    wall.push_back(elapsed.wall_ms);
    cpu.push_back(elapsed.cpu_ms);
  }
  return {median(std::move(wall)), median(std::move(cpu))};
}

std::vector<Elapsed> medians_by_frame(std::span<const Elapsed> turns, int frames) {
  std::vector<std::vector<Elapsed>> by_frame(static_cast<std::size_t>(frames));
  for (std::size_t turn = 0; turn < turns.size(); ++turn) {
    by_frame[turn % by_frame.size()].push_back(turns[turn]);
  }
  std::vector<Elapsed> medians;
  for (const std::vector<Elapsed>& repeats : by_frame) medians.push_back(median(repeats));
  return medians;
}

std::vector<Elapsed> best_of_repeats(std::span<const Elapsed> turns, int frames) {
  const auto count = std::min(turns.size(), static_cast<std::size_t>(frames));
  std::vector<Elapsed> best(turns.begin(), turns.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t turn = 0; turn < turns.size(); ++turn) {
    Elapsed& min = best[turn % count];
    min.wall_ms = std::min(min.wall_ms, turns[turn].wall_ms);
    min.cpu_ms = std::min(min.cpu_ms, turns[turn].cpu_ms);
  }
  return best;
}

Elapsed median_ratio(std::vector<Elapsed> frames, std::span<const Elapsed> units) {
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    frames[frame].wall_ms /= units[frame].wall_ms;
    frames[frame].cpu_ms /= units[frame].cpu_ms;
  }
  return median(frames);
}

Elapsed median_ratio(std::span<const Elapsed> turns, std::span<const Elapsed> unit, int frames) {
  return median_ratio(medians_by_frame(turns, frames), medians_by_frame(unit, frames));
}

Contender timed(std::function<Result<void>(int turn)> work) {
  return [work = std::move(work)](int turn) -> Result<std::vector<Elapsed>> {
    Stopwatch watch;
    SPLATLAS_RETURN_IF_ERROR(work(turn));
    return std::vector{watch.lap()};
  };
}

Result<std::vector<StageTimes>> measure_interleaved(std::span<const Contender> contenders, int turns) {
  std::vector<StageTimes> times(contenders.size());
  for (int turn = 0; turn < turns; ++turn) {
    for (std::size_t n = 0; n < contenders.size(); ++n) {
      const std::size_t contender = (n + static_cast<std::size_t>(turn)) % contenders.size();
      SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Elapsed> stages, contenders[contender](turn));
      times[contender].resize(stages.size());
      for (std::size_t stage = 0; stage < stages.size(); ++stage) {
        times[contender][stage].push_back(stages[stage]);
      }
    }
  }
  return times;
}

namespace {

/// A field of /proc/self/status in kB, converted to bytes.
Result<std::uint64_t> status_bytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key; status.ignore(1 << 16, '\n')) {
    if (std::uint64_t kilobytes = 0; key == name + ":" && status >> kilobytes) return kilobytes * 1024;
  }
  return fail(ErrorCode::kFailed, "/proc/self/status: does not tell " + name);
}

}  // namespace

Result<PeakMemory> PeakMemory::start() {
  std::ofstream peak("/proc/self/clear_refs");
  peak << "5" << std::flush;  // resets the peak to the current resident size
  if (!peak) return fail(ErrorCode::kFailed, "/proc/self/clear_refs: the peak of memory cannot be set back");
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t before, status_bytes("VmRSS"));
  return PeakMemory(before);
}

Result<std::uint64_t> PeakMemory::grown_bytes() const {
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t peak, status_bytes("VmHWM"));
  return peak > before_ ? peak - before_ : 0;
}

}  // namespace splatlas
