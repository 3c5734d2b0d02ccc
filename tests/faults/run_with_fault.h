// Runs a program in which one system call on a file goes wrong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "tests/faults/file_calls.h"
#include "tests/support/run_program.h"

namespace splatlas {

/// What happens at a call, which is told by its number among the calls on files of the folder.
struct Fault {
  enum class Kind : std::uint8_t {
    kKill,   ///< SIGKILL before the call
    kTear,   ///< SIGKILL after half of what the call was to transfer
    kError,  ///< the call fails
    kShort,  ///< the call transfers half of what it was asked to
  };
  Kind kind = Kind::kKill;
  int error = 0;       ///< of kError; after kShort: how later calls fail, 0: they do not
  bool lasts = false;  ///< so do later calls that read (or: store and change; for ENOSPC: store)
  std::string name;    ///< for people: "EIO, lasting"
};

struct FaultyRun {
  ProgramResult result;
  std::vector<FileCall> calls;  ///< on files of the folder, as far as the program came
};

/// No call has this number.
inline constexpr std::size_t kNoCall = std::numeric_limits<std::size_t>::max();

/// Runs `words` in `folder`, which must be canonical, with the fault at the call of this number. Needs Linux
/// 5.9 (seccomp's user notification): it sees every call, of libraries too, whatever way it is made.
[[nodiscard]] FaultyRun run_with_fault(const std::vector<std::string>& words,
                                       const std::filesystem::path& folder, std::size_t number = kNoCall,
                                       const Fault& fault = {});

}  // namespace splatlas
