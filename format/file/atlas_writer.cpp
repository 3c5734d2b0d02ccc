#include "format/atlas_writer.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <new>
#include <numeric>
#include <utility>

#include "format/codec/chunk_codec.h"
#include "format/codec/mask_codec.h"
#include "format/codec/run_codec.h"
#include "format/codec/surface_codec.h"
#include "format/codec/value_codec.h"
#include "format/content/run_model.h"
#include "format/derive/boundary_split.h"
#include "format/derive/fit_surface.h"
#include "format/file/directory.h"
#include "format/file/file_layout.h"
#include "format/file/fitted_content.h"
#include "format/io/memory_limit.h"
#include "format/io/output_file.h"
#include "format/result_macros.h"
#include "format/tasks/free_memory.h"
#include "format/tasks/thread_pool.h"

namespace splatlas {

namespace {

constexpr std::uint32_t kChunkBytes = 256 * 1024;
/// Streams up to this length share a chunk. Larger: small classes compress better; smaller: less is read.
constexpr std::uint32_t kSharedBytes = 512;

/// Fraction of a section's work before compression, for progress.
constexpr double kGathering = 0.3;

/// Decoded bytes of a section: its streams, concatenated.
using SectionBytes = std::vector<std::byte>;

/// Encodes section by section: gathers the streams, divides them into chunks and compresses these. Frees the
/// arrays of the content as it goes.
class AtlasEncoder {
 public:
  AtlasEncoder(AtlasContent content, const WriteOptions& options);
  [[nodiscard]] Result<std::vector<std::byte>> encode();

 private:
  [[nodiscard]] Result<SectionBytes> gather(SectionKind kind);
  [[nodiscard]] Result<SectionBytes> gather_runs(Axis axis);
  void append_runs(const ClassRuns& runs, const IndexBox& box, Axis axis, SectionBytes& bytes) const;
  [[nodiscard]] ClassRuns joined_runs(const RunStreams& streams, const RunModel& model, ClassId c) const;
  [[nodiscard]] SectionBytes gather_values();
  [[nodiscard]] SectionBytes gather_means();
  [[nodiscard]] SectionBytes gather_normals() const;
  [[nodiscard]] Result<SectionBytes> gather_surfaces();
  void leave_out_fitted_parts();
  void free_arrays_of(SectionKind done);
  void add_section(SectionKind kind, const SectionBytes& decoded);
  [[nodiscard]] Result<std::vector<std::byte>> assemble();
  void report(double fraction_of_section) const;

