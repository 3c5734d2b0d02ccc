#include "preprocess/import/meshes/import_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <regex>
#include <span>

#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPLYReader.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkSTLReader.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkTriangleFilter.h>
#include <vtkXMLPolyDataReader.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/isolation/run_isolated.h"
#include "preprocess/import/meshes/polygon_readers.h"
#include "preprocess/import/quiet_vtk.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

template <typename Reader>
Result<vtkSmartPointer<vtkPolyData>> read_with(const fs::path& path) {
  vtkNew<Reader> reader;
  reader->SetFileName(path.c_str());
  if (const std::string complaint = update_quietly(*reader); !complaint.empty()) {
    return bad_file(path, "{}", complaint);
  }
  return vtkSmartPointer<vtkPolyData>(reader->GetOutput());
}

/// VTK's test: a file is binary if at least 5 % of its first 256 bytes are not characters.
bool is_text_to_vtk(std::string_view head) {
  const std::string_view first = head.substr(0, 256);
  const auto others = std::ranges::count_if(first, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && c != '\n' && c != '\r' && c != '\t') || byte > 0x7f;
  });
  return 20 * static_cast<std::size_t>(others) < first.size();
}

/// Binary: 80 bytes, a count, 50 bytes a triangle. Text: "solid", and "facet" soon after, in any case.
Result<void> check_stl(const fs::path& path) {
  constexpr std::uint64_t kHeader = 84, kTriangle = 50;
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  const std::string head = first_bytes(path, 1024);
  const std::string text = to_lower(trimmed(head));
  if (is_text_to_vtk(head) && text.starts_with("solid") && text.find("facet") != std::string::npos) return {};
  if (error || head.size() < kHeader) return bad_file(path, "is not an STL file");
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, &head[80], sizeof(triangles));
  if (size < kHeader + kTriangle * triangles) {
    return bad_file(path, "is no STL file or a truncated one: {} triangles need {} bytes, it has {}",
                    triangles, kHeader + kTriangle * triangles, size);
  }
  return {};
}

/// VTK takes the first two elements for vertices and faces, the lowest byte of a count for the count, unknown
/// types for no bytes, and what lines of text lack for any number. It notices all other damage.
Result<void> check_ply(const fs::path& path) {
  static const std::regex kHeader(
      "ply|format (ascii|binary_(little|big)_endian) 1.0|(comment|obj_info)( .*)?|element \\S+ \\d{1,9}|"
      "property (list u?(char|short|int|int8|int16|int32) )?"
      "(u?(char|short|int|int8|int16|int32)|float|double|float32|float64) \\S+");
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::size_t number = 0, numbers_of_vertex = 0;
  std::vector<std::int64_t> counts;
  bool is_text = false;
  const auto read_words = [&] {
    ++number;
    return std::getline(file, line) ? split_blanks(line = trimmed(line)) : std::vector<std::string_view>();
  };
  // Without the line: comments may name a patient.
  const auto refuse = [&] {
    return bad_file(path, "line {} is not that of a PLY file of vertices, then faces", number);
  };
  for (auto words = read_words(); line != "end_header"; words = read_words()) {
    if (!words.empty() && (words[0] == "comment" || words[0] == "obj_info")) continue;
    is_text = is_text || line == "format ascii 1.0";
    const bool is_list = words.size() == 5;
    const bool is_wide = is_list && !words[2].ends_with("char") && !words[2].ends_with("int8");
    if (words.empty() || !std::regex_match(line, kHeader) || (is_wide && !is_text)) return refuse();
    if (words[0] == "property" && counts.size() == 1) ++numbers_of_vertex;
    if (words[0] != "element") continue;
    if (counts.size() < 2 && words[1] != (counts.empty() ? "vertex" : "face")) return refuse();
    counts.push_back(*parse_integer(words[2]));
  }
  if (counts.size() < 2) return refuse();
  for (std::int64_t n = 0; is_text && n < counts[0] + counts[1]; ++n) {
    const auto words = read_words();
    const bool is_vertex = n < counts[0];
    const std::int64_t corners = words.empty() ? -1 : parse_integer(words[0]).value_or(-1);
    const std::size_t needed = is_vertex ? numbers_of_vertex : static_cast<std::size_t>(corners) + 1;
    const bool fits =
        is_vertex ? words.size() == needed : corners >= 0 && corners < 256 && words.size() >= needed;
    if (!fits) return refuse();
    for (const std::string_view word : std::span(words).first(needed))
      if (is_vertex ? !parse_number(word) : !parse_integer(word)) return refuse();
  }
  return {};
}

