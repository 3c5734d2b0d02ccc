// Atlases whose texts imitate output of the programs.
#pragma once

#include <string>
#include <vector>

#include "format/atlas_writer.h"
#include "format/content/structure_graph.h"
#include "tests/support/file_bytes.h"
#include "tests/support/test_content.h"

namespace splatlas {

/// Texts that the file format can hold and a terminal must not show as they are.
inline const std::vector<std::string> kHostileTexts{"Left\nnote: forged",     // line feed
                                                    "Left\tforged",           // tab
                                                    "Left\xe2\x80\x8fthgiR",  // U+200F
                                                    "Left\xe2\x80\x8ethgiR",  // U+200E
                                                    "Left\xd8\x9cthgiR",      // U+061C
                                                    "Left\xe2\x80\xa8"
                                                    "forged",  // U+2028
                                                    "Left\xe2\x80\xa9"
                                                    "forged",  // U+2029
                                                    "Le\xe2\x80\x8b"
                                                    "ft",  // U+200B
                                                    "Le\xef\xbb\xbf"
                                                    "ft",                     // U+FEFF
                                                    "Left\xf3\xa0\x81\x81"};  // U+E0041

/// An atlas with one voxel per structure; ids and names as given, texts of the provenance and scenes hostile.
inline AtlasContent hostile_content(const std::vector<std::string>& ids,
                                    const std::vector<std::string>& names) {
  TestVolume volume;
  volume.grid.size = {static_cast<std::int64_t>(names.size()), 1, 1};
  for (std::size_t n = 0; n < names.size(); ++n) {
    const Index3 voxel{static_cast<std::int64_t>(n), 0, 0};
    volume.structures.push_back({ids[n], box_mask(volume.grid.size, voxel, voxel)});
  }
  AtlasContent content = make_content(volume);
  std::vector<Structure> structures(content.graph.structures().begin(), content.graph.structures().end());
  for (std::size_t n = 0; n < names.size(); ++n) structures[n].name = names[n];
  content.graph = value_or_throw(StructureGraph::build(std::move(structures)));
  for (const std::string& text : kHostileTexts) content.scenes.push_back({text, text, "*"});
  content.provenance.title = kHostileTexts[0] + kHostileTexts[2];
  content.provenance.citation = kHostileTexts[5];
  content.provenance.licence = kHostileTexts[4];
  return content;
}

/// Writes an atlas of structures with hostile names.
inline void write_hostile_atlas(const std::string& path) {
  std::vector<std::string> ids;
  for (std::size_t n = 0; n < kHostileTexts.size(); ++n) ids.push_back("s" + std::to_string(n));
  write_bytes(path, value_or_throw(encode_atlas(hostile_content(ids, kHostileTexts))));
}

}  // namespace splatlas
