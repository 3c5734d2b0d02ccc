// What an open Atlas holds. Internal: included by the sources of Atlas only.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "format/atlas_reader.h"
#include "format/decision_tree.h"
#include "format/directory.h"
#include "format/file_layout.h"
#include "format/input_file.h"
#include "format/section_reader.h"

namespace splatlas {

struct Atlas::Impl {
  Impl(InputFile opened_file, const FileHeader& checked_header, Directory checked_directory,
       FileLayout file_layout);

  /// A stream that the directory tells of; empty where the file has no such section.
  [[nodiscard]] Result<std::vector<std::byte>> read_stream(SectionKind kind, std::size_t stream) const;
  /// The runs of a class in a stored run model, checked against grid and class table.
  [[nodiscard]] Result<ClassRuns> read_stored_runs(ClassId c, Axis axis) const;
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
  std::vector<std::uint32_t> surface_stream;  ///< [structure]: number of its stream
};

}  // namespace splatlas
