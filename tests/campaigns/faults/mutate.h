// Mutants of files: damage of the kinds that disks, networks and people do.
#pragma once

#include <random>
#include <string>

namespace splatlas {

struct Mutant {
  std::string bytes;
  const char* kind = "";  ///< for tables: "flipped bits"
};

/// A mutant of `bytes` of a random kind. Most changes are near the start, where headers are.
[[nodiscard]] Mutant mutate(const std::string& bytes, std::mt19937& random);

/// The same of the content of a gzip file, packed again, up to 16 MiB; others are mutated as they are.
[[nodiscard]] Mutant mutate_inflated(const std::string& bytes, std::mt19937& random);

}  // namespace splatlas
