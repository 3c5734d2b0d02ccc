// Placement of external surfaces in the patient.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "format/content/color.h"
#include "preprocess/import/meshes/import_mesh.h"
#include "preprocess/import/notes.h"

namespace splatlas {

/// One --mesh option.
struct MeshSource {
  std::string name;  ///< empty for a folder
  std::filesystem::path file = {};
  std::optional<MeshFrame> frame = {};   ///< else that of the file, else the one that fits the labels
  std::filesystem::path transform = {};  ///< text file of 4 x 4 numbers; empty for none
  std::optional<double> scale = {};      ///< mm per unit of the file; else its own, or 1
  std::optional<Rgb> color = {};
};

/// Parses NAME=FILE or FOLDER, then [,frame=ras|lps][,transform=FILE][,scale=S][,color=#rrggbb]; kUsage
/// otherwise.
[[nodiscard]] Result<MeshSource> parse_mesh(std::string_view text);

/// The surface itself; or those of a folder, called as their files, sorted. kFailed if there is none.
[[nodiscard]] Result<std::vector<MeshSource>> surfaces_of(const MeshSource& source);

/// Box in LPS mm.
struct MmBox {
  Vec3 low{}, high{};
};

/// Reads a mesh and turns it to LPS mm: scale, transform, frame, in this order. Without a frame in the option
/// or the file, takes the one with more vertices in `labelled`, LPS if they are equal, with a warning.
[[nodiscard]] Result<TriangleMesh> place_mesh(const MeshSource& source, const std::optional<MmBox>& labelled,
                                              Notes& notes);

}  // namespace splatlas
