#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "preprocess/import/import_error.h"
#include "preprocess/import/meshes/polygon_readers.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

using Vector = std::array<double, 3>;

/// Numbers from 1 of a vertex, texture coordinate and normal; 0: none.
using Corner = std::array<std::size_t, 3>;

/// "v", "v/vt", "v//vn" or "v/vt/vn"; negative numbers count back from `counts`.
std::optional<Corner> parse_corner(std::string_view text, const Corner& counts) {
  const std::vector<std::string_view> parts = split(text, '/');
  if (parts.size() > 3) return std::nullopt;
  Corner corner{};
  for (std::size_t n = 0; n < parts.size(); ++n) {
    if (parts[n].empty() && n == 1 && parts.size() == 3) continue;
    const auto number = parse_integer(parts[n]);
    const auto count = static_cast<std::int64_t>(counts[n]);
    if (!number || *number == 0 || *number > count || *number < -count) return std::nullopt;
    corner[n] = static_cast<std::size_t>(*number > 0 ? *number : count + 1 + *number);
  }
  return corner;
}

std::optional<Vector> parse_vector(const std::vector<std::string_view>& words) {
  Vector vector{};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto number = n + 1 < words.size() ? parse_number(words[n + 1]) : std::nullopt;
    if (!number) return std::nullopt;
    vector[n] = *number;
  }
  return vector;
}

struct ObjFile {
  std::vector<Vector> vertices, normals;
  std::size_t texture_coordinates = 0;
  std::vector<std::vector<Corner>> faces;

  /// The error of a line; empty if there is none.
  std::string add_line(const std::vector<std::string_view>& words) {
    if (words[0] == "v" || words[0] == "vn") {
      const auto vector = parse_vector(words);
      if (!vector) return "needs three numbers";
      (words[0] == "v" ? vertices : normals).push_back(*vector);
    }
    if (words[0] == "vt") ++texture_coordinates;
    if (words[0] != "f") return {};
    std::vector<Corner>& face = faces.emplace_back();
    for (const std::string_view word : std::span(words).subspan(1)) {
      const auto corner = parse_corner(word, {vertices.size(), texture_coordinates, normals.size()});
      if (!corner) return fmt::format("corner '{}' does not exist", word);
      face.push_back(*corner);
    }
    return {};
  }

  template <typename Predicate>
  [[nodiscard]] bool all_corners(const Predicate& predicate) const {
    return std::ranges::all_of(faces, [&](const auto& face) { return std::ranges::all_of(face, predicate); });
  }

  [[nodiscard]] PolygonMesh mesh() const {
    const bool has_normals = all_corners([](const Corner& corner) { return corner[2] != 0; });
    const bool is_shared =
        (!has_normals || normals.size() == vertices.size()) && all_corners([&](const auto& corner) {
          return (corner[1] == 0 || corner[1] == corner[0]) && (!has_normals || corner[2] == corner[0]);
        });
    PolygonMesh mesh;
    const auto add_point = [&](const Vector& vertex) { mesh.points->InsertNextPoint(vertex.data()); };
    const auto add_normal = [&](const Vector& normal) { mesh.normals->InsertNextTuple(normal.data()); };
    if (is_shared) std::ranges::for_each(vertices, add_point);
    if (is_shared && has_normals) std::ranges::for_each(normals, add_normal);
    std::vector<vtkIdType> corners;
    for (const std::vector<Corner>& face : faces) {
      corners.clear();
      for (const Corner& corner : face) {
        if (!is_shared) {
          add_point(vertices[corner[0] - 1]);
          if (has_normals) add_normal(normals[corner[2] - 1]);
        }
        const vtkIdType vertex =
            is_shared ? static_cast<vtkIdType>(corner[0]) : mesh.points->GetNumberOfPoints();
        corners.push_back(vertex - 1);
      }
      mesh.add_polygon(corners);
    }
    return mesh;
  }
};

}  // namespace

Result<vtkSmartPointer<vtkPolyData>> read_obj(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  ObjFile obj;
  std::string line;
  for (std::size_t number = 1, lines = 1; std::getline(file, line); number += lines) {
    // A backslash continues a line, but not a comment.
    lines = 1;
    const auto continues = [&] { return trimmed(line).ends_with('\\') && !trimmed(line).starts_with('#'); };
    for (std::string next; continues() && std::getline(file, next); ++lines)
      line.replace(line.rfind('\\'), std::string::npos, " " + next);
    const std::vector<std::string_view> words = split_blanks(trimmed(line));
    if (words.empty()) continue;
    if (const std::string error = obj.add_line(words); !error.empty())
      return bad_file(path, "line {}: {}", number, error);
  }
  if (obj.faces.empty()) return bad_file(path, "is not an OBJ file, or has no face");
  return obj.mesh().poly_data();
}

}  // namespace splatlas
