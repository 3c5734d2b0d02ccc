#include "tests/damage/flipped_file.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "format/derive/value_groups.h"
#include "tests/support/render.h"
#include "tests/support/value_or_throw.h"

namespace splatlas {
namespace {

std::size_t below(std::size_t n, std::mt19937& random) {
  return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
}

/// The streams with bytes in a chunk.
std::vector<std::size_t> streams_in(const SectionLayout& section, std::size_t chunk) {
  std::vector<std::size_t> streams;
  for (std::size_t n = 0; n + 1 < section.stream_begin.size(); ++n) {
    const std::uint64_t begin = section.stream_begin[n], end = section.stream_begin[n + 1];
    if (begin < end && begin < section.chunk_begin[chunk + 1] && end > section.chunk_begin[chunk]) {
      streams.push_back(n);
    }
  }
  return streams;
}

Selection of_two(StructureIndex a, StructureIndex b, DrawMode mode, std::size_t structures) {
  Selection selection{std::vector<StructureDraw>(structures)};
  for (const StructureIndex s : {a, b}) {
    selection.structures[s].mode = mode;
    selection.structures[s].color = {255, 255, 255};
  }
  return selection;
}

}  // namespace

FlippedFiles::FlippedFiles(Bytes good)
    : good_(std::move(good)),
      directory_(take_apart(good_).directory),
      layout_(value_or_throw(lay_out(directory_, directory_bytes(good_).size()))),
      good_renderer_(value_or_throw(Atlas::open_bytes(good_)), {.threads = 1}) {}

Outcome FlippedFiles::wrong(std::string remark) {
  remark_ = std::move(remark);
  return Outcome::kWrong;
}

Outcome FlippedFiles::truncate(std::size_t length) {
  const auto atlas =
      Atlas::open_bytes(Bytes(good_.begin(), good_.begin() + static_cast<std::ptrdiff_t>(length)));
  if (atlas) return wrong("opened");
  remark_ = atlas.error().message;
  return atlas.error().code == ErrorCode::kInvalidAtlas ? Outcome::kRefused : wrong(remark_);
}

Outcome FlippedFiles::flip(std::size_t byte, std::uint8_t mask, std::mt19937& random) {
  const std::optional<Drawing> drawing = drawing_at(byte, random);
  Bytes bytes = good_;
  bytes[byte] ^= static_cast<std::byte>(mask);
  const auto atlas = Atlas::open_bytes(std::move(bytes), "F");
  if (!atlas) {
    remark_ = atlas.error().message;
    const bool is_start = byte < layout_.chunk_offset.front();
    return is_start && atlas.error().code == ErrorCode::kInvalidAtlas ? Outcome::kRefused : wrong(remark_);
  }
  if (!drawing) {  // the empty class's values: never drawn
    const auto values = (*atlas)->read_values(kEmptyClass);
    if (values) return wrong("damaged values of the empty class were read");
    remark_ = values.error().message;
    return Outcome::kNothing;
  }
  return draw(*atlas, *drawing);
}

std::optional<StructureIndex> FlippedFiles::structure_at(const SectionLayout& section, std::size_t chunk,
                                                         std::mt19937& random) const {
  const std::vector<std::size_t> streams = streams_in(section, chunk);
  const std::size_t stream = streams[below(streams.size(), random)];
  const auto kind = static_cast<SectionKind>(section.kind);
  if (kind == SectionKind::kSurfaces) return directory_.graph.preorder()[stream];
  const ClassId c = kind == SectionKind::kValues ? ValueGroups(directory_.classes).classes[stream].back()
                                                 : static_cast<ClassId>(stream);
  const auto members = directory_.classes.members(c);
  if (members.empty()) return std::nullopt;
  return members[below(members.size(), random)].structure;
}

std::optional<FlippedFiles::Drawing> FlippedFiles::drawing_at(std::size_t byte, std::mt19937& random) const {
  Drawing drawing{{}, {.size = {24, 24}, .quality = Quality::kDraft}};
  StructureIndex s = 0;
  DrawMode mode = DrawMode::kVolume;
  if (byte >= layout_.chunk_offset.front()) {
    const auto chunk = static_cast<std::size_t>(std::ranges::upper_bound(layout_.chunk_offset, byte) -
                                                layout_.chunk_offset.begin() - 1);
    const auto section = std::ranges::find_if(layout_.sections, [&](const SectionLayout& of) {
      return chunk >= of.first_chunk && chunk < of.first_chunk + of.chunk_begin.size() - 1;
    });
    const auto at = structure_at(*section, chunk - section->first_chunk, random);
    if (!at) return std::nullopt;
    s = *at;
    if (section->kind <= 3) drawing.overrides.principal_axis = static_cast<Axis>(section->kind - 1);
    if (section->kind == static_cast<std::uint32_t>(SectionKind::kSurfaces)) mode = DrawMode::kSurface;
    if (section->kind == static_cast<std::uint32_t>(SectionKind::kRunsZ) && random() % 4 == 0)
      mode = DrawMode::kBoth;
  }
  if (!drawing.overrides.principal_axis) drawing.overrides.principal_axis = static_cast<Axis>(random() % 3);
  const auto other = static_cast<StructureIndex>(below(directory_.graph.size(), random));
  drawing.selection = of_two(s, other, mode, directory_.graph.size());
  return drawing;
}

Outcome FlippedFiles::draw(const std::shared_ptr<const Atlas>& damaged, const Drawing& drawing) {
  const Camera camera{.azimuth_deg = 40, .elevation_deg = 35};
  Renderer renderer(damaged, {.threads = 1});
  if (const auto selected = renderer.select(drawing.selection); !selected)
    return wrong(selected.error().message);
  const auto picture = render_with(renderer, camera, drawing.options, drawing.overrides);
  if (!picture) {
    remark_ = picture.error().message;
    return picture.error().code == ErrorCode::kInvalidAtlas ? Outcome::kNothing : wrong(remark_);
  }
  remark_ = renderer.missing().empty() ? "" : describe(renderer.missing().front(), damaged->graph());
  const Selection rest = without(drawing.selection, renderer.missing());
  if (!good_renderer_.select(rest)) return wrong("the good file cannot be drawn");
  const auto expected = render_with(good_renderer_, camera, drawing.options, drawing.overrides);
  if (!expected || expected->rgba != picture->rgba) return wrong("another picture; " + remark_);
  return renderer.missing().empty() ? Outcome::kUnharmed : Outcome::kRest;
}

}  // namespace splatlas
