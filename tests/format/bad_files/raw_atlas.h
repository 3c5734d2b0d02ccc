// Atlas file as plain tables, for invalid files that no writer produces. Restates the tables of
// docs/atlas_format.md. Reassembly checks nothing.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "format/content/run_model.h"
#include "tests/format/atlas_surgery.h"
#include "tests/format/bad_files/good_atlas.h"

namespace splatlas {

struct RawGrid {
  std::array<double, 3> spacing_mm, origin_lps_mm;
  std::array<double, 9> direction_lps;
  std::array<std::int64_t, 3> size;
};
struct RawAxisOrder {
  std::array<std::uint8_t, 3> from, flipped;
};
struct RawDisplay {
  double window_low, window_high;
  std::array<double, 3> center_lps_mm;
  double radius_mm;
};
struct RawStructure {
  std::int64_t label;
  std::uint32_t parents_end;
  std::array<std::uint8_t, 3> color_rgb;
  std::uint8_t flags;
};
struct RawSurface {
  std::uint32_t vertices, triangles, position_scale, bytes;
};
struct RawClass {
  std::uint64_t voxels;
  std::array<std::int32_t, 3> box_first, box_last;
  std::array<std::uint32_t, 3> run_bytes;
  std::uint32_t members_end;
};
struct RawScene {
  double azimuth_deg, elevation_deg, zoom;
};
struct RawSection {
  std::uint32_t kind, chunks, chunk_bytes, shared_bytes;
};
struct RawChunk {
  std::uint64_t checksum;
  std::uint32_t stored_bytes;
  std::uint8_t codec, filter;
  std::uint16_t reserved;
};

struct RawDirectory {
  RawGrid source_grid;
  RawAxisOrder source_to_storage;
  std::uint8_t value_type, label_type;
  RawDisplay display;
  std::array<std::uint64_t, 3> run_totals;
  std::vector<RawStructure> structures;
  std::vector<std::uint32_t> parents;
  std::vector<RawSurface> surfaces;
  std::vector<RawClass> classes;
  std::vector<std::uint32_t> members;
  std::vector<RawScene> scenes;
  std::uint32_t sources;
  std::vector<std::uint32_t> text_ends;
  std::vector<std::uint8_t> text;
  std::vector<RawSection> sections;
  std::vector<RawChunk> chunks;
  std::vector<std::uint8_t> normals_fitted;
  std::vector<std::uint64_t> fingerprints;
  std::vector<std::uint32_t> terms_end, term_text_ends;  ///< each left out if empty
  std::vector<std::uint8_t> term_text;
  std::vector<std::uint32_t> scene_text_ends;  ///< left out if empty
  std::vector<std::uint8_t> scene_text;
  std::vector<std::uint32_t> mean_blocks;      ///< left out if empty
  std::vector<std::uint32_t> scene_view_ends;  ///< left out if empty
  std::vector<std::uint8_t> scene_view_text;
  std::set<std::string> left_out;  ///< omitted fields of the FlatBuffer
};

struct RawAtlas {
  RawDirectory directory;
  std::vector<Bytes> chunks;  ///< stored bytes

  // Edits at outer levels. Lengths and checksums of enclosing levels are right.
  std::function<void(Bytes&)> on_directory;    ///< the FlatBuffer's bytes
  std::function<void(FileHeader&)> on_header;  ///< ahead of its own checksum
  std::function<void(Bytes&)> on_file;         ///< the whole file, after all checksums

  /// String n, in document order.
  void set_text(std::size_t n, const std::string& text);
  /// Edits one stream of a section, recompresses the section, and updates chunks and lengths.
  void edit_stream(SectionKind kind, std::size_t stream, const std::function<void(Bytes&)>& change);
  /// Edits the run list of a class.
  void edit_runs(Axis axis, std::size_t of_class, const std::function<void(ClassRuns&)>& change);
  /// Replaces the bytes of a chunk, with the right length and checksum.
  void set_chunk(SectionKind kind, std::size_t n, Bytes stored);
  [[nodiscard]] RawChunk& chunk(SectionKind kind, std::size_t n = 0);
  [[nodiscard]] RawSection& section(SectionKind kind);
};

[[nodiscard]] RawAtlas raw_atlas(const Bytes& file);
[[nodiscard]] Bytes file_of(const RawAtlas& atlas);

/// The file of good_content().
[[nodiscard]] const Bytes& good_file();

}  // namespace splatlas
