#include "preprocess/import/meshes/check_mesh_file.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// VTK's test: a file is binary if at least 5 % of its first 256 bytes are not characters.
bool is_text_to_vtk(std::string_view head) {
  const std::string_view first = head.substr(0, 256);
  const auto others = std::ranges::count_if(first, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && c != '\n' && c != '\r' && c != '\t') || byte > 0x7f;
  });
  return 20 * static_cast<std::size_t>(others) < first.size();
}

/// Binary: 80 bytes, a count, 50 bytes a triangle. Text: "solid", and "facet" soon after.
Result<void> check_stl(const fs::path& path) {
  constexpr std::uint64_t kHeader = 84, kTriangle = 50;
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  const std::string head = first_bytes(path, 1024);
  if (is_text_to_vtk(head) && head.starts_with("solid") && head.find("facet") != std::string::npos) return {};
  if (error || head.size() < kHeader) return bad_file(path, "is not an STL file");
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, &head[80], sizeof(triangles));
  if (size < kHeader + kTriangle * triangles) {
    return bad_file(path, "is no STL file or a truncated one: {} triangles need {} bytes, it has {}",
                    triangles, kHeader + kTriangle * triangles, size);
  }
  return {};
}

Result<void> check_vtk(const fs::path& path) {
  if (!first_bytes(path, 32).starts_with("# vtk DataFile")) return bad_file(path, "is not a legacy VTK file");
  return {};
}

}  // namespace

Result<MeshFormat> mesh_format(const fs::path& path) {
  const std::string ending = to_lower(path.extension().string());
  if (ending == ".stl") return MeshFormat::kStl;
  if (ending == ".obj") return MeshFormat::kObj;
  if (ending == ".ply") return MeshFormat::kPly;
  if (ending == ".vtk") return MeshFormat::kVtk;
  return bad_file(path, "is of no known type; surfaces end in .stl, .obj, .ply or .vtk");
}

Result<void> check_mesh_file(const fs::path& path) {
  SPLATLAS_RETURN_IF_ERROR(check_regular_file(path));
  SPLATLAS_ASSIGN_OR_RETURN(const MeshFormat format, mesh_format(path));
  switch (format) {
    case MeshFormat::kStl: return check_stl(path);
    case MeshFormat::kVtk: return check_vtk(path);
    case MeshFormat::kObj:
    case MeshFormat::kPly: break;  // checked by their readers
  }
  return {};
}

}  // namespace splatlas
