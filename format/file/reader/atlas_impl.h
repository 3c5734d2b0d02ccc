// Reader of the streams of an open file, and private state of Atlas; included only by its sources.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "format/atlas_reader.h"
#include "format/codec/value_codec.h"
#include "format/content/decision_tree.h"
#include "format/derive/boundary_split.h"
#include "format/derive/run_fingerprint.h"
#include "format/derive/structure_crop.h"
#include "format/derive/value_groups.h"
#include "format/file/directory.h"
#include "format/file/file_layout.h"
#include "format/file/reader/value_cache.h"
#include "format/io/input_file.h"
#include "format/io/memory_limit.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {

/// Reads, checks and decodes streams by section and index. Counts bytes. Thread-safe. Keeps references.
class SectionReader {
 public:
  SectionReader(const InputFile& file, const Directory& directory, const FileLayout& layout);

  /// Decodes a whole stream. kInvalidAtlas for damage, with the section and stream in the message.
  [[nodiscard]] Result<std::vector<std::byte>> read_stream(const SectionLayout& section,
                                                           std::size_t stream) const;
  /// Reads the n-th chunk of a section and verifies its checksum. Decodes chunks of known sections.
  [[nodiscard]] Result<void> check_chunk_of(const SectionLayout& section, std::uint32_t n) const;
  /// The stored bytes of the n-th chunk of a section, with a right checksum.
  [[nodiscard]] Result<std::vector<std::byte>> read_chunk_of(const SectionLayout& section,
                                                             std::uint32_t n) const;

  /// Stored bytes of the chunks read so far, each counted once, and decoded bytes, counted every time.
  [[nodiscard]] std::uint64_t read_bytes() const { return read_bytes_; }
  [[nodiscard]] std::uint64_t decoded_bytes() const { return decoded_bytes_; }

 private:
  using Bytes = std::vector<std::byte>;
  /// Cached chunk of several streams: its other streams are often read next.
  struct Shared {
    std::size_t chunk = 0;
    std::shared_ptr<const Bytes> bytes;  // null while another thread decodes it
  };
  static constexpr std::size_t kSharedKept = 16;  // per section

  [[nodiscard]] Result<Bytes> read_stored(std::size_t chunk) const;
  [[nodiscard]] Result<void> decode(const SectionLayout& section, std::size_t n,
                                    std::span<std::byte> to) const;
  /// Decodes a chunk once, even if several threads request its streams.
  [[nodiscard]] Result<std::shared_ptr<const Bytes>> decode_shared(const SectionLayout& section,
                                                                   std::size_t n) const;
  /// "values of class 12", "runs_z of classes 4 to 9", "surfaces of structure 'ACC_L'".
  [[nodiscard]] std::string describe(const SectionLayout& section, std::size_t n) const;

  const InputFile& file_;
  const Directory& directory_;
  const FileLayout& layout_;
  mutable std::vector<std::atomic<bool>> touched_;  // per chunk of the file
  mutable std::atomic<std::uint64_t> read_bytes_{0}, decoded_bytes_{0};
  mutable std::mutex shared_mutex_;
  mutable std::condition_variable shared_changed_;
  mutable std::vector<std::deque<Shared>> shared_;  // per section, most recent last
};

struct Atlas::Impl {
  Impl(InputFile opened_file, const FileHeader& checked_header, Directory checked_directory,
       RunStreams streams, FileLayout file_layout, const AtlasOptions& options);

