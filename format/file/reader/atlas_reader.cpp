#include "format/atlas_reader.h"

#include <algorithm>
#include <new>

#include <fmt/format.h>

#include "format/file/reader/atlas_impl.h"
#include "format/io/checksum.h"
#include "format/io/memory_limit.h"
#include "format/result_macros.h"

namespace splatlas {

namespace {

struct OpenedDirectory {
  FileHeader header;
  Directory directory;
  RunStreams streams;
  FileLayout layout;
};

/// Bytes of the file without sections of unknown kinds: they do not need work.
std::uint64_t known_bytes(const FileLayout& layout) {
  std::uint64_t bytes = layout.file_bytes();
  for (const SectionLayout& section : layout.sections) {
    if (section.stream_begin.empty()) bytes -= section.stored_bytes;
  }
  return bytes;
}

/// Reads and checks header and directory. Each is read once: later changes of the file have no effect.
Result<OpenedDirectory> read_directory(const InputFile& file) {
  std::vector<std::byte> start(std::min<std::uint64_t>(file.size(), sizeof(FileHeader)));
  SPLATLAS_RETURN_IF_ERROR(file.read(0, start));
  SPLATLAS_ASSIGN_OR_RETURN(const FileHeader header, check_header(start, file.size()));
  std::vector<std::byte> bytes(header.directory_bytes);  // allocated with 16-byte alignment
  SPLATLAS_RETURN_IF_ERROR(file.read(header.directory_offset, bytes));
  if (const std::uint64_t found = checksum_of(bytes); found != header.directory_checksum)
    return wrong_checksum("directory", found, header.directory_checksum);
  SPLATLAS_ASSIGN_OR_RETURN(Directory directory, decode_directory(bytes));
  RunStreams streams(directory.classes);
  SPLATLAS_RETURN_IF_ERROR(validate(directory, streams));
  SPLATLAS_ASSIGN_OR_RETURN(FileLayout layout, lay_out(directory, streams.groups(), header.directory_bytes));
  if (layout.file_bytes() != header.file_bytes) {
    return invalid_atlas("invalid: chunks end at {}, the file has {} bytes", layout.file_bytes(),
                         header.file_bytes);
  }
  return OpenedDirectory{header, std::move(directory), std::move(streams), std::move(layout)};
}

}  // namespace

Atlas::Impl::Impl(InputFile opened_file, const FileHeader& checked_header, Directory checked_directory,
                  RunStreams streams, FileLayout file_layout, const AtlasOptions& options)
    : file(std::move(opened_file)),
      header(checked_header),
      directory(std::move(checked_directory)),
      grid(reordered(directory.source_grid, directory.source_to_storage)),
      layout(std::move(file_layout)),
      tree(directory.graph, directory.classes),
      sections(file, directory, layout),
      run_streams(std::move(streams)),
      groups(run_streams.groups()),
      surface_stream(directory.graph.size()),
      structure_classes(directory.classes, directory.graph.size()),
      fingerprinter(grid.size),
      surfaces(options.surfaces),
      budget(file.name(), known_bytes(layout), options.max_work,
             options.memory_bytes > 0 ? options.memory_bytes : machine_memory()),
      value_cache(groups.size(), kMaxCachedBytes) {
  const auto preorder = directory.graph.preorder();
  for (std::uint32_t n = 0; n < preorder.size(); ++n) surface_stream[preorder[n]] = n;
  for (auto& counted : runs_counted) counted.resize(directory.classes.size());
}

Atlas::Atlas(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Atlas::~Atlas() = default;

Result<std::shared_ptr<const Atlas>> Atlas::open(const std::filesystem::path& path,
                                                 const AtlasOptions& options) {
  SPLATLAS_ASSIGN_OR_RETURN(InputFile file, InputFile::open(path));
  return open_file(std::move(file), options);
}

Result<std::shared_ptr<const Atlas>> Atlas::open_bytes(std::vector<std::byte> bytes, std::string name,
                                                       const AtlasOptions& options) {
  return open_file(InputFile(std::move(bytes), std::move(name)), options);
}

Result<std::shared_ptr<const Atlas>> Atlas::open_file(InputFile file, const AtlasOptions& options) {
  try {
    auto opened = read_directory(file);
    if (!opened) return fail(opened.error().code, file.name() + ": " + opened.error().message);
    auto impl = std::make_unique<Impl>(std::move(file), opened->header, std::move(opened->directory),
                                       std::move(opened->streams), std::move(opened->layout), options);
    return std::shared_ptr<const Atlas>(new Atlas(std::move(impl)));
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kLimit, "{}: out of memory; {}", file.name(), kOutOfMemoryRemedy);
  }
}

const std::string& Atlas::name() const {
  return impl_->file.name();
}
std::string Atlas::format_version() const {
  return fmt::format("{}.{}", impl_->header.major, impl_->header.minor);
}
const Grid& Atlas::grid() const {
  return impl_->grid;
}
const Grid& Atlas::source_grid() const {
  return impl_->directory.source_grid;
}
const AxisOrder& Atlas::source_to_storage() const {
  return impl_->directory.source_to_storage;
}
const StructureGraph& Atlas::graph() const {
  return impl_->directory.graph;
}
const ClassTable& Atlas::classes() const {
  return impl_->directory.classes;
}
const DecisionTree& Atlas::tree() const {
  return impl_->tree;
}
const Display& Atlas::display() const {
  return impl_->directory.display;
}
const std::vector<Scene>& Atlas::scenes() const {
  return impl_->directory.scenes;
}
const Provenance& Atlas::provenance() const {
  return impl_->directory.provenance;
}
VoxelType Atlas::value_type() const {
  return impl_->directory.value_type;
}
VoxelType Atlas::label_type() const {
  return impl_->directory.label_type;
}
std::uint64_t Atlas::triangles(StructureIndex s) const {
  return impl_->directory.surfaces[s].triangles;
}
std::uint64_t Atlas::runs(Axis axis) const {
  return impl_->directory.run_totals[static_cast<std::size_t>(axis)];
}
const WorkBudget& Atlas::work_budget() const {
  return impl_->budget;
}
double Atlas::reference_length_mm() const {
  return splatlas::reference_length_mm(impl_->grid);
}

Result<void> Atlas::Impl::check_class(ClassId c) const {
  if (c < directory.classes.size()) return {};
  return fail(ErrorCode::kUsage, "class {} of {}", c, directory.classes.size());
}

Result<void> Atlas::Impl::check_structure(StructureIndex s) const {
  if (s < directory.graph.size()) return {};
  return fail(ErrorCode::kUsage, "structure {} of {}", s, directory.graph.size());
}

Result<std::vector<std::byte>> Atlas::Impl::read_stream(SectionKind kind, std::size_t stream) const {
  const SectionLayout* section = layout.find(kind);
  if (!section) return std::vector<std::byte>{};
  const std::uint64_t size = section->stream_begin[stream + 1] - section->stream_begin[stream];
  check_task();
  check_memory(static_cast<double>(size));
  auto bytes = sections.read_stream(*section, stream);
  if (!bytes) return named(bytes.error());
  return bytes;
}

std::vector<SectionSize> Atlas::sections() const {
  std::vector<SectionSize> sizes{{"header", sizeof(FileHeader)},
                                 {"directory", impl_->header.directory_bytes}};
  for (const SectionLayout& section : impl_->layout.sections) {
    sizes.push_back({section_name(section.kind), section.stored_bytes});
  }
  return sizes;
}

Atlas::Counters Atlas::counters() const {
  return {impl_->header.file_bytes,
          sizeof(FileHeader) + impl_->header.directory_bytes + impl_->sections.read_bytes(),
          impl_->sections.decoded_bytes()};
}

}  // namespace splatlas
