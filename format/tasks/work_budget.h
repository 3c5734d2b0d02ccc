// Limit of the work that a file may cause.
#pragma once

#include <cstdint>
#include <string>

#include "format/result.h"

namespace splatlas {

/// Limit against decompression bombs, for one operation on one file: time in proportion to the file, and
/// memory. Work is counted where it is done (TaskControl) and ends once it passes the limit.
class WorkBudget {
 public:
  /// `file_bytes`: of the sections that a reader knows. `max_work` scales both limits, the memory to a
  /// quarter at least: below 1 for untrusted files, above 1 for very large ones. `machine_bytes`: its memory.
  WorkBudget(std::string file_name, std::uint64_t file_bytes, double max_work, std::uint64_t machine_bytes);

  /// CPU time of all threads together: 30 s for files up to 1 MiB, and 10 microseconds for each further byte.
  [[nodiscard]] double cpu_seconds() const { return cpu_seconds_; }
  /// Memory of one step: 2 GiB up to 1 MiB of file and 2 KiB per further byte; at most half the machine's.
  [[nodiscard]] double memory_bytes() const { return memory_bytes_; }
  /// kLimit: names the file, the limit, and the option --max-work that allows more.
  [[nodiscard]] Error time_exceeded() const;
  [[nodiscard]] Error memory_exceeded(double bytes) const;

 private:
  std::string file_name_;
  std::uint64_t file_bytes_;
  double max_work_, cpu_seconds_, memory_bytes_;
};

}  // namespace splatlas
