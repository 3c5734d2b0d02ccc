// File names from names of structures, for every file system.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace splatlas {

/// File names for `names`, in their order: NAME + `ending`, unique ignoring case, the same on every machine.
///
/// A name is kept if it is safe on Linux, macOS and Windows, and in command lines: ASCII letters, digits,
/// "_", "-" and "."; neither "-" nor "." at its start, nor "." at its end; no device of Windows ("CON",
/// "NUL.x"); at most kMaxNameCharacters, so that masks build back. Other names change: each run of other
/// characters becomes "_", non-ASCII letters too, because file systems normalise them differently; "_"
/// precedes a bad start; long names are truncated. Kept names have precedence. Names that are taken get "_2",
/// "_3" and so on, in order. Cost: n log n. Thread-safe.
[[nodiscard]] std::vector<std::string> file_names_of(std::span<const std::string> names,
                                                     std::string_view ending);

}  // namespace splatlas
