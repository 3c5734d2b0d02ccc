#include "format/file/directory.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "format/file/schema_arrays.h"
#include "format/result_macros.h"
#include "schemas/atlas_generated.h"

namespace splatlas {

std::string section_name(std::uint32_t kind) {
  constexpr std::array kNames{"runs_x", "runs_y", "runs_z", "values", "normals", "surfaces", "means"};
  return kind >= 1 && kind <= kNames.size() ? kNames[kind - 1] : fmt::format("section {}", kind);
}

bool has_normals(const ClassTable& classes, ClassId c) {
  return std::ranges::any_of(classes.members(c),
                             [](const Membership& m) { return m.part == Part::kBoundary; });
}

bool stores_normals(const Directory& directory, ClassId c) {
  return has_normals(directory.classes, c) && !directory.normals_fitted[c];
}

namespace {

/// Length of a vtable with all fields that this version knows.
constexpr flatbuffers::voffset_t kVtableBytes =
    schema::Directory::VT_SCENE_VIEW_TEXT + sizeof(flatbuffers::voffset_t);

/// True if end offsets are non-decreasing and the last one is `total`.
template <typename Rows, typename End>
bool ends_are_valid(const Rows& rows, End&& end, std::uint64_t total) {
  std::uint64_t previous = 0;
  for (flatbuffers::uoffset_t n = 0; n < rows.size(); ++n) {
    if (end(rows, n) < previous) return false;
    previous = end(rows, n);
  }
  return previous == total;
}

/// Checks the alignment of elements: the FlatBuffers verifier checks only that of the length field.
template <typename Row>
bool is_aligned(const flatbuffers::Vector<Row>& rows) {
  return rows.size() == 0 ||
         reinterpret_cast<std::uintptr_t>(rows.Data()) % alignof(std::remove_pointer_t<Row>) == 0;
}

/// The end of row n in a vector of ends.
constexpr auto kValue = [](const auto& rows, auto n) { return rows.Get(n); };

/// Terms are in all three tables, or in none.
Result<void> check_terms(const schema::Directory& d) {
  if (d.terms_end() == nullptr && d.term_text_ends() == nullptr && d.term_text() == nullptr) return {};
  if (d.terms_end() == nullptr || d.term_text_ends() == nullptr || d.term_text() == nullptr ||
      d.terms_end()->size() != d.structures()->size() || d.term_text_ends()->size() % 2 != 0 ||
      !ends_are_valid(*d.terms_end(), kValue, d.term_text_ends()->size() / 2) ||
      !ends_are_valid(*d.term_text_ends(), kValue, d.term_text()->size())) {
    return invalid_atlas("invalid: inconsistent offsets of directory tables of terms");
  }
  return {};
}

/// Further texts of scenes are in both tables, or in none.
Result<void> check_scene_text(const flatbuffers::Vector<std::uint32_t>* ends,
                              const flatbuffers::Vector<std::uint8_t>* text, std::uint64_t strings) {
  if (ends == nullptr && text == nullptr) return {};
  if (ends == nullptr || text == nullptr || ends->size() != strings ||
      !ends_are_valid(*ends, kValue, text->size())) {
    return invalid_atlas("invalid: inconsistent offsets of directory text of scenes");
  }
  return {};
}

Result<void> check_tables(const schema::Directory& d) {
  if (!is_aligned(*d.structures()) || !is_aligned(*d.surfaces()) || !is_aligned(*d.classes()) ||
      !is_aligned(*d.scenes()) || !is_aligned(*d.sections()) || !is_aligned(*d.chunks()) ||
      !is_aligned(*d.fingerprints())) {
    return invalid_atlas("invalid: directory tables are not aligned");
  }
  const std::uint64_t strings = 4 + 2 * std::uint64_t{d.structures()->size()} +
                                3 * std::uint64_t{d.scenes()->size()} + 2 * std::uint64_t{d.sources()};
  if (d.text_ends()->size() != strings) {
    return invalid_atlas("invalid: directory has {} strings, expected {}", d.text_ends()->size(), strings);
  }
  if (!ends_are_valid(*d.text_ends(), kValue, d.text()->size())) {
    return invalid_atlas("invalid: inconsistent offsets of directory text");
  }
  SPLATLAS_RETURN_IF_ERROR(check_terms(d));
  const std::uint64_t scenes = d.scenes()->size();
  SPLATLAS_RETURN_IF_ERROR(check_scene_text(d.scene_text_ends(), d.scene_text(), 3 * scenes));
  SPLATLAS_RETURN_IF_ERROR(check_scene_text(d.scene_view_ends(), d.scene_view_text(), 2 * scenes));
  const auto parents_end = [](const auto& rows, auto n) { return rows.Get(n)->parents_end(); };
  if (!ends_are_valid(*d.structures(), parents_end, d.parents()->size())) {
    return invalid_atlas("invalid: inconsistent offsets of directory table of parents");
  }
  const auto members_end = [](const auto& rows, auto n) { return rows.Get(n)->members_end(); };
  if (!ends_are_valid(*d.classes(), members_end, d.members()->size())) {
    return invalid_atlas("invalid: inconsistent offsets of directory table of class members");
  }
  if (d.structures()->size() > kMaxStructures || d.classes()->size() > kMaxClasses ||
      d.classes()->size() == 0) {
    return invalid_atlas("invalid: {} structures (limit {}) and {} classes (1 to {})", d.structures()->size(),
                         kMaxStructures, d.classes()->size(), kMaxClasses);
  }
  return {};
}

/// Checks that boolean fields are 0 or 1.
Result<void> check_flags(const schema::Directory& d) {
  for (const std::uint8_t flipped : *d.source_to_storage()->flipped()) {
    if (flipped > 1) return invalid_atlas("invalid: an axis is reversed by {}", flipped);
  }
  for (flatbuffers::uoffset_t c = 0; c < d.normals_fitted()->size(); ++c) {
    if (const std::uint8_t fitted = d.normals_fitted()->Get(c); fitted > 1) {
      return invalid_atlas("invalid: normals of class {} are fitted by {}", c, fitted);
    }
  }
  return {};
}

void read_terms(const schema::Directory& d, std::vector<Structure>& structures) {
  if (d.terms_end() == nullptr) return;
  TextReader text(*d.term_text_ends(), *d.term_text());
  std::uint32_t term = 0;
  for (flatbuffers::uoffset_t n = 0; n < structures.size(); ++n) {
    for (; term < d.terms_end()->Get(n); ++term) structures[n].terms.push_back({text.next(), text.next()});
  }
}

Result<StructureGraph> read_structures(const schema::Directory& d, TextReader& text) {
  std::vector<Structure> structures(d.structures()->size());
  std::uint32_t parent = 0;
  for (flatbuffers::uoffset_t n = 0; n < d.structures()->size(); ++n) {
    const schema::Structure& row = *d.structures()->Get(n);
    Structure& s = structures[n];
    s.id = text.next();
    s.name = text.next();
    const auto rgb = to_array<3, std::uint8_t>(*row.color_rgb());
    s.color = {rgb[0], rgb[1], rgb[2]};
    if ((row.flags() & kFlagLabel) != 0) s.label = row.label();
    s.external = (row.flags() & kFlagExternal) != 0;
    for (; parent < row.parents_end(); ++parent) s.parents.push_back(d.parents()->Get(parent));
  }
  read_terms(d, structures);
  auto graph = StructureGraph::build(std::move(structures));
  if (!graph) return invalid_atlas("invalid: {}", graph.error().message);
  return graph;
}

Result<void> read_classes(const schema::Directory& d, Directory& directory) {
  std::uint32_t member = 0;
  directory.run_bytes.reserve(d.classes()->size());
  for (ClassId c = 0; c < d.classes()->size(); ++c) {
    const schema::Class& row = *d.classes()->Get(c);
    std::vector<Membership> members;
    members.reserve(row.members_end() - member);
    for (; member < row.members_end(); ++member) {
      const std::uint32_t code = d.members()->Get(member);
      if (code / 4 >= directory.graph.size() || code % 4 > static_cast<std::uint32_t>(Part::kCrossed)) {
        return invalid_atlas("invalid: class {} has part {} of structure {}", c, code % 4, code / 4);
      }
      members.push_back({code / 4, static_cast<Part>(code % 4)});
      if (members.size() > 1 && members[members.size() - 2].structure >= members.back().structure) {
        return invalid_atlas("invalid: memberships of class {} are not in order", c);
      }
    }
    if (directory.classes.intern(std::move(members)) != c) {
      return invalid_atlas("invalid: class {} repeats another class", c);
    }
    const IndexBox box{to_array<3, std::int64_t>(*row.box_first()),
                       to_array<3, std::int64_t>(*row.box_last())};
    if (box.empty() && box != IndexBox{}) {  // the class table would forget its numbers
      return invalid_atlas("invalid: empty box of class {}: must be (0, 0, 0) to (-1, -1, -1)", c);
    }
    directory.classes.count(c, row.voxels(), box);
    directory.run_bytes.push_back(to_array<3, std::uint32_t>(*row.run_bytes()));
  }
  return {};
}

void read_scenes_and_sources(const schema::Directory& d, TextReader& text, Directory& directory) {
  for (const schema::Scene* row : *d.scenes()) {
    Scene scene{text.next(), text.next(), text.next(), row->azimuth_deg(), row->elevation_deg(), row->zoom()};
    directory.scenes.push_back(std::move(scene));
  }
  if (d.scene_text() != nullptr) {
    TextReader scene_text(*d.scene_text_ends(), *d.scene_text());
    for (Scene& scene : directory.scenes) {
      for (auto* part : {&scene.question, &scene.cuts, &scene.center}) *part = scene_text.next();
    }
  }
  if (d.scene_view_text() != nullptr) {
    TextReader view_text(*d.scene_view_ends(), *d.scene_view_text());
    for (Scene& scene : directory.scenes) {
      scene.perspective = view_text.next() == kPerspective;
      std::istringstream labels(view_text.next());
      for (std::string name; std::getline(labels, name);) scene.labels.push_back(name);
    }
  }
  for (std::uint32_t n = 0; n < d.sources(); ++n) {
    directory.provenance.sources.push_back({text.next(), text.next()});
  }
}

void read_chunks(const schema::Directory& d, Directory& directory) {
  for (const schema::Section* row : *d.sections()) {
    directory.sections.push_back({row->kind(), row->chunks(), row->chunk_bytes(), row->shared_bytes()});
  }
  directory.chunks.reserve(d.chunks()->size());
  for (const schema::Chunk* row : *d.chunks()) {
    directory.chunks.push_back(
        {row->checksum(), row->stored_bytes(), static_cast<ChunkCodec>(row->codec()), row->filter()});
  }
}

}  // namespace

Result<Directory> decode_directory(std::span<const std::byte> bytes) {
  // The verifier asserts instead of failing at 2 GiB.
  if (bytes.size() < 16 || bytes.size() >= FLATBUFFERS_MAX_BUFFER_SIZE) {
    return invalid_atlas("invalid: directory of {} bytes", bytes.size());
  }
  const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  flatbuffers::Verifier verifier(data, bytes.size(), /*max_depth=*/4, /*max_tables=*/4);
  if (!schema::VerifyDirectoryBuffer(verifier))
    return invalid_atlas("invalid: directory is not a FlatBuffer of an atlas");
  const schema::Directory& d = *schema::GetDirectory(data);
  SPLATLAS_RETURN_IF_ERROR(check_tables(d));
  SPLATLAS_RETURN_IF_ERROR(check_flags(d));

  Directory directory;
  const std::uint8_t* const vtable = reinterpret_cast<const flatbuffers::Table&>(d).GetVTable();
  directory.has_newer_fields = flatbuffers::ReadScalar<flatbuffers::voffset_t>(vtable) > kVtableBytes;
  const schema::Grid& grid = *d.source_grid();
  directory.source_grid = {to_array<3, std::int64_t>(*grid.size()), to_array<3, double>(*grid.spacing_mm()),
                           to_array<3, double>(*grid.origin_lps_mm()),
                           to_array<9, double>(*grid.direction_lps())};
  directory.source_to_storage = {to_array<3, std::uint8_t>(*d.source_to_storage()->from()),
                                 to_array<3, bool>(*d.source_to_storage()->flipped())};
  directory.value_type = static_cast<VoxelType>(d.value_type());
  directory.label_type = static_cast<VoxelType>(d.label_type());
  directory.display = {d.display()->window_low(), d.display()->window_high(),
                       to_array<3, double>(*d.display()->center_lps_mm()), d.display()->radius_mm()};
  directory.run_totals = to_array<3, std::uint64_t>(*d.run_totals()->runs());

  TextReader text(*d.text_ends(), *d.text());
  for (auto* part : {&directory.provenance.title, &directory.provenance.citation,
                     &directory.provenance.licence, &directory.provenance.tool}) {
    *part = text.next();
  }
  SPLATLAS_ASSIGN_OR_RETURN(directory.graph, read_structures(d, text));
  SPLATLAS_RETURN_IF_ERROR(read_classes(d, directory));
  directory.surfaces.reserve(d.surfaces()->size());
  for (const schema::Surface* row : *d.surfaces()) {
    directory.surfaces.push_back({row->vertices(), row->triangles(), row->position_scale(), row->bytes()});
  }
  for (const std::uint8_t fitted : *d.normals_fitted()) directory.normals_fitted.push_back(fitted != 0);
  directory.fingerprints.assign(d.fingerprints()->begin(), d.fingerprints()->end());
  if (d.mean_blocks() != nullptr)
    directory.mean_blocks.assign(d.mean_blocks()->begin(), d.mean_blocks()->end());
  read_scenes_and_sources(d, text, directory);
  read_chunks(d, directory);
  return directory;
}

}  // namespace splatlas
