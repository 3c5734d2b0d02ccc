// Kinds of source files, with the functions that import them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace splatlas {

/// How an import ended.
enum class Outcome { kResult, kRefusal, kCrashOfChild, kLimitOfChild };

struct ImportEnd {
  Outcome outcome = Outcome::kResult;
  std::string message;  ///< of an error
};

/// A kind of files: one row of the table.
struct ImportKind {
  const char* name;
  std::vector<std::string> endings;  ///< in lower case
  ImportEnd (*import)(const std::filesystem::path& file_or_folder);
  bool takes_folder = false;  ///< imports a folder of up to kMostInFolder files of the kind
};

inline constexpr std::size_t kMostInFolder = 8;

/// All kinds.
[[nodiscard]] const std::vector<ImportKind>& import_kinds();

/// A file to mutate, and the files that must lie beside it.
struct Seed {
  std::filesystem::path file;
  std::vector<std::filesystem::path> companions;
};

/// Files of a kind below a folder, of at most 4 MB, sorted.
[[nodiscard]] std::vector<Seed> find_seeds(const ImportKind& kind, const std::filesystem::path& folder);

}  // namespace splatlas
