#include "tests/format/bad_files/raw_atlas.h"

#include <cstring>
#include <stdexcept>

#include "format/atlas_writer.h"
#include "format/codec/run_codec.h"
#include "format/io/checksum.h"
#include "schemas/atlas_generated.h"

namespace splatlas {
namespace {

template <typename Raw, typename Row>
Raw raw_row(const Row& row) {
  static_assert(sizeof(Raw) == sizeof(Row));
  Raw raw;
  std::memcpy(&raw, &row, sizeof raw);
  return raw;
}

template <typename Raw, typename Rows>
std::vector<Raw> raw_rows(const Rows& rows) {
  std::vector<Raw> raw;
  for (const auto* row : rows) raw.push_back(raw_row<Raw>(*row));
  return raw;
}

template <typename T>
std::vector<T> numbers_of(const flatbuffers::Vector<T>& rows) {
  return std::vector<T>(rows.begin(), rows.end());
}

template <typename Row, typename Raw>
auto vector_of(flatbuffers::FlatBufferBuilder& builder, const std::vector<Raw>& rows) {
  static_assert(sizeof(Raw) == sizeof(Row));
  return builder.CreateVectorOfStructs(reinterpret_cast<const Row*>(rows.data()), rows.size());
}

template <typename Vector>
auto numbers_or_none(const Vector* numbers) {
  return numbers != nullptr ? numbers_of(*numbers) : decltype(numbers_of(*numbers)){};
}

RawDirectory read_directory(const Bytes& bytes) {
  const schema::Directory& d = *schema::GetDirectory(bytes.data());
  return {.source_grid = raw_row<RawGrid>(*d.source_grid()),
          .source_to_storage = raw_row<RawAxisOrder>(*d.source_to_storage()),
          .value_type = d.value_type(),
          .label_type = d.label_type(),
          .display = raw_row<RawDisplay>(*d.display()),
          .run_totals = raw_row<std::array<std::uint64_t, 3>>(*d.run_totals()),
          .structures = raw_rows<RawStructure>(*d.structures()),
          .parents = numbers_of(*d.parents()),
          .surfaces = raw_rows<RawSurface>(*d.surfaces()),
          .classes = raw_rows<RawClass>(*d.classes()),
          .members = numbers_of(*d.members()),
          .scenes = raw_rows<RawScene>(*d.scenes()),
          .sources = d.sources(),
          .text_ends = numbers_of(*d.text_ends()),
          .text = numbers_of(*d.text()),
          .sections = raw_rows<RawSection>(*d.sections()),
          .chunks = raw_rows<RawChunk>(*d.chunks()),
          .normals_fitted = numbers_of(*d.normals_fitted()),
          .fingerprints = numbers_of(*d.fingerprints()),
          .terms_end = numbers_or_none(d.terms_end()),
          .term_text_ends = numbers_or_none(d.term_text_ends()),
          .term_text = numbers_or_none(d.term_text()),
          .scene_text_ends = numbers_or_none(d.scene_text_ends()),
          .scene_text = numbers_or_none(d.scene_text()),
          .mean_blocks = numbers_or_none(d.mean_blocks()),
          .scene_view_ends = numbers_or_none(d.scene_view_ends()),
          .scene_view_text = numbers_or_none(d.scene_view_text()),
          .left_out = {}};
}

Bytes encode(const RawDirectory& d) {
  flatbuffers::FlatBufferBuilder b;
  const auto structures = vector_of<schema::Structure>(b, d.structures);
  const auto parents = b.CreateVector(d.parents);
  const auto surfaces = vector_of<schema::Surface>(b, d.surfaces);
  const auto classes = vector_of<schema::Class>(b, d.classes);
  const auto members = b.CreateVector(d.members);
  const auto scenes = vector_of<schema::Scene>(b, d.scenes);
  const auto text_ends = b.CreateVector(d.text_ends);
  const auto text = b.CreateVector(d.text);
  const auto sections = vector_of<schema::Section>(b, d.sections);
  const auto chunks = vector_of<schema::Chunk>(b, d.chunks);
  const auto normals_fitted = b.CreateVector(d.normals_fitted);
  const auto fingerprints = b.CreateVector(d.fingerprints);
  const auto terms_end = b.CreateVector(d.terms_end);
  const auto term_text_ends = b.CreateVector(d.term_text_ends);
  const auto term_text = b.CreateVector(d.term_text);
  const auto scene_text_ends = b.CreateVector(d.scene_text_ends);
  const auto scene_text = b.CreateVector(d.scene_text);
  const auto mean_blocks = b.CreateVector(d.mean_blocks);
  const auto scene_view_ends = b.CreateVector(d.scene_view_ends);
  const auto scene_view_text = b.CreateVector(d.scene_view_text);
  schema::DirectoryBuilder table(b);
  const auto add = [&](const char* field, const auto& add_field) {
    if (!d.left_out.contains(field)) add_field();
  };
  add("source_grid", [&] { table.add_source_grid(reinterpret_cast<const schema::Grid*>(&d.source_grid)); });
  add("source_to_storage",
      [&] { table.add_source_to_storage(reinterpret_cast<const schema::AxisOrder*>(&d.source_to_storage)); });
  table.add_value_type(d.value_type);
  table.add_label_type(d.label_type);
  add("display", [&] { table.add_display(reinterpret_cast<const schema::Display*>(&d.display)); });
  add("run_totals", [&] { table.add_run_totals(reinterpret_cast<const schema::RunTotals*>(&d.run_totals)); });
  add("structures", [&] { table.add_structures(structures); });
  add("parents", [&] { table.add_parents(parents); });
  add("surfaces", [&] { table.add_surfaces(surfaces); });
  add("classes", [&] { table.add_classes(classes); });
  add("members", [&] { table.add_members(members); });
  add("scenes", [&] { table.add_scenes(scenes); });
  table.add_sources(d.sources);
  add("text_ends", [&] { table.add_text_ends(text_ends); });
  add("text", [&] { table.add_text(text); });
  add("sections", [&] { table.add_sections(sections); });
  add("chunks", [&] { table.add_chunks(chunks); });
  add("normals_fitted", [&] { table.add_normals_fitted(normals_fitted); });
  table.add_fingerprints(fingerprints);
  if (!d.terms_end.empty()) table.add_terms_end(terms_end);
  if (!d.term_text_ends.empty()) table.add_term_text_ends(term_text_ends);
  if (!d.term_text.empty()) table.add_term_text(term_text);
  if (!d.scene_text_ends.empty()) table.add_scene_text_ends(scene_text_ends);
  if (!d.scene_text.empty()) table.add_scene_text(scene_text);
  if (!d.mean_blocks.empty()) table.add_mean_blocks(mean_blocks);
  if (!d.scene_view_ends.empty()) table.add_scene_view_ends(scene_view_ends);
  if (!d.scene_view_text.empty()) table.add_scene_view_text(scene_view_text);
  // Not Finish(), which asserts that all fields are present.
  b.Finish(flatbuffers::Offset<schema::Directory>(b.EndTable(table.start_)), schema::DirectoryIdentifier());
  const auto* begin = reinterpret_cast<const std::byte*>(b.GetBufferPointer());
  return Bytes(begin, begin + b.GetSize());
}

/// The parts of atlas_surgery.h.
AtlasParts parts_of(const RawAtlas& atlas) {
  return {{}, decode_directory(encode(atlas.directory)).value(), atlas.chunks};
}

std::size_t first_chunk(const RawDirectory& directory, SectionKind kind) {
  std::size_t first = 0;
  for (const RawSection& section : directory.sections) {
    if (section.kind == static_cast<std::uint32_t>(kind)) return first;
    first += section.chunks;
  }
  throw std::invalid_argument("the file has no such section");
}

}  // namespace

void RawAtlas::set_text(std::size_t n, const std::string& new_text) {
  RawDirectory& d = directory;
  const std::uint32_t begin = n == 0 ? 0 : d.text_ends[n - 1], end = d.text_ends[n];
  d.text.erase(d.text.begin() + begin, d.text.begin() + end);
  d.text.insert(d.text.begin() + begin, new_text.begin(), new_text.end());
  for (std::size_t m = n; m < d.text_ends.size(); ++m) {
    d.text_ends[m] += static_cast<std::uint32_t>(new_text.size()) - (end - begin);
  }
}

void RawAtlas::edit_stream(SectionKind kind, std::size_t stream, const std::function<void(Bytes&)>& change) {
  AtlasParts parts = parts_of(*this);
  std::vector<Bytes> streams = decode_streams(parts, kind);
  change(streams[stream]);
  replace_streams(parts, kind, streams);
  const auto length = static_cast<std::uint32_t>(streams[stream].size());
  if (kind <= SectionKind::kRunsZ) {
    directory.classes[stream].run_bytes[static_cast<std::size_t>(kind) - 1] = length;
  } else if (kind == SectionKind::kSurfaces) {
    directory.surfaces[parts.directory.graph.preorder()[stream]].bytes = length;
  }
  chunks = parts.chunks;
  directory.chunks.clear();
  for (const ChunkEntry& entry : parts.directory.chunks) {
    directory.chunks.push_back(
        {entry.checksum, entry.stored_bytes, static_cast<std::uint8_t>(entry.codec), entry.filter, 0});
  }
  for (std::size_t n = 0; n < directory.sections.size(); ++n) {
    directory.sections[n].chunks = parts.directory.sections[n].chunks;
  }
}

void RawAtlas::edit_runs(Axis axis, std::size_t of_class, const std::function<void(ClassRuns&)>& change) {
  edit_stream(run_section(axis), of_class, [&](Bytes& bytes) {
    ClassRuns runs = decode_run_list(bytes, ~std::uint64_t{0}).value();
    change(runs);
    bytes.clear();
    append_run_list(runs, bytes);
  });
}

RawSection& RawAtlas::section(SectionKind kind) {
  for (RawSection& each : directory.sections) {
    if (each.kind == static_cast<std::uint32_t>(kind)) return each;
  }
  throw std::invalid_argument("the file has no such section");
}

RawChunk& RawAtlas::chunk(SectionKind kind, std::size_t n) {
  return directory.chunks[first_chunk(directory, kind) + n];
}

void RawAtlas::set_chunk(SectionKind kind, std::size_t n, Bytes stored) {
  RawChunk& row = chunk(kind, n);
  row.checksum = checksum_of(stored);
  row.stored_bytes = static_cast<std::uint32_t>(stored.size());
  chunks[first_chunk(directory, kind) + n] = std::move(stored);
}

const Bytes& good_file() {
  static const Bytes file = encode_atlas(good_content()).value();
  return file;
}

RawAtlas raw_atlas(const Bytes& file) {
  return {read_directory(directory_bytes(file)), take_apart(file).chunks, {}, {}, {}};
}

Bytes file_of(const RawAtlas& atlas) {
  Bytes directory = encode(atlas.directory);
  if (atlas.on_directory) atlas.on_directory(directory);
  Bytes file = put_together(directory, atlas.chunks);
  if (atlas.on_header) edit_header(file, atlas.on_header);
  if (atlas.on_file) atlas.on_file(file);
  return file;
}

}  // namespace splatlas