  /// Reads and decodes a stream; empty if the file has no such section.
  [[nodiscard]] Result<std::vector<std::byte>> read_stream(SectionKind kind, std::size_t stream) const;
  /// The runs of a class in a stored run model, checked against grid and class table.
  [[nodiscard]] Result<ClassRuns> read_stored_runs(ClassId c, Axis axis) const;
  /// The runs of a class in a run model that is not stored, derived from the z model.
  [[nodiscard]] Result<ClassRuns> derive_runs(ClassId c, Axis axis) const;
  /// True if the class shares its list in a stored run model with another one. read_split_runs() splits it.
  [[nodiscard]] bool shares_runs(ClassId c, Axis axis) const;
  using SharedSplit = std::shared_ptr<const SplitRuns>;
  [[nodiscard]] Result<SharedSplit> read_split_runs(ClassId c, Axis axis) const;
  [[nodiscard]] Result<SplitRuns> split_runs(ClassId c, Axis axis) const;
  /// Checks runs of a class against its box and fingerprint.
  [[nodiscard]] Result<void> check_voxels(ClassId c, Axis axis, const ClassRuns& runs) const;
  /// The run list in the stream of a class, with `voxels` voxels.
  [[nodiscard]] Result<ClassRuns> read_run_list(ClassId c, Axis axis, std::uint64_t voxels) const;
  /// Bounding box of the voxels in the stream of a class.
  [[nodiscard]] IndexBox list_box(ClassId c, Axis axis) const;
  /// Calls take(runs, part) with the runs (principal axis z) of a structure's classes that overlap a box.
  template <typename Take>
  [[nodiscard]] Result<void> read_parts(StructureIndex s, const IndexBox& near, const Take& take) const;
  /// Paints the voxels of a structure into an empty crop.
  [[nodiscard]] Result<StructureCrop> read_crop(StructureIndex s, StructureCrop crop) const;
  /// The rows of a structure; those of classes that do not overlap a box may be missing.
  [[nodiscard]] Result<PartRows> read_rows(StructureIndex s, const IndexBox& near) const;
  /// The rule by which a surface is derived: that of the file or of AtlasOptions.
  [[nodiscard]] SurfaceRule rule_of_surface(StructureIndex s) const;
  [[nodiscard]] Result<SurfaceMesh> fit_surface_of(StructureIndex s) const;
  [[nodiscard]] Result<std::optional<SurfaceMesh>> fit_coarse_surface(StructureIndex s, int level) const;
  [[nodiscard]] Result<std::vector<PackedNormal>> fit_normals_of(ClassId c) const;
  /// The voxels of a group of classes.
  [[nodiscard]] Result<std::vector<ClassSpan>> read_spans(std::size_t group) const;
  /// The same, of any of its classes.
  [[nodiscard]] Result<std::vector<ClassSpan>> read_undivided_spans(std::size_t group) const;
  /// Decodes the stream of a group in section values or means; `voxels` are those of the stream.
  [[nodiscard]] Result<std::vector<std::byte>> decode_values_of(std::size_t group, SectionKind kind,
                                                                const GroupVoxels& voxels) const;
  [[nodiscard]] Result<ValueCache::GroupValues> decode_group(std::size_t group) const;
  [[nodiscard]] Result<BlockMeans> read_group_means(std::size_t group) const;
  /// Decodes the values of a group, and compares its means with them.
  [[nodiscard]] Result<void> verify_values(std::size_t group) const;
  [[nodiscard]] Result<std::vector<std::byte>> read_class_values(ClassId c) const;
  [[nodiscard]] Result<void> check_class(ClassId c) const;
  [[nodiscard]] Result<void> check_structure(StructureIndex s) const;
  /// Counts the runs of a class when it is first read. kInvalidAtlas if the axis then has more than the
  /// directory states; nothing is counted in this case. The order of reading decides which class fails.
  [[nodiscard]] Result<void> count_runs(ClassId c, Axis axis, std::size_t runs) const;

  /// Calls body(), the work of a public function, as a task with the budget, unless the thread works on a
  /// task already. Excess and std::bad_alloc become kLimit. `purpose` is empty, or begins with " for ".
  template <typename Body, typename... Args>
  [[nodiscard]] auto guarded(const Body& body, fmt::format_string<const Args&...> purpose = "",
                             const Args&... args) const -> decltype(body()) {
    try {
      if (TaskControl::current() != nullptr) return body();
      const TaskControl task({}, {}, &budget);
      return body();
    } catch (const OverBudget& over) {
      return tl::unexpected(over.error());
    } catch (const std::bad_alloc&) {
      return named(ErrorCode::kLimit, "out of memory{}; {}", fmt::format(purpose, args...),
                   kOutOfMemoryRemedy);
    }
  }

  /// An error with the file as its subject.
  [[nodiscard]] tl::unexpected<Error> named(const Error& error) const {
    return named(error.code, "{}", error.message);
  }
  template <typename... Args>
  [[nodiscard]] tl::unexpected<Error> named(ErrorCode code, fmt::format_string<Args...> text,
                                            Args&&... args) const {
    return tl::unexpected(
        Error{code, fmt::format("{}: {}", file.name(), fmt::format(text, std::forward<Args>(args)...)),
              file.name()});
  }

  InputFile file;
  FileHeader header;
  Directory directory;
  Grid grid;
  FileLayout layout;
  DecisionTree tree;
  SectionReader sections;
  RunStreams run_streams;
  const ValueGroups& groups;
  std::vector<std::uint32_t> surface_stream;  ///< [structure]: index of its stream
  StructureClasses structure_classes;
  RunFingerprinter fingerprinter;
  SurfaceChoice surfaces;
  WorkBudget budget;

  mutable std::mutex runs_mutex;                          // guards the next two
  mutable std::array<std::vector<bool>, 3> runs_counted;  // [axis][class]
  mutable std::array<std::uint64_t, 3> runs_read{};       // [axis], of counted classes; at most run_totals

  /// Cache of split runs: the other class, its values and normals are often read next.
  struct RecentSplit {
    ClassId first = kEmptyClass;
    Axis axis = Axis::kZ;
    SharedSplit runs;
  };
  static constexpr std::size_t kMaxRecentSplits = 256;
  mutable std::mutex recent_mutex;
  mutable std::deque<RecentSplit> recent_splits;  // most recent last

  static constexpr std::uint64_t kMaxCachedBytes = std::uint64_t{1} << 27;
  mutable ValueCache value_cache;
};

}  // namespace splatlas
