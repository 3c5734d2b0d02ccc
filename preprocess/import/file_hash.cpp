#include "preprocess/import/file_hash.h"

#include <fstream>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <xxhash.h>

#include "preprocess/import/import_error.h"

namespace splatlas {

Result<std::string> hash_file(const std::filesystem::path& path) {
  struct FreeState {
    void operator()(XXH64_state_t* state) const { XXH64_freeState(state); }
  };
  const std::unique_ptr<XXH64_state_t, FreeState> state(XXH64_createState());
  std::ifstream file(path, std::ios::binary);
  if (!state || !file) return bad_file(path, "cannot be read");
  XXH64_reset(state.get(), 0);
  std::vector<char> block(1 << 18);
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    XXH64_update(state.get(), block.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (file.bad()) return bad_file(path, "cannot be read");
  return fmt::format("xxh64:{:016x}", XXH64_digest(state.get()));
}

}  // namespace splatlas
