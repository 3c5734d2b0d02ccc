#include "preprocess/import/meshes/check_mesh_file.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <string>

#include <fmt/format.h>

#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
#include "preprocess/import/meshes/check_ply_file.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> bad(const fs::path& path, const std::string& what) {
  return fail(ErrorCode::kFailed, fmt::format("{}: {}", path.string(), what));
}

std::string first_bytes(const fs::path& path, std::size_t count) {
  std::string bytes(count, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

/// As VTK tells: a twentieth of the first 256 bytes that are no characters make a file binary.
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
  if (error || head.size() < kHeader) return bad(path, "is not an STL file");
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, &head[80], sizeof(triangles));
  if (size < kHeader + kTriangle * triangles) {
    return bad(path, fmt::format("is no STL file or a truncated one: {} triangles need {} bytes, it has {}",
                                 triangles, kHeader + kTriangle * triangles, size));
  }
  return {};
}

/// Corner references of one "f" line, against what stands above it: "v", "v/vt", "v//vn", "v/vt/vn", negative
/// ones counting back.
bool references_exist(std::string_view corner, const std::array<std::int64_t, 3>& counts) {
  const std::vector<std::string_view> parts = split(corner, '/');
  if (parts.size() > 3 || parts[0].empty()) return false;
  for (std::size_t n = 0; n < parts.size(); ++n) {
    if (parts[n].empty() && n == 1 && parts.size() == 3) continue;  // "1//3"
    const auto index = parse_integer(parts[n]);
    if (!index || *index == 0 || *index > counts[n] || *index < -counts[n]) return false;
  }
  return true;
}

Result<void> check_obj(const fs::path& path) {
  constexpr std::size_t kMaxLine = 1u << 16;
  std::ifstream file(path, std::ios::binary);
  std::array<std::int64_t, 3> counts{};  // v, vt, vn
  std::string line;
  bool has_face = false;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    if (line.size() > kMaxLine) return bad(path, fmt::format("line {} is too long for an OBJ file", number));
    const std::vector<std::string_view> words = split_blanks(trimmed(line));
    if (words.empty()) continue;
    if (words[0] == "v") ++counts[0];
    if (words[0] == "vt") ++counts[1];
    if (words[0] == "vn") ++counts[2];
    if (words[0] != "f" && words[0] != "l" && words[0] != "p") continue;
    has_face = has_face || words[0] == "f";
    for (std::size_t n = 1; n < words.size(); ++n) {
      if (!references_exist(words[n], counts)) {
        return bad(path, fmt::format("line {}: corner '{}' does not exist", number, words[n]));
      }
    }
  }
  if (!has_face) return bad(path, "is not an OBJ file, or has no face");
  return {};
}

Result<void> check_vtk(const fs::path& path) {
  if (!first_bytes(path, 32).starts_with("# vtk DataFile")) return bad(path, "is not a legacy VTK file");
  return {};
}

}  // namespace

Result<MeshFormat> mesh_format(const fs::path& path) {
  const std::string ending = to_lower(path.extension().string());
  if (ending == ".stl") return MeshFormat::kStl;
  if (ending == ".obj") return MeshFormat::kObj;
  if (ending == ".ply") return MeshFormat::kPly;
  if (ending == ".vtk") return MeshFormat::kVtk;
  return fail(
      ErrorCode::kFailed,
      fmt::format("{}: is of no known type; surfaces end in .stl, .obj, .ply or .vtk", path.string()));
}

Result<void> check_mesh_file(const fs::path& path) {
  SPLATLAS_RETURN_IF_ERROR(check_regular_file(path));
  SPLATLAS_ASSIGN_OR_RETURN(const MeshFormat format, mesh_format(path));
  switch (format) {
    case MeshFormat::kStl: return check_stl(path);
    case MeshFormat::kObj: return check_obj(path);
    case MeshFormat::kPly: return check_ply_file(path);
    case MeshFormat::kVtk: break;
  }
  return check_vtk(path);
}

}  // namespace splatlas
