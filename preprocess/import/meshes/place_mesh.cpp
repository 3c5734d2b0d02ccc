#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/meshes/import_mesh.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

Result<void> set_option(std::string_view option, MeshSource& source) {
  const std::size_t equals = option.find('=');
  const std::string key(trimmed(option.substr(0, equals)));
  const std::string value(equals == std::string_view::npos ? "" : trimmed(option.substr(equals + 1)));
  const auto refuse = [&](const char* rule) {
    return fail(ErrorCode::kUsage, "--mesh {}: {}={} {}", in_quotes(source.name), key, value, rule);
  };
  if (key == "frame") {
    if (value != "ras" && value != "lps") return refuse("must be ras or lps");
    source.frame = value == "ras" ? MeshFrame::kRas : MeshFrame::kLps;
  } else if (key == "transform") {
    if (value.empty()) return refuse("must name a file");
    source.transform = value;
  } else if (key == "scale") {
    const auto scale = parse_number(value);
    if (!scale || !(*scale >= 1e-9 && *scale <= 1e9)) return refuse("must be a number above 0");
    source.scale = *scale;
  } else if (key == "color") {
    const auto color = parse_color(value);
    if (!color) return refuse("must be #rrggbb");
    source.color = *color;
  } else {
    return refuse("is no option; there are frame, transform, scale and color");
  }
  return {};
}

/// 4 x 4 numbers, row by row; the last row is 0 0 0 1.
Result<Affine> read_transform(const fs::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::string text, read_text(path));
  std::vector<double> numbers;
  for (const TextLine& line : lines_of(text)) {
    for (const std::string_view word : split_blanks(line.text)) {
      const auto number = parse_number(word);
      if (!number || !(std::abs(*number) <= 1e9))
        return bad_file(path, "line {}: '{}' is no number; a transform is 4 x 4 numbers, row by row",
                        line.number, word);
      numbers.push_back(*number);
    }
  }
  const bool has_last_row =
      numbers.size() == 16 && numbers[12] == 0 && numbers[13] == 0 && numbers[14] == 0 && numbers[15] == 1;
  if (!has_last_row)
    return bad_file(path, "is no transform: 4 x 4 numbers with a last row of 0 0 0 1 are needed");
  Affine affine;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t a = 0; a < 3; ++a) affine.linear[3 * row + a] = numbers[4 * row + a];
    affine.offset[row] = numbers[4 * row + 3];
  }
  if (!(std::abs(determinant(affine.linear)) > 0)) return bad_file(path, "is a singular transform");
  return affine;
}

/// Moves positions. Normals are dropped: corner_normals() derives them from the moved triangles.
void apply(const Affine& transform, TriangleMesh& mesh) {
  for (Vec3& position : mesh.positions_lps_mm) position = transform.apply(position);
  mesh.normals_lps.clear();
  if (determinant(transform.linear) > 0) return;
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

double fraction_within(const TriangleMesh& mesh, MeshFrame frame, const MmBox& box) {
  const double sign = frame == MeshFrame::kRas ? -1 : 1;
  const auto inside = std::ranges::count_if(mesh.positions_lps_mm, [&](const Vec3& p) {
    const Vec3 lps{sign * p[0], sign * p[1], p[2]};
    bool is_inside = true;
    for (std::size_t a = 0; a < 3; ++a)
      is_inside = is_inside && lps[a] >= box.low[a] && lps[a] <= box.high[a];
    return is_inside;
  });
  return static_cast<double>(inside) / static_cast<double>(mesh.positions_lps_mm.size());
}

MeshFrame guess_frame(const TriangleMesh& mesh, const std::optional<MmBox>& labelled, const fs::path& file,
                      Notes& notes) {
  if (!labelled) {
    notes.add("no-frame", file.string());
    return MeshFrame::kLps;
  }
  const double lps = fraction_within(mesh, MeshFrame::kLps, *labelled);
  const double ras = fraction_within(mesh, MeshFrame::kRas, *labelled);
  notes.add("mesh-frame", fmt::format("{} ({}: {:.0f} % of its points lie among the labels, {:.0f} % as {}; "
                                      "frame=ras or frame=lps decides)",
                                      file.string(), ras > lps ? "RAS" : "LPS", 100 * std::max(lps, ras),
                                      100 * std::min(lps, ras), ras > lps ? "LPS" : "RAS"));
  return ras > lps ? MeshFrame::kRas : MeshFrame::kLps;
}

}  // namespace

Result<MeshSource> parse_mesh(std::string_view text) {
  MeshSource source{.name = std::string(text)};  // for messages
  std::string_view rest = text;
  std::error_code error;
  // Options stand at the end: the names of files and structures may hold commas.
  for (std::size_t comma = rest.rfind(','); comma != std::string_view::npos; comma = rest.rfind(',')) {
    const std::string_view option = rest.substr(comma + 1), before = rest.substr(0, comma);
    const bool is_source = before.find('=') != std::string_view::npos || fs::is_directory(before, error);
    if (option.find('=') == std::string_view::npos || !is_source) break;
    SPLATLAS_RETURN_IF_ERROR(set_option(option, source));
    rest = before;
  }
  const bool is_folder = fs::is_directory(rest, error);
  const std::size_t equals = is_folder ? std::string_view::npos : rest.find('=');
  source.name = is_folder ? "" : std::string(trimmed(rest.substr(0, equals)));
  source.file = rest.substr(equals + 1);  // all of it without "="
  if (!is_folder && (equals == std::string_view::npos || source.name.empty() || source.file.empty())) {
    return fail(ErrorCode::kUsage,
                "--mesh {}: must be NAME=FILE or a folder, then "
                "[,frame=ras|lps][,transform=FILE][,scale=S][,color=#rrggbb]",
                in_quotes(text));
  }
  return source;
}

Result<std::vector<MeshSource>> surfaces_of(const MeshSource& source) {
  if (!source.name.empty()) return std::vector{source};
  std::vector<MeshSource> surfaces;
  for (const fs::path& file : visible_files(source.file)) {
    const Result<MeshFormat> format = mesh_format(file);
    if (!format) continue;
    MeshSource& surface = surfaces.emplace_back(source);
    surface.name = (*format == MeshFormat::kFreeSurfer ? file.filename() : file.stem()).string();
    surface.file = file;
  }
  if (surfaces.empty()) return bad_file(source.file, "is a folder without surfaces");
  return surfaces;
}

Result<TriangleMesh> place_mesh(const MeshSource& source, const std::optional<MmBox>& labelled,
                                Notes& notes) {
  SPLATLAS_ASSIGN_OR_RETURN(MeshFile file, read_mesh(source.file));
  TriangleMesh& mesh = file.mesh;
  for (Vec3& position : mesh.positions_lps_mm) {
    for (double& coordinate : position) coordinate *= source.scale.value_or(file.unit_mm);
  }
  if (!source.transform.empty()) {
    SPLATLAS_ASSIGN_OR_RETURN(const Affine transform, read_transform(source.transform));
    apply(transform, mesh);
  }
  const std::optional<MeshFrame> frame = source.frame ? source.frame : file.frame;
  to_lps(mesh, frame ? *frame : guess_frame(mesh, labelled, source.file, notes));
  return std::move(mesh);
}

}  // namespace splatlas