  AtlasContent content_;
  const WriteOptions& options_;
  const Index3 size_;
  Directory directory_;
  std::vector<FittedSurface> fitted_surfaces_;  // [structure]
  RunModel z_runs_;
  std::vector<EncodedMeans> means_;             // [group]
  std::vector<std::vector<std::byte>> chunks_;  // stored bytes, in file order
  double work_before_ = 0, work_now_ = 0, work_ = 0;
};

Directory describe(const AtlasContent& content) {
  Directory directory;
  directory.source_grid = content.source_grid;
  directory.source_to_storage = content.source_to_storage;
  directory.value_type = content.values.type;
  directory.label_type = content.label_type;
  directory.display = content.display;
  directory.graph = content.graph;
  directory.classes = content.classes;
  directory.run_bytes.resize(content.classes.size());
  directory.normals_fitted.resize(content.classes.size());
  directory.surfaces.resize(content.graph.size());
  directory.scenes = content.scenes;
  directory.provenance = content.provenance;
  return directory;
}

bool stores_means(const ValueGroups& groups, const ClassTable& classes, std::size_t group,
                  const WriteOptions& options) {
  return group != groups.group_of[kEmptyClass] && group_voxels(groups, classes, group) >= options.means_from;
}

std::vector<SectionKind> sections_of(const AtlasContent& content, const WriteOptions& options) {
  std::vector<SectionKind> kinds;
  if (!options.compact) kinds = {SectionKind::kRunsX, SectionKind::kRunsY};
  kinds.push_back(SectionKind::kRunsZ);
  if (!content.values.empty()) kinds.push_back(SectionKind::kValues);
  kinds.push_back(SectionKind::kNormals);
  kinds.push_back(SectionKind::kSurfaces);
  const ValueGroups groups(content.classes);
  std::size_t g = 0;
  while (g < groups.size() && !stores_means(groups, content.classes, g, options)) ++g;
  if (g < groups.size() && !content.values.empty()) kinds.push_back(SectionKind::kMeans);
  return kinds;
}

/// Estimated work of a section, for progress: bytes to compress.
double work_of(SectionKind kind, const AtlasContent& content) {
  if (kind == SectionKind::kValues) return static_cast<double>(content.values.bytes.size());
  if (kind != SectionKind::kSurfaces) return static_cast<double>(content.class_volume.size()) / 8;
  double triangles = 1;
  for (const SurfaceMesh& mesh : content.surfaces) triangles += static_cast<double>(mesh.triangles.size());
  return 8 * triangles;
}

AtlasEncoder::AtlasEncoder(AtlasContent content, const WriteOptions& options)
    : content_(std::move(content)),
      options_(options),
      size_(storage_grid(content_).size),
      directory_(describe(content_)) {}

Result<std::vector<std::byte>> AtlasEncoder::encode() {
  const std::vector<SectionKind> kinds = sections_of(content_, options_);
  z_runs_ = encode_runs(content_.class_volume, size_, Axis::kZ, content_.classes.size());
  leave_out_fitted_parts();
  std::vector<double> works;
  for (const SectionKind kind : kinds) works.push_back(work_of(kind, content_));
  work_ = std::accumulate(works.begin(), works.end(), 0.0);
  for (std::size_t n = 0; n < kinds.size(); ++n) {
    work_now_ = works[n];
    report(0);
    SPLATLAS_ASSIGN_OR_RETURN(const SectionBytes decoded, gather(kinds[n]));
    free_arrays_of(kinds[n]);
    add_section(kinds[n], decoded);
    work_before_ += work_now_;
  }
  SPLATLAS_RETURN_IF_ERROR(validate(directory_));
  auto file = assemble();
  work_now_ = 0;
  report(1);
  return file;
}

/// Frees what no later section needs.
void AtlasEncoder::free_arrays_of(SectionKind done) {
  if (done == SectionKind::kRunsZ) free_memory(content_.class_volume);
  if (done == SectionKind::kNormals) free_memory(content_.boundary_normals);
  if (done != SectionKind::kValues) return;
  free_memory(content_.values.bytes);
  free_memory(z_runs_.classes);
}

Result<SectionBytes> AtlasEncoder::gather(SectionKind kind) {
  switch (kind) {
    case SectionKind::kRunsX: return gather_runs(Axis::kX);
    case SectionKind::kRunsY: return gather_runs(Axis::kY);
    case SectionKind::kRunsZ: return gather_runs(Axis::kZ);
    case SectionKind::kValues: return gather_values();
    case SectionKind::kNormals: return gather_normals();
    case SectionKind::kMeans: return gather_means();
    case SectionKind::kSurfaces: break;
  }
  return gather_surfaces();
}

/// The merged runs of an interior and its boundary class, if split_boundary() restores both; else empty.
ClassRuns AtlasEncoder::joined_runs(const RunStreams& streams, const RunModel& model, ClassId c) const {
  if (!streams.may_share(c)) return {};
  const auto pair = streams.pair_of(c);
  const ClassRuns& interior = model.classes[pair[0]];
  const ClassRuns& boundary = model.classes[pair[1]];
  if (c != pair[0] || boundary.empty()) return {};
  ClassRuns both = join_runs(interior, boundary);
  const SplitRuns split = split_boundary(both, size_, model.axis);
  return split.interior == interior && split.boundary == boundary ? both : ClassRuns{};
}

/// Encodes runs as a list, which is fastest to read, or in compact files as a mask if that is smaller.
void AtlasEncoder::append_runs(const ClassRuns& runs, const IndexBox& box, Axis axis,
                               SectionBytes& bytes) const {
  std::vector<std::byte> list;
  append_run_list(runs, list);
  std::uint64_t voxels = 0;
  for (const Run& run : runs) voxels += run.length;
  if (options_.compact && codes_mask(box, voxels)) {
    std::vector<std::byte> mask = encode_mask(runs, box, size_, axis);
    const std::size_t list_bytes = encode_chunk(list, options_.level, ChunkContent::kAny).bytes.size();
    if (mask.size() >= min_run_list_bytes(voxels) && mask.size() < list_bytes) list = std::move(mask);
  }
  bytes.insert(bytes.end(), list.begin(), list.end());
}

Result<SectionBytes> AtlasEncoder::gather_runs(Axis axis) {
  RunModel encoded;
  if (axis != Axis::kZ) encoded = encode_runs(content_.class_volume, size_, axis, content_.classes.size());
  const RunModel& model = axis != Axis::kZ ? encoded : z_runs_;
  const auto a = static_cast<std::size_t>(axis);
  directory_.run_totals[a] = model.runs();
  const RunStreams streams(content_.classes);
  SectionBytes bytes;
  std::vector<bool> done(model.classes.size(), false);
  for (ClassId c = 0; c < model.classes.size(); ++c) {
    if (done[c]) continue;
    const std::size_t begin = bytes.size();
    IndexBox box = content_.classes.box(c);
    if (const ClassRuns both = joined_runs(streams, model, c); !both.empty()) {
      const ClassId other = streams.pair_of(c)[1];
      box.include(content_.classes.box(other));
      append_runs(both, box, axis, bytes);
      done[other] = true;
    } else {
      append_runs(model.classes[c], box, axis, bytes);
    }
    if (bytes.size() - begin > std::numeric_limits<std::uint32_t>::max()) {
      return fail(ErrorCode::kFailed, "the run list of class {} is longer than 4 GiB", c);
    }
    directory_.run_bytes[c][a] = static_cast<std::uint32_t>(bytes.size() - begin);
  }
  if (axis == Axis::kZ) {
    directory_.fingerprints = RunFingerprinter(size_).of_classes(z_runs_);
    if (!options_.compact) return bytes;
    for (const Axis left_out : {Axis::kX, Axis::kY}) {  // whose run models the file omits
      directory_.run_totals[static_cast<std::size_t>(left_out)] =
          encode_runs(content_.class_volume, size_, left_out, content_.classes.size()).runs();
    }
  }
  return bytes;
}

SectionBytes AtlasEncoder::gather_values() {
  const ValueGroups groups(content_.classes);
  const std::vector<std::uint64_t> begins = begins_of(stream_sizes(directory_, SectionKind::kValues));
  SectionBytes bytes(begins.back());
  means_.resize(groups.size());
  parallel_for(
      groups.size(), options_.threads,
      [&](std::size_t g) {
        const bool with_means = stores_means(groups, content_.classes, g, options_);
        means_[g] = encode_group(content_, z_runs_, groups, g, with_means,
                                 std::span(bytes).subspan(begins[g], begins[g + 1] - begins[g]));
      },
      [&](std::size_t done) {
        report(kGathering * static_cast<double>(done) / static_cast<double>(groups.size()));
      });
  return bytes;
}

SectionBytes AtlasEncoder::gather_means() {
  SectionBytes bytes;
  for (const EncodedMeans& of_group : means_) {
    directory_.mean_blocks.push_back(of_group.blocks);
    bytes.insert(bytes.end(), of_group.code.begin(), of_group.code.end());
  }
  return bytes;
}

/// Marks surfaces and normals that readers can fit. Outside compact files, normals are fitted only if that
/// needs no voxels of other classes.
void AtlasEncoder::leave_out_fitted_parts() {
  const FittedParts fitted = find_fitted_parts(content_, z_runs_, options_.threads);
  fitted_surfaces_ = fitted.surfaces;
  const ClassTable& classes = content_.classes;
  const std::size_t structures = content_.graph.size();
  const std::vector<bool> uniform = find_uniform(classes, StructureClasses(classes, structures), structures);
  for (ClassId c = 0; c < fitted.normals.size(); ++c) {
    directory_.normals_fitted[c] =
        fitted.normals[c] && (options_.compact || uniform[normal_owner(classes.members(c))]);
  }
}

SectionBytes AtlasEncoder::gather_normals() const {
  SectionBytes bytes;
  for (ClassId c = 0; c < content_.classes.size(); ++c) {
    if (!stores_normals(directory_, c)) continue;
    const auto raw = std::as_bytes(std::span(content_.boundary_normals[c]));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  }
  return bytes;
}

Result<SectionBytes> AtlasEncoder::gather_surfaces() {
  const std::size_t count = content_.surfaces.size();
  std::vector<Result<EncodedSurface>> encoded(count);
  parallel_for(
      count, options_.threads,
      [&](std::size_t s) {
        const SurfaceMesh& mesh = content_.surfaces[s];
        if (const FittedSurface& fit = fitted_surfaces_[s]; fit.triangles > 0) {
          encoded[s] =
              EncodedSurface{{fit.vertices, fit.triangles, static_cast<std::uint32_t>(fit.rule), 0}, {}};
        } else {
          encoded[s] = encode_surface(mesh, size_);
        }
      },
      [&](std::size_t done) { report(kGathering * static_cast<double>(done) / static_cast<double>(count)); });
  for (StructureIndex s = 0; s < count; ++s) {
    if (!encoded[s]) {
      return fail(encoded[s].error().code, "surface of structure '{}': {}", content_.graph[s].id,
                  encoded[s].error().message);
    }
    directory_.surfaces[s] = encoded[s]->entry;
  }
  SectionBytes bytes;
  for (const StructureIndex s : content_.graph.preorder()) {
    bytes.insert(bytes.end(), encoded[s]->bytes.begin(), encoded[s]->bytes.end());
  }
  return bytes;
}

/// Divides the streams into chunks and compresses these in parallel. Chunks depend only on their content.
void AtlasEncoder::add_section(SectionKind kind, const SectionBytes& decoded) {
  constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint32_t>::max();
  const std::vector<std::uint64_t> begins = begins_of(stream_sizes(directory_, kind));
  const std::vector<std::uint64_t> cuts = *cut_streams(begins, kChunkBytes, kSharedBytes, kNoLimit);
  const std::size_t count = cuts.size() - 1, first = chunks_.size();
  directory_.sections.push_back(
      {static_cast<std::uint32_t>(kind), static_cast<std::uint32_t>(count), kChunkBytes, kSharedBytes});
  directory_.chunks.resize(first + count);
  chunks_.resize(first + count);
  parallel_for(
      count, options_.threads,
      [&](std::size_t n) {
        EncodedChunk chunk =
            encode_chunk(std::span(decoded).subspan(cuts[n], cuts[n + 1] - cuts[n]), options_.level,
                         kind == SectionKind::kValues ? ChunkContent::kNoise : ChunkContent::kAny);
        directory_.chunks[first + n] = chunk.entry;
        chunks_[first + n] = std::move(chunk.bytes);
      },
      [&](std::size_t done) {
        report(kGathering + (1 - kGathering) * static_cast<double>(done) / static_cast<double>(count));
      });
}

Result<std::vector<std::byte>> AtlasEncoder::assemble() {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> directory, encode_directory(directory_));
  SPLATLAS_ASSIGN_OR_RETURN(const FileLayout layout, lay_out(directory_, directory.size()));
  const FileHeader header = make_header(directory, layout.file_bytes());
  std::vector<std::byte> file(layout.file_bytes());
  std::memcpy(file.data(), &header, sizeof header);
  std::ranges::copy(directory, file.begin() + sizeof header);
  for (std::size_t n = 0; n < chunks_.size(); ++n) {
    std::ranges::copy(chunks_[n], file.begin() + static_cast<std::ptrdiff_t>(layout.chunk_offset[n]));
    free_memory(chunks_[n]);
  }
  return file;
}

void AtlasEncoder::report(double fraction_of_section) const {
  if (options_.progress)
    options_.progress(std::min(1.0, (work_before_ + work_now_ * fraction_of_section) / work_));
}

}  // namespace

Result<std::vector<std::byte>> encode_atlas(AtlasContent content, const WriteOptions& options) {
  if (options.level < 1 || options.level > 22) {
    return fail(ErrorCode::kUsage, "compression level {} is not between 1 and 22", options.level);
  }
  try {
    Result<void> checked = check_content(content);
    auto file =
        checked ? AtlasEncoder(std::move(content), options).encode() : tl::unexpected(checked.error());
    if (!file) return fail(ErrorCode::kFailed, "cannot write this atlas: " + file.error().message);
    return file;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kLimit, "cannot write this atlas: out of memory; {}", kOutOfMemoryRemedy);
  }
}

Result<void> write_atlas(AtlasContent content, const std::filesystem::path& path,
                         const WriteOptions& options) {
  auto file = encode_atlas(std::move(content), options);
  if (!file) return fail(file.error().code, path.string() + ": " + file.error().message);
  return write_file(path, *file);
}

}  // namespace splatlas
