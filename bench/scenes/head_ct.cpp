#include "bench/scenes/head_ct.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "format/result_macros.h"
#include "preprocess/build/build_atlas.h"

namespace splatlas {
namespace {

// Of the file's main.plist.
constexpr std::array<int, 3> kSize{256, 256, 108};
constexpr std::array<double, 3> kSpacingMm{0.957031, 0.957031, 1.5};
constexpr std::size_t kVoxels = std::size_t{256} * 256 * 108;

/// The 16-bit voxels of the CT: member matrix.dat of a tar archive, compressed by gzip.
Result<std::vector<std::int16_t>> read_voxels() {
  const std::string path = head_ct_file().string();
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
  if (!file) {
    return fail(ErrorCode::kFailed,
                fmt::format("{}: is missing; install Debian's package invesalius-examples", path));
  }
  constexpr std::size_t kRecord = 512, kNameBytes = 100, kSizeAt = 124;
  std::array<char, kRecord> header{};
  while (gzfread(header.data(), kRecord, 1, file.get()) == 1) {
    const std::string_view name(header.data(), strnlen(header.data(), kNameBytes));
    const auto bytes = static_cast<std::size_t>(std::strtoull(&header[kSizeAt], nullptr, 8));
    if (name.ends_with("matrix.dat") && bytes == kVoxels * sizeof(std::int16_t)) {
      std::vector<std::int16_t> voxels(kVoxels);
      if (gzfread(voxels.data(), bytes, 1, file.get()) == 1) return voxels;
      break;
    }
    const std::size_t records = (bytes + kRecord - 1) / kRecord;
    if (gzseek(file.get(), static_cast<z_off_t>(records * kRecord), SEEK_CUR) < 0) break;
  }
  return fail(ErrorCode::kFailed, fmt::format("{}: has no matrix.dat of 256 x 256 x 108 voxels", path));
}

/// Neighbours of a finer voxel along one axis, clamped at the ends.
struct Between {
  std::size_t before = 0, behind = 0;
  float share = 0;  ///< of the voxel behind

  Between(int finer, int times, int size) {
    const double at = std::clamp((finer + 0.5) / times - 0.5, 0.0, size - 1.0);
    before = static_cast<std::size_t>(at);
    behind = std::min(before + 1, static_cast<std::size_t>(size - 1));
    share = static_cast<float>(at - static_cast<double>(before));
  }
  [[nodiscard]] float mix(float a, float b) const { return a + share * (b - a); }
};

/// Writes the finer volume as NRRD.
void write_finer(const std::vector<std::int16_t>& voxels, const std::array<int, 3>& times,
                 const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary);
  file << fmt::format(
      "NRRD0004\ntype: int16\ndimension: 3\nspace: left-posterior-superior\nsizes: {} {} {}\n"
      "space directions: ({},0,0) (0,{},0) (0,0,{})\nspace origin: (0,0,0)\nendian: little\nencoding: "
      "raw\n\n",
      kSize[0] * times[0], kSize[1] * times[1], kSize[2] * times[2], kSpacingMm[0] / times[0],
      kSpacingMm[1] / times[1], kSpacingMm[2] / times[2]);
  const auto row_of = [&](std::size_t j, std::size_t k) { return &voxels[(k * 256 + j) * 256]; };
  std::vector<std::int16_t> row(static_cast<std::size_t>(kSize[0] * times[0]));
  for (int k = 0; k < kSize[2] * times[2]; ++k) {
    const Between slices(k, times[2], kSize[2]);
    for (int j = 0; j < kSize[1] * times[1]; ++j) {
      const Between rows(j, times[1], kSize[1]);
      const std::array<const std::int16_t*, 4> around{
          row_of(rows.before, slices.before), row_of(rows.behind, slices.before),
          row_of(rows.before, slices.behind), row_of(rows.behind, slices.behind)};
      for (int i = 0; i < kSize[0] * times[0]; ++i) {
        const Between columns(i, times[0], kSize[0]);
        const auto along = [&](const std::int16_t* of) {
          return columns.mix(of[columns.before], of[columns.behind]);
        };
        const float value = slices.mix(rows.mix(along(around[0]), along(around[1])),
                                       rows.mix(along(around[2]), along(around[3])));
        row[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(std::lround(value));
      }
      file.write(reinterpret_cast<const char*>(row.data()),
                 static_cast<std::streamsize>(row.size() * sizeof(std::int16_t)));
    }
  }
}

}  // namespace

std::filesystem::path head_ct_file() {
  return "/usr/share/doc/invesalius-examples/examples/Cranium.inv3";
}

Result<BuildReport> build_head_ct(const std::array<int, 3>& times, const std::filesystem::path& folder,
                                  const BenchOptions& options) {
  const std::string name = fmt::format("{}x{}x{}", times[0], times[1], times[2]);
  options.tell(fmt::format("building the atlas of the CT, finer {}", name));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::int16_t> voxels, read_voxels());
  BuildOptions build;
  build.sources.volume = folder / (name + ".nrrd");
  write_finer(voxels, times, build.sources.volume);
  for (const char* const rule : {"Bone=threshold:226", "Soft tissue=threshold:-200:226"}) {
    SPLATLAS_ASSIGN_OR_RETURN(SegmentRule segment, parse_segment(rule));
    build.sources.segments.push_back(std::move(segment));
  }
  build.tool = "splatlas-bench";
  build.output = folder / (name + ".atlas");
  return build_atlas(build);
}

}  // namespace splatlas
