#include "tests/fuzz/scratch_file.h"

#include <fstream>

#include "tests/fuzz/require.h"
#include "tests/support/run_program.h"

namespace splatlas {

std::filesystem::path write_input_file(const std::string& name, std::span<const std::byte> bytes) {
  static const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / name;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  require(file.good(), "the input cannot be written to a file");
  return path;
}

}  // namespace splatlas
