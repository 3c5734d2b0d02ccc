#include "tests/phantom/phantom_files.h"

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "tests/phantom/two_spheres.h"

namespace splatlas::phantom {
namespace {

Result<void> write_file(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) return fail(ErrorCode::kFailed, fmt::format("{}: cannot be written", path.string()));
  return {};
}

std::string nrrd(const std::vector<std::uint8_t>& voxels) {
  std::string bytes = fmt::format(
      "NRRD0004\n"
      "type: uint8\n"
      "dimension: 3\n"
      "space: left-posterior-superior\n"
      "sizes: {0} {0} {0}\n"
      "space directions: (1,0,0) (0,1,0) (0,0,1)\n"
      "kinds: domain domain domain\n"
      "space origin: (0,0,0)\n"
      "encoding: raw\n"
      "\n",
      kSize);
  bytes.append(voxels.begin(), voxels.end());
  return bytes;
}

/// One line per ball: label and name, quoted because it ends in a digit.
constexpr std::string_view kNames = R"(1 "Sphere 1"
2 "Sphere 2"
)";

constexpr std::string_view kTree = R"(Phantom/Sphere 1  color=#e8a33d
Phantom/Sphere 2  color=#4f8fd6
)";

}  // namespace

Result<void> write_files(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return fail(ErrorCode::kFailed, fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  }
  SPLATLAS_RETURN_IF_ERROR(write_file(folder / "labels.nrrd", nrrd(labels())));
  SPLATLAS_RETURN_IF_ERROR(write_file(folder / "volume.nrrd", nrrd(values())));
  SPLATLAS_RETURN_IF_ERROR(write_file(folder / "names.txt", kNames));
  return write_file(folder / "phantom.tree", kTree);
}

}  // namespace splatlas::phantom
