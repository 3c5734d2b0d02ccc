// What an open Atlas holds. Internal: included by the sources of Atlas only.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "format/atlas_reader.h"
#include "format/decision_tree.h"
#include "format/derive/boundary_split.h"
#include "format/derive/structure_crop.h"
#include "format/derive/value_groups.h"
#include "format/file/directory.h"
#include "format/file/file_layout.h"
#include "format/file/held_values.h"
#include "format/file/section_reader.h"
#include "format/system/input_file.h"

namespace splatlas {

struct Atlas::Impl {
  Impl(InputFile opened_file, const FileHeader& checked_header, Directory checked_directory,
       RunStreams streams, FileLayout file_layout);

  /// A stream that the directory tells of; empty where the file has no such section.
  [[nodiscard]] Result<std::vector<std::byte>> read_stream(SectionKind kind, std::size_t stream) const;
  /// The runs of a class in a stored run model, checked against grid and class table.
  [[nodiscard]] Result<ClassRuns> read_stored_runs(ClassId c, Axis axis) const;
  /// The same in a run model that the file does not store, from that of z.
  [[nodiscard]] Result<ClassRuns> derive_runs(ClassId c, Axis axis) const;
  /// Whether the class and another one have one list in a stored run model, and their runs from it.
  [[nodiscard]] bool shares_runs(ClassId c, Axis axis) const;
  using SharedSplit = std::shared_ptr<const SplitRuns>;
  [[nodiscard]] Result<SharedSplit> read_split_runs(ClassId c, Axis axis) const;
  [[nodiscard]] Result<SplitRuns> split_runs(ClassId c, Axis axis) const;
  /// The list in a class's stream, which is of `voxels` voxels.
  [[nodiscard]] Result<ClassRuns> read_run_list(ClassId c, Axis axis, std::uint64_t voxels) const;
  /// The box around the voxels in a class's stream.
  [[nodiscard]] IndexBox list_box(ClassId c, Axis axis) const;
  /// The voxels of a structure in a box; `around`: and as far away as normals in it depend on.
  [[nodiscard]] Result<StructureCrop> read_crop(StructureIndex s, const IndexBox& box, bool around) const;
  [[nodiscard]] Result<SurfaceMesh> fit_surface_of(StructureIndex s) const;
  [[nodiscard]] Result<std::vector<PackedNormal>> fit_normals_of(ClassId c) const;
  /// The voxels of a group of classes.
  [[nodiscard]] Result<std::vector<ClassSpan>> read_spans(std::size_t group) const;
  [[nodiscard]] Result<HeldValues::GroupValues> decode_group(std::size_t group) const;
  [[nodiscard]] Result<std::vector<std::byte>> read_class_values(ClassId c) const;
  [[nodiscard]] Result<void> check_class(ClassId c) const;
  [[nodiscard]] Result<void> check_structure(StructureIndex s) const;

  /// The error again with the file's name before it.
  [[nodiscard]] tl::unexpected<Error> named(const Error& error) const {
    return fail(error.code, file.name() + ": " + error.message);
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
  std::vector<std::uint32_t> surface_stream;  ///< [structure]: number of its stream
  HeldClasses held_classes;

  /// Runs that were split lately: those of the other class, and values and normals, are often next.
  struct LateSplit {
    ClassId first = kEmptyClass;
    Axis axis = Axis::kZ;
    SharedSplit runs;
  };
  static constexpr std::size_t kLateSplits = 256;
  mutable std::mutex late_mutex;
  mutable std::deque<LateSplit> late_splits;  // latest last

  static constexpr std::uint64_t kMaxHeldBytes = std::uint64_t{1} << 27;
  mutable HeldValues held_values;
};

}  // namespace splatlas
