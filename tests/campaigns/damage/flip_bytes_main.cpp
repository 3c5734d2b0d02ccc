// splatlas-flip-bytes: opens and draws damaged copies of an atlas. An error must accompany every changed
// picture.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <exception>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/resource.h>

#include "format/atlas_writer.h"
#include "format/derive/value_groups.h"
#include "player/renderer.h"
#include "tests/format/atlas_surgery.h"
#include "tests/support/file_bytes.h"
#include "tests/support/phantom_content.h"
#include "tests/support/render.h"
#include "tests/support/render_with.h"

namespace splatlas {
namespace {

/// Outcome of opening and drawing a damaged file.
enum class Outcome : std::uint8_t {
  kRefused,   ///< opening failed
  kNothing,   ///< an error: nothing of the selection can be drawn
  kRest,      ///< exactly the picture of the undamaged parts, with the missing ones listed
  kUnharmed,  ///< the correct picture: the damage lies elsewhere
  kWrong,     ///< anything else
};

/// Damages a valid file and draws the damaged structure. Structures must not overlap: no selection could
/// otherwise name the undamaged rest.
class FlippedFiles {
 public:
  /// Throws std::runtime_error when the file is invalid.
  explicit FlippedFiles(Bytes good);

  [[nodiscard]] std::size_t bytes() const { return good_.size(); }
  /// Flips bits of one byte, opens the file and draws the structure of the damaged chunk, at random together
  /// with another one.
  [[nodiscard]] Outcome flip(std::size_t byte, std::uint8_t mask, std::mt19937& random);
  /// Opens the file truncated to `length` bytes, fewer than it has.
  [[nodiscard]] Outcome truncate(std::size_t length);
  /// The fault of the latest file, or the message about its damage.
  [[nodiscard]] const std::string& remark() const { return remark_; }

 private:
  struct Drawing {
    Selection selection;
    RenderOptions options;
    RenderOverrides overrides = {};
  };
  [[nodiscard]] std::optional<Drawing> drawing_at(std::size_t byte, std::mt19937& random) const;
  [[nodiscard]] std::optional<StructureIndex> structure_at(const SectionLayout& section, std::size_t chunk,
                                                           std::mt19937& random) const;
  [[nodiscard]] Outcome draw(const std::shared_ptr<const Atlas>& damaged, const Drawing& drawing);
  [[nodiscard]] Outcome wrong(std::string remark);

  const Bytes good_;
  const Directory directory_;
  const FileLayout layout_;
  Renderer good_renderer_;
  std::string remark_;
};

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
  const auto atlas = Atlas::open_bytes(slice(good_, 0, length));
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
  const bool by_group = kind == SectionKind::kValues || kind == SectionKind::kMeans;
  const ClassId c =
      by_group ? ValueGroups(directory_.classes).classes[stream].back() : static_cast<ClassId>(stream);
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
  const auto frame = render_with(renderer, camera, drawing.options, drawing.overrides);
  if (!frame) {
    remark_ = frame.error().message;
    return frame.error().code == ErrorCode::kInvalidAtlas ? Outcome::kNothing : wrong(remark_);
  }
  remark_ = frame->missing.empty() ? "" : describe(frame->missing.front(), damaged->graph());
  const Selection rest = without(drawing.selection, frame->missing);
  if (!good_renderer_.select(rest)) return wrong("the good file cannot be drawn");
  const auto expected = render_with(good_renderer_, camera, drawing.options, drawing.overrides);
  if (!expected || expected->picture.rgba != frame->picture.rgba) return wrong("another picture; " + remark_);
  return frame->missing.empty() ? Outcome::kUnharmed : Outcome::kRest;
}

Bytes bytes_of_file(const std::string& path) {
  const std::string chars = read_bytes(path);
  if (chars.empty()) throw std::runtime_error(path + ": cannot be read");
  const auto bytes = std::as_bytes(std::span(chars));
  return Bytes(bytes.begin(), bytes.end());
}

/// Counts outcomes and keeps the maximum CPU time of a file.
class Tally {
 public:
  template <typename Damage>
  void add(const std::string& where, FlippedFiles& files, const Damage& damage) {
    const std::clock_t start = std::clock();
    const Outcome outcome = damage();
    slowest_ms_ = std::max(slowest_ms_, 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    ++counts_[static_cast<std::size_t>(outcome)];
    if (outcome == Outcome::kWrong) fmt::print("{}: {}\n", where, files.remark());
  }
  [[nodiscard]] std::size_t of(Outcome outcome) const { return counts_[static_cast<std::size_t>(outcome)]; }
  [[nodiscard]] double slowest_ms() const { return slowest_ms_; }

 private:
  std::array<std::size_t, 5> counts_{};
  double slowest_ms_ = 0;
};

long peak_mebibytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) try {
  using namespace splatlas;
  CLI::App app(
      "Flips bytes of copies of an atlas, or truncates them, and draws the damaged structures. Exit status 1 "
      "if damage is not reported, or changes other pixels.");
  std::string atlas;
  std::uint32_t seed = 1;
  std::size_t flips = 1000, cuts = 1000;
  app.add_option("ATLAS", atlas, "a valid atlas; default: the golden phantom");
  app.add_option("--flips", flips, "number of flipped bytes")->capture_default_str();
  app.add_option("--cuts", cuts, "number of truncated copies")->capture_default_str();
  app.add_option("--seed", seed, "seed of the positions")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  FlippedFiles files(atlas.empty() ? encode_atlas(phantom_content(), {.means_from = 1}).value()
                                   : bytes_of_file(atlas));
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::size_t> place(0, files.bytes() - 1);
  Tally tally;
  for (std::size_t n = 0; n < flips; ++n) {
    const std::size_t byte = place(random);
    const auto mask = static_cast<std::uint8_t>(1 + random() % 255);
    tally.add(fmt::format("byte {} ^ {:#04x}", byte, mask), files,
              [&] { return files.flip(byte, mask, random); });
  }
  for (std::size_t n = 0; n < cuts; ++n) {
    const std::size_t length = place(random);
    tally.add(fmt::format("{} bytes", length), files, [&] { return files.truncate(length); });
  }
  fmt::print(
      "{} bytes flipped, {} lengths: {} refused, {} with nothing to draw, {} pictures of the rest, {} "
      "unharmed, "
      "{} wrong. At most {:.1f} ms of CPU time per file; peak memory {} MiB.\n",
      flips, cuts, tally.of(Outcome::kRefused), tally.of(Outcome::kNothing), tally.of(Outcome::kRest),
      tally.of(Outcome::kUnharmed), tally.of(Outcome::kWrong), tally.slowest_ms(), peak_mebibytes());
  return tally.of(Outcome::kWrong) == 0 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "splatlas-flip-bytes: %s\n", error.what());
  return 1;
}
