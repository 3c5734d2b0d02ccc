#include "bench/decoding.h"

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "bench/atlases.h"
#include "bench/measure.h"
#include "format/atlas_reader.h"
#ifdef SPLATLAS_HAS_DRACO
#include "bench/peers/draco_peer.h"
#include "format/system/result_macros.h"
#endif

namespace splatlas {
namespace {

namespace fs = std::filesystem;

enum Part : std::size_t { kLabels, kValues, kSurfaces, kNormals, kAllParts };
constexpr std::array kPartNames{"labels", "values", "surfaces", "normals at boundaries"};

/// Part by part, as in read_all().
Result<std::vector<Elapsed>> decode_atlas(const fs::path& file) {
  std::vector<Elapsed> parts(kAllParts);
  Stopwatch watch;
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(file));
  SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_classes());
  parts[kLabels] = watch.lap();
  SPLATLAS_ASSIGN_OR_RETURN(const VoxelBuffer values, atlas->read_value_volume(content.class_volume));
  parts[kValues] = watch.lap();
  for (StructureIndex s = 0; s < atlas->graph().size(); ++s) SPLATLAS_RETURN_IF_ERROR(atlas->read_surface(s));
  parts[kSurfaces] = watch.lap();
  for (ClassId c = 0; c < atlas->classes().size(); ++c) SPLATLAS_RETURN_IF_ERROR(atlas->read_normals(c));
  parts[kNormals] = watch.lap();
  return parts;
}

Result<void> gunzip(const fs::path& path) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(::gzopen(path.c_str(), "rb"), ::gzclose);
  std::vector<std::byte> bytes(std::size_t{1} << 20);
  int count = file == nullptr ? -1 : 1;
  while (count > 0) count = ::gzread(file.get(), bytes.data(), static_cast<unsigned>(bytes.size()));
  if (count < 0) return fail(ErrorCode::kFailed, path.string() + ": cannot be read by zlib");
  return {};
}

/// Draco files of the surfaces; empty without Draco.
using DracoFiles = std::vector<std::vector<std::byte>>;

Result<DracoFiles> draco_files([[maybe_unused]] const fs::path& atlas_file) {
  DracoFiles files;
#ifdef SPLATLAS_HAS_DRACO
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(atlas_file));
  for (StructureIndex s = 0; s < atlas->graph().size(); ++s) {
    SPLATLAS_ASSIGN_OR_RETURN(const SurfaceMesh mesh, atlas->read_surface(s));
    SPLATLAS_ASSIGN_OR_RETURN(files.emplace_back(),
                              draco_peer::encode(mesh, {.position_bits = 11, .normal_bits = 8}));
  }
#endif
  return files;
}

Result<std::vector<Elapsed>> decode_parts(const SourceFiles& sources,
                                          [[maybe_unused]] const DracoFiles& surfaces) {
  std::vector<Elapsed> parts(kAllParts);
  Stopwatch watch;
  SPLATLAS_RETURN_IF_ERROR(gunzip(sources.labels));
  parts[kLabels] = watch.lap();
  SPLATLAS_RETURN_IF_ERROR(gunzip(sources.volume));
  parts[kValues] = watch.lap();
#ifdef SPLATLAS_HAS_DRACO
  for (const std::vector<std::byte>& file : surfaces) SPLATLAS_RETURN_IF_ERROR(draco_peer::decode(file));
  parts[kSurfaces] = watch.lap();
#endif
  return parts;
}

}  // namespace

Result<Table> measure_decoding(const fs::path& file, const BenchOptions& options,
                               nlohmann::ordered_json& summary) {
  Table table{"decoding",
              "Decoding of Colin 27 with AAL: the whole atlas, against gunzip and Draco of its parts",
              {"CPU time of one thread, median of turns; parts have no boundary normals"},
              {}};
  options.tell("decoding everything");
  SPLATLAS_ASSIGN_OR_RETURN(const SourceFiles sources, aal_sources());
  SPLATLAS_ASSIGN_OR_RETURN(const DracoFiles surfaces, draco_files(file));
  const std::array<Contender, 2> contenders{[&](int) { return decode_atlas(file); },
                                            [&](int) { return decode_parts(sources, surfaces); }};
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, options.quick ? 3 : 9));
  double ours_ms = 0, theirs_ms = 0;
  const auto add = [&](const char* part, double ours, double theirs) {
    table.rows.push_back(
        {{"part", part},
         {"atlas_cpu_ms", ours},
         {"parts_cpu_ms", theirs},
         {"ratio", theirs > 0 ? nlohmann::ordered_json(ours / theirs) : nlohmann::ordered_json()}});
  };
  for (std::size_t part = 0; part < kAllParts; ++part) {
    const double ours = median(times[0][part]).cpu_ms, theirs = median(times[1][part]).cpu_ms;
    add(kPartNames[part], ours, theirs);
    ours_ms += ours;
    theirs_ms += theirs;
    if (part == kValues) summary["decode_images_vs_gunzip"] = ours_ms / theirs_ms;
  }
  add("everything", ours_ms, theirs_ms);
  summary["decode_all_vs_parts"] = ours_ms / theirs_ms;
  return table;
}

}  // namespace splatlas