/// VTK reads over the end of a list that its polygons do not fill. The sizes that the file promises show it:
/// "POLYGONS 4 16"; since version 5.1 one offset more, and corners alone.
Result<vtkSmartPointer<vtkPolyData>> read_legacy_vtk(const fs::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(vtkSmartPointer<vtkPolyData> polygons, read_with<vtkPolyDataReader>(path));
  std::ifstream file(path, std::ios::binary);
  const std::string text = to_lower(std::string{std::istreambuf_iterator<char>(file), {}});
  for (const auto& [section, cells] : {std::pair("\npolygons ", polygons->GetPolys()),
                                       std::pair("\ntriangle_strips ", polygons->GetStrips())}) {
    const std::size_t at = text.rfind(section);
    if (at == std::string::npos) continue;
    const std::vector<std::string_view> words = split_blanks(std::string_view(text).substr(at, 100));
    const vtkIdType found = cells->GetNumberOfCells(), corners = cells->GetNumberOfConnectivityIds();
    const bool fits = words.size() >= 3 &&
                      ((words[1] == std::to_string(found) && words[2] == std::to_string(found + corners)) ||
                       (words[1] == std::to_string(found + 1) && words[2] == std::to_string(corners)));
    if (!fits) return bad_file(path, "is damaged: its polygons do not fill their list of corners");
  }
  return polygons;
}

Result<vtkSmartPointer<vtkPolyData>> read_polygons(const fs::path& path, MeshFormat format) {
  switch (format) {
    case MeshFormat::kStl: SPLATLAS_RETURN_IF_ERROR(check_stl(path)); return read_with<vtkSTLReader>(path);
    case MeshFormat::kObj: return read_obj(path);
    case MeshFormat::kPly: SPLATLAS_RETURN_IF_ERROR(check_ply(path)); return read_with<vtkPLYReader>(path);
    case MeshFormat::kVtp: return read_with<vtkXMLPolyDataReader>(path);
    case MeshFormat::kGifti: return read_gifti(path);
    case MeshFormat::kFreeSurfer: return read_free_surfer(path);
    case MeshFormat::kVtk: break;
  }
  return read_legacy_vtk(path);
}

/// Checks offsets and corner indices before a filter dereferences them.
Result<void> check_corners(vtkPolyData& polygons, const fs::path& path) {
  const vtkIdType points = polygons.GetNumberOfPoints();
  for (vtkCellArray* cells : {polygons.GetPolys(), polygons.GetStrips()}) {
    if (!cells->IsValid())
      return bad_file(path, "is damaged: its polygons do not fill their list of corners");
    for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c) {
      vtkIdType corners = 0;
      const vtkIdType* ids = nullptr;
      cells->GetCellAtId(c, corners, ids);
      for (vtkIdType n = 0; n < corners; ++n) {
        if (ids[n] >= 0 && ids[n] < points) continue;
        return bad_file(path, "polygon {} has corner {}, but there are {} points", c, ids[n], points);
      }
    }
  }
  return {};
}

bool has_area(const std::array<Vec3, 3>& corners) {
  for (const Vec3& corner : corners) {
    for (const double mm : corner) {
      if (!(std::abs(mm) <= kMaxMeshMm)) return false;
    }
  }
  const Vec3 normal = cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]));
  return dot(normal, normal) > 0;
}

/// The frame that a file names: a string array SPACE, or SPACE=RAS in its first lines.
std::optional<MeshFrame> frame_in(vtkPolyData& polygons, const fs::path& path) {
  std::string space;
  if (auto* const array = vtkStringArray::SafeDownCast(polygons.GetFieldData()->GetAbstractArray("SPACE"));
      array != nullptr && array->GetNumberOfValues() > 0) {
    space = array->GetValue(0);
  } else {
    const std::string head = first_bytes(path, 1024);
    if (const std::size_t at = head.find("SPACE="); at != std::string::npos) space = head.substr(at + 6, 3);
  }
  if (space == "RAS") return MeshFrame::kRas;
  if (space == "LPS") return MeshFrame::kLps;
  return std::nullopt;
}

