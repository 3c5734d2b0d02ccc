#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <vtkByteSwap.h>

#include "preprocess/import/meshes/polygon_readers.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// The offset from tkregister's frame to the scanner's: the line "cras   = R A S" of the footer. Zero if the
/// points are in the scanner's frame already (tag 2, useRealRAS, is 1), or the volume is not valid.
Vec3 centre_in(std::string_view footer) {
  if (footer.starts_with(std::string_view("\0\0\0\2\0\0\0\1", 8))) return {};
  const std::size_t at = footer.find("cras", footer.find("valid = 1"));
  if (at == std::string_view::npos) return {};
  const std::vector<std::string_view> words =
      split_blanks(footer.substr(at, footer.find('\n', at) - at));  // cras = R A S
  Vec3 centre{};
  for (std::size_t a = 0; a < 3 && words.size() == 5; ++a)
    centre[a] = parse_number(words[a + 2]).value_or(NAN);
  return centre;
}

}  // namespace

Result<vtkSmartPointer<vtkPolyData>> read_free_surfer(const std::filesystem::path& path) {
  std::string bytes = first_bytes(path, std::filesystem::file_size(path));
  std::size_t at = bytes.find('\n', bytes.find('\n') + 1) + 1;  // two lines of comment; 0 without them
  // The next numbers of four bytes in the machine's order; nothing if they are not all there.
  const auto next = [&](std::size_t count) -> const char* {
    char* const first = bytes.data() + at;
    if (at == 0 || count > (bytes.size() - at) / 4) return nullptr;
    vtkByteSwap::Swap4BERange(first, count);
    at += 4 * count;
    return first;
  };
  std::array<std::uint32_t, 2> counts{};
  if (const char* const numbers = next(2)) std::memcpy(counts.data(), numbers, sizeof(counts));
  const char* const points = next(std::size_t{3} * counts[0]);
  const char* const corners = next(std::size_t{3} * counts[1]);
  if (points == nullptr || corners == nullptr)
    return bad_file(path, "is no surface of FreeSurfer, or is truncated");
  const Vec3 centre = centre_in(std::string_view(bytes).substr(at));
  PolygonMesh mesh;
  for (std::size_t p = 0; p < counts[0]; ++p) {
    std::array<float, 3> ras{};
    std::memcpy(ras.data(), points + 12 * p, sizeof(ras));
    mesh.points->InsertNextPoint(ras[0] + centre[0], ras[1] + centre[1], ras[2] + centre[2]);
  }
  for (std::size_t t = 0; t < counts[1]; ++t) {
    std::array<std::int32_t, 3> triangle{};
    std::memcpy(triangle.data(), corners + 12 * t, sizeof(triangle));
    mesh.add_polygon(std::array<vtkIdType, 3>{triangle[0], triangle[1], triangle[2]});
  }
  return mesh.poly_data();
}

}  // namespace splatlas
