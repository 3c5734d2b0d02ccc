#include "tests/fuzz/scratch_file.h"

#include "tests/fuzz/require.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {

std::filesystem::path write_input_file(const std::string& name, std::span<const std::byte> bytes) {
  static const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / name;
  require(write_bytes(path, bytes), "the input cannot be written to a file");
  return path;
}

}  // namespace splatlas