/// Of the comment of Mimics and 3-matic: "1 unit = 1000.000000 mm".
double unit_in(const fs::path& path) {
  static const std::regex kUnit(R"(1 unit = (\S+) mm)");
  const std::string head = first_bytes(path, 4096);
  std::smatch found;
  const bool has_unit = std::regex_search(head, found, kUnit);
  const double mm = has_unit ? parse_number(found.str(1)).value_or(1) : 1;
  return mm > 0 && mm <= kMaxMeshMm ? mm : 1;
}

TriangleMesh copy_mesh(vtkPolyData& triangles) {
  TriangleMesh mesh;
  const auto points = static_cast<std::size_t>(triangles.GetNumberOfPoints());
  vtkDataArray* const normals = triangles.GetPointData()->GetNormals();
  mesh.positions_lps_mm.resize(points);
  if (normals != nullptr && normals->GetNumberOfComponents() == 3) mesh.normals_lps.resize(points);
  for (std::size_t p = 0; p < points; ++p) {
    const double* const at = triangles.GetPoint(static_cast<vtkIdType>(p));
    for (std::size_t a = 0; a < 3; ++a) mesh.positions_lps_mm[p][a] = at[a];
    if (mesh.normals_lps.empty()) continue;
    const double* const normal = normals->GetTuple3(static_cast<vtkIdType>(p));
    for (std::size_t a = 0; a < 3; ++a) {
      const double finite = std::isfinite(normal[a]) ? normal[a] : 0.0;
      mesh.normals_lps[p][a] = static_cast<float>(finite);
    }
  }
  vtkCellArray* const cells = triangles.GetPolys();
  for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c) {
    vtkIdType corners = 0;
    const vtkIdType* ids = nullptr;
    cells->GetCellAtId(c, corners, ids);
    const auto id = [&](int n) { return static_cast<std::uint32_t>(ids[n]); };
    const bool kept = corners == 3 && has_area({mesh.positions_lps_mm[id(0)], mesh.positions_lps_mm[id(1)],
                                                mesh.positions_lps_mm[id(2)]});
    if (kept) mesh.triangles.push_back({id(0), id(1), id(2)});
    mesh.dropped += kept ? 0 : 1;
  }
  return mesh;
}

void transfer(auto& archive, TriangleMesh& mesh) {
  archive(mesh.positions_lps_mm, mesh.normals_lps, mesh.triangles, mesh.dropped);
}

}  // namespace

void transfer(auto& archive, MeshFile& file) {
  transfer(archive, file.mesh);
  archive(file.frame, file.unit_mm);
}

Result<MeshFormat> mesh_format(const fs::path& path) {
  const std::string ending = to_lower(path.extension().string());
  constexpr std::array kEndings{".stl", ".obj", ".ply",
                                ".vtk", ".vtp", ".gii"};  // in the order of MeshFormat
  const auto place = std::ranges::find(kEndings, ending) - kEndings.begin();
  if (place < std::ssize(kEndings)) return static_cast<MeshFormat>(place);
  if (first_bytes(path, 3) == "\xff\xff\xfe") return MeshFormat::kFreeSurfer;
  return bad_file(
      path, "is of no known type; surfaces end in .stl, .obj, .ply, .vtk, .vtp or .gii, or are FreeSurfer's");
}

