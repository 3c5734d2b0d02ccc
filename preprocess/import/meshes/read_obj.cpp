#include <array>
#include <fstream>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "preprocess/import/meshes/polygon_readers.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// Numbers from 1 of a vertex and its normal; 0: none.
using Corner = std::array<std::size_t, 2>;

/// 0 for a number that is not among `count`; negative ones count back.
std::size_t number_among(std::string_view text, std::size_t count) {
  const std::int64_t number = parse_integer(text).value_or(0), last = static_cast<std::int64_t>(count);
  if (number > last || number < -last) return 0;
  return static_cast<std::size_t>(number < 0 ? last + 1 + number : number);
}

std::optional<Vec3> parse_vector(const std::vector<std::string_view>& words) {
  Vec3 vector{};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto number = n + 1 < words.size() ? parse_number(words[n + 1]) : std::nullopt;
    if (!number) return std::nullopt;
    vector[n] = *number;
  }
  return vector;
}

struct ObjFile {
  std::vector<Vec3> vertices, normals;
  std::vector<std::vector<Corner>> faces;
  bool has_normals = true;  ///< at all corners

  /// The error of a line; empty if there is none.
  std::string add_line(const std::vector<std::string_view>& words) {
    if (words[0] == "v" || words[0] == "vn") {
      const auto vector = parse_vector(words);
      if (!vector) return "needs three numbers";
      (words[0] == "v" ? vertices : normals).push_back(*vector);
    }
    if (words[0] != "f") return {};
    std::vector<Corner>& face = faces.emplace_back();
    for (const std::string_view word : std::span(words).subspan(1)) {
      const std::vector<std::string_view> parts = split(word, '/');  // v, v/vt, v//vn or v/vt/vn
      const Corner corner{number_among(parts[0], vertices.size()),
                          parts.size() == 3 ? number_among(parts[2], normals.size()) : 0};
      if (corner[0] == 0) return fmt::format("corner '{}' does not exist", word);
      face.push_back(corner);
      has_normals = has_normals && corner[1] != 0;
    }
    return {};
  }

  [[nodiscard]] vtkSmartPointer<vtkPolyData> poly_data() const {
    PolygonMesh mesh;
    std::map<Corner, vtkIdType> points;
    std::vector<vtkIdType> corners;
    for (const std::vector<Corner>& face : faces) {
      corners.clear();
      for (const auto& [vertex, normal] : face) {
        const auto [point, is_new] =
            points.try_emplace({vertex, has_normals ? normal : 0}, mesh.points->GetNumberOfPoints());
        if (is_new) mesh.points->InsertNextPoint(vertices[vertex - 1].data());
        if (is_new && has_normals) mesh.normals->InsertNextTuple(normals[normal - 1].data());
        corners.push_back(point->second);
      }
      mesh.add_polygon(corners);
    }
    return mesh.poly_data();
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
  return obj.poly_data();
}

}  // namespace splatlas
