#include "preprocess/import/file_hash.h"

#include <algorithm>
#include <fstream>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <xxhash.h>

#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

/// The file itself, or the regular files of a folder in the order of their paths.
std::vector<std::filesystem::path> files_of(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) return {path};
  std::vector<std::filesystem::path> files;
  for (std::filesystem::recursive_directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->is_regular_file(error)) files.push_back(entry->path());
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

Result<std::string> hash_file(const std::filesystem::path& path) {
  struct FreeState {
    void operator()(XXH64_state_t* state) const { XXH64_freeState(state); }
  };
  const std::unique_ptr<XXH64_state_t, FreeState> state(XXH64_createState());
  if (!state) return fail(ErrorCode::kLimit, path.string() + ": out of memory");
  XXH64_reset(state.get(), 0);
  std::vector<char> block(1 << 18);
  for (const std::filesystem::path& name : files_of(path)) {
    std::ifstream file(name, std::ios::binary);
    if (!file) return bad_file(name, "cannot be read");
    while (file) {
      file.read(block.data(), static_cast<std::streamsize>(block.size()));
      XXH64_update(state.get(), block.data(), static_cast<std::size_t>(file.gcount()));
    }
    if (file.bad()) return bad_file(name, "cannot be read");
  }
  return fmt::format("xxh64:{:016x}", XXH64_digest(state.get()));
}

}  // namespace splatlas
