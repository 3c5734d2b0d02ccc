// Importer of mesh files, and the placement of external surfaces in the patient.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "format/content/color.h"
#include "format/content/grid.h"
#include "preprocess/import/notes.h"

namespace splatlas {

/// Written, too, ahead of kVtp.
enum class MeshFormat { kStl, kObj, kPly, kVtk, kVtp, kGifti, kFreeSurfer };

/// The format by the file's ending: .stl, .obj, .ply, .vtk, .vtp, .gii; FreeSurfer's (lh.pial) by its first
/// bytes. kFailed for any other.
[[nodiscard]] Result<MeshFormat> mesh_format(const std::filesystem::path& path);

enum class MeshFrame {
  kLps,  ///< x to the left, y to posterior, z to superior: ITK, DICOM, 3D Slicer's files
  kRas,  ///< x to the right, y to anterior
};

/// Maximum coordinate of a mesh: 1000 km exceeds any anatomy, and prevents overflow in products.
inline constexpr double kMaxMeshMm = 1e9;

/// Triangles in LPS mm.
struct TriangleMesh {
  std::vector<Vec3> positions_lps_mm;
  std::vector<std::array<float, 3>> normals_lps;  ///< one per position; empty when the file has none
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint64_t dropped = 0;  ///< dropped triangles: zero area, or a corner beyond kMaxMeshMm
};

/// A mesh in the coordinates of its file.
struct MeshFile {
  TriangleMesh mesh;               ///< before to_lps()
  std::optional<MeshFrame> frame;  ///< as the file says: SPACE of 3D Slicer; RAS of GIFTI and FreeSurfer
  double unit_mm = 1;              ///< mm per unit, as comments of OBJ files say
};

/// Reads and triangulates a surface. kFailed, in one line, for files that are missing, truncated or of
/// another type, for invalid corner indices, and without triangles. Prints nothing. VTK's reader of PLY files
/// may crash.
[[nodiscard]] Result<MeshFile> read_mesh_here(const std::filesystem::path& path, MeshFormat format);
/// The same in a child, so that no file brings this process down (run_isolated.h).
[[nodiscard]] Result<MeshFile> read_mesh(const std::filesystem::path& path);

/// Turns coordinates and normals of a frame to LPS. RAS to LPS is a rotation around z: the winding stays.
void to_lps(TriangleMesh& mesh, MeshFrame frame);

/// [corner of a triangle].
using CornerNormals = std::array<std::array<float, 3>, 3>;

/// [triangle]: area-weighted means of the normals of the triangles around a vertex, up to edges that turn the
/// surface by more than 60 degrees. Without the normals of the file. Cost: a sort of the edges.
[[nodiscard]] std::vector<CornerNormals> corner_normals(const TriangleMesh& mesh);

/// One --mesh option.
struct MeshSource {
  std::string name;  ///< empty for a folder
  std::filesystem::path file = {};
  std::optional<MeshFrame> frame = {};   ///< else that of the file, else the one that fits the labels
  std::filesystem::path transform = {};  ///< text file of 4 x 4 numbers; empty for none
  std::optional<double> scale = {};      ///< mm per unit of the file; else its own, or 1
  std::optional<Rgb> color = {};
};

/// Parses NAME=FILE_OR_FOLDER[,frame=ras|lps][,transform=FILE][,scale=S][,color=#rrggbb]; else kUsage.
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