Result<MeshFile> read_mesh_here(const fs::path& path, MeshFormat format) {
  SPLATLAS_ASSIGN_OR_RETURN(const vtkSmartPointer<vtkPolyData> polygons, read_polygons(path, format));
  SPLATLAS_RETURN_IF_ERROR(check_corners(*polygons, path));
  vtkNew<vtkTriangleFilter> triangulate;
  triangulate->SetInputData(polygons);
  triangulate->PassLinesOff();
  triangulate->PassVertsOff();
  if (const std::string complaint = update_quietly(*triangulate); !complaint.empty()) {
    return bad_file(path, "{}", complaint);
  }
  MeshFile file{copy_mesh(*triangulate->GetOutput()), frame_in(*polygons, path)};
  if (format == MeshFormat::kGifti || format == MeshFormat::kFreeSurfer) file.frame = MeshFrame::kRas;
  if (format == MeshFormat::kObj) file.unit_mm = unit_in(path);
  if (file.mesh.triangles.empty()) return bad_file(path, "holds no triangle");
  return file;
}

Result<MeshFile> read_mesh(const fs::path& path) {
  SPLATLAS_RETURN_IF_ERROR(check_regular_file(path));
  SPLATLAS_ASSIGN_OR_RETURN(const MeshFormat format, mesh_format(path));
  initialize_vtk();
  return run_isolated<MeshFile>(path, [&] { return read_mesh_here(path, format); });
}

void to_lps(TriangleMesh& mesh, MeshFrame frame) {
  if (frame == MeshFrame::kLps) return;
  for (Vec3& position : mesh.positions_lps_mm) position = {-position[0], -position[1], position[2]};
  for (std::array<float, 3>& normal : mesh.normals_lps) normal = {-normal[0], -normal[1], normal[2]};
}

std::vector<CornerNormals> corner_normals(const TriangleMesh& mesh) {
  struct Side {
    std::uint32_t low, high;        // vertices
    std::uint32_t at_low, at_high;  // their corners: three times the triangle, and 0 to 2
    auto operator<=>(const Side&) const = default;
  };
  std::vector<Side> sides;
  std::vector<Vec3> sums;                // [corner], of those that share its normal
  std::vector<std::uint32_t> shared_by;  // [corner]: an earlier one with the same normal, or itself
  for (const auto& triangle : mesh.triangles) {
    const auto& at = mesh.positions_lps_mm;
    const Vec3& first = at[triangle[0]];
    const auto corner = static_cast<std::uint32_t>(sums.size());
    sums.insert(sums.end(), 3, cross(difference(at[triangle[1]], first), difference(at[triangle[2]], first)));
    for (std::uint32_t n = 0; n < 3; ++n) {
      const std::uint32_t next = (n + 1) % 3, from = triangle[n], to = triangle[next];
      shared_by.push_back(corner + n);
      sides.push_back(from < to ? Side{from, to, corner + n, corner + next}
                                : Side{to, from, corner + next, corner + n});
    }
  }
  const auto root = [&](std::uint32_t corner) {
    while (shared_by[corner] != corner) corner = shared_by[corner] = shared_by[shared_by[corner]];
    return corner;
  };
  std::ranges::sort(sides);
  for (std::size_t n = 1; n < sides.size(); ++n) {
    const Side &a = sides[n - 1], &b = sides[n];
    const Vec3 &u = sums[a.at_low], &v = sums[b.at_low];
    constexpr double kCosine = 0.5;  // of 60 degrees
    if (a.low != b.low || a.high != b.high || dot(u, v) < kCosine * std::sqrt(dot(u, u) * dot(v, v)))
      continue;
    for (const auto& [c, d] : {std::pair(a.at_low, b.at_low), std::pair(a.at_high, b.at_high)}) {
      const auto [least, greatest] = std::minmax({root(c), root(d)});
      shared_by[greatest] = least;
    }
  }
  for (std::uint32_t corner = 0; corner < sums.size(); ++corner) {
    const std::uint32_t first = root(corner);
    for (std::size_t a = 0; first != corner && a < 3; ++a) sums[first][a] += sums[corner][a];
  }
  std::vector<CornerNormals> normals(mesh.triangles.size());
  for (std::uint32_t corner = 0; corner < sums.size(); ++corner) {
    const Vec3& sum = sums[root(corner)];
    const double length = std::sqrt(dot(sum, sum));
    for (std::size_t a = 0; a < 3; ++a)
      normals[corner / 3][corner % 3][a] = length > 0 ? static_cast<float>(sum[a] / length) : 0.f;
  }
  return normals;
}

}  // namespace splatlas
