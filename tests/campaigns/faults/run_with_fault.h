// Fault injection into one system call of a program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "tests/campaigns/faults/file_calls.h"
#include "tests/support/run_program.h"

namespace splatlas {

/// Fault at a call. Calls are numbered among those on files of the folder.
struct Fault {
  enum class Kind : std::uint8_t {
    kKill,   ///< SIGKILL before the call
    kTear,   ///< SIGKILL after half of the transfer
    kError,  ///< the call fails
    kShort,  ///< the call transfers half of the request
  };
  Kind kind = Kind::kKill;
  int error = 0;       ///< of kError; of kShort: the error of later calls, 0 for none
  bool lasts = false;  ///< later calls that read fail, too (or: store and change; with ENOSPC: store)
  std::string name;    ///< description: "EIO, lasting"
};

struct FaultyRun {
  ProgramResult result;
  std::vector<FileCall> calls;    ///< on files of the folder, up to the end of the run
  std::vector<FileCall> outside;  ///< on names elsewhere, if they create or change them
};

/// File system of the run: with unnamed files (O_TMPFILE), or without as on many network file systems.
enum class Naming : std::uint8_t { kUnnamed, kNamed };

/// No call has this number.
inline constexpr std::size_t kNoCall = std::numeric_limits<std::size_t>::max();

/// Runs `words` in `folder`, a canonical path, with the fault at the call of this number. Needs Linux 5.9:
/// the user notification of seccomp covers all calls, those of libraries included.
[[nodiscard]] FaultyRun run_with_fault(const std::vector<std::string>& words,
                                       const std::filesystem::path& folder, Naming naming = Naming::kUnnamed,
                                       std::size_t number = kNoCall, const Fault& fault = {});

}  // namespace splatlas
