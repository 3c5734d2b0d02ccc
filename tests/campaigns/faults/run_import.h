// One import in a process of its own, measured.
#pragma once

#include <cstdint>
#include <filesystem>

#include "tests/campaigns/faults/import_kinds.h"

namespace splatlas {

struct ImportRun {
  ImportEnd end;
  double cpu_seconds = 0, wall_seconds = 0;
  std::uint64_t peak_bytes = 0;  ///< of the process and of its children
  std::string violation;         ///< empty if the process ended as it should
};

/// Makes processes that lose their parent children of this one, so that run_import() sees them.
void adopt_orphans();

/// Runs `kind.import` on a file or folder. A violation: the process crashes or hangs, or leaves a process or
/// an open file behind.
[[nodiscard]] ImportRun run_import(const ImportKind& kind, const std::filesystem::path& path);

}  // namespace splatlas
