#include <cmath>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "format/result_macros.h"
#include "format/text/json_text.h"
#include "preprocess/commands/commands.h"

namespace splatlas {
namespace {

using Json = nlohmann::ordered_json;

std::string escaped_html(const std::string& text) {
  return escaped_markup(printable(text));
}

constexpr const char* kHead =
#include "preprocess/commands/report_head.txt"
    ;

/// Lines of an SVG path, in cells.
std::string path_of(const Silhouette& shape) {
  std::string path;
  for (std::size_t row = 0; row < kPictureCells; ++row) {
    for (std::size_t n = 0, end = 0; n < kPictureCells; n = end + 1) {
      const auto holds = [&](std::size_t column) { return (shape[row] >> column & 1) != 0; };
      for (end = n; end < kPictureCells && holds(end);) ++end;
      if (end > n) path += fmt::format("M{} {}.5h{}", n, row, end - n);
    }
  }
  return path;
}

/// A structure in front of all others. `mark`: also a circle.
std::string picture_of(const Silhouette& shape, Rgb color, const std::string& mark = "") {
  return fmt::format(
      "<svg viewBox=\"0 0 {0} {0}\"><use href=\"#all\"/><path stroke=\"{1}\" d=\"{2}\"/>{3}</svg>",
      kPictureCells, to_hex(color), path_of(shape), mark);
}

std::string rows_as_html(const Examination& examination) {
  std::string table = fmt::format(
      "<h2>Structures</h2>\n<svg style=\"display:none\"><path id=\"all\" stroke=\"#ccc\" "
      "d=\"{}\"/></svg>\n<table><tr><th></th><th>Name</th><th>Label</th><th>Voxels</th><th>ml</th>"
      "<th>Pieces</th><th>Holes</th><th>Box, LPS mm</th></tr>\n",
      path_of(examination.shape));
  for (const StructureRow& row : examination.rows) {
    const Structure& structure = row.structure;
    const auto& [low, high] = row.box_lps_mm;
    table += fmt::format(
        "<tr><td>{}</td><th><span style=\"color:{}\">&#9632;</span> "
        "{}</th><td>{}</td><td>{}</td><td>{:.3f}</td>",
        picture_of(row.measures.sums.shape, structure.color), to_hex(structure.color),
        escaped_html(structure.name), structure.label ? std::to_string(*structure.label) : "",
        row.measures.sums.voxels, row.ml);
    table += row.is_group ? "<td></td><td></td>"
                          : fmt::format("<td>{}</td><td>{}</td>", row.measures.pieces, row.measures.holes);
    table += row.measures.sums.voxels == 0
                 ? "<td></td></tr>\n"
                 : fmt::format("<td>{}<br>{}</td></tr>\n", text_of_place(low), text_of_place(high));
  }
  return table + "</table>\n";
}

std::string findings_as_html(const Examination& examination) {
  std::string list = "<h2>Findings</h2>\n";
  if (examination.findings.empty()) list += "<p>None.</p>\n";
  std::string_view kind;
  for (const Finding& finding : examination.findings) {
    const auto same = [&](const Finding& other) { return other.kind == finding.kind; };
    if (finding.kind != kind) {
      if (!kind.empty()) list += "</details>\n";
      list += fmt::format("<details open class=\"finding\"><summary>{}: {}. Remedy: {}.</summary>\n",
                          finding.kind, std::ranges::count_if(examination.findings, same),
                          escaped_html(finding.remedy));
    }
    kind = finding.kind;
    Silhouette shape{};
    Rgb color;
    for (const StructureRow& row : examination.rows) {
      if (!finding.structures.empty() && row.structure.id == finding.structures.front())
        shape = row.measures.sums.shape, color = row.structure.color;
    }
    const std::string mark =
        fmt::format("<circle cx=\"{}.5\" cy=\"{}.5\" r=\"5\"/>", finding.cell[0], finding.cell[1]);
    list +=
        fmt::format("<p>{} {}.{}</p>\n", finding.place_lps_mm ? picture_of(shape, color, mark) : "",
                    escaped_html(finding.message),
                    finding.place_lps_mm ? " At " + text_of_place(*finding.place_lps_mm) + " mm (LPS)." : "");
  }
  return list + (kind.empty() ? "" : "</details>\n");
}

Json rows_as_json(const Examination& examination) {
  Json rows = Json::array();
  for (const StructureRow& row : examination.rows) {
    const Structure& structure = row.structure;
    Json json{{"id", structure.id}, {"name", structure.name}};
    if (structure.label) json["label"] = *structure.label;
    json.update({{"color", to_hex(structure.color)}, {"voxels", row.measures.sums.voxels}, {"ml", row.ml}});
    if (!row.is_group) json.update({{"pieces", row.measures.pieces}, {"holes", row.measures.holes}});
    if (row.measures.sums.voxels > 0) json["box_lps_mm"] = {row.box_lps_mm.first, row.box_lps_mm.second};
    rows.push_back(std::move(json));
  }
  return rows;
}

}  // namespace

std::string text_of_place(const Vec3& lps_mm) {
  const auto rounded = [&](std::size_t a) { return std::round(lps_mm[a] * 100) / 100 + 0.0; };
  return fmt::format("{}, {}, {}", rounded(0), rounded(1), rounded(2));
}

std::string report_as_json(const Notes* notes, const Examination& examination) {
  Json report = Json::object();
  if (notes != nullptr) report["notes"] = Json::array();
  for (const Note& note : notes != nullptr ? notes->all() : std::span<const Note>()) {
    report["notes"].push_back({{"kind", note.kind},
                               {"warning", note.level() == NoteLevel::kWarning},
                               {"count", note.items.size()},
                               {"message", note.message()},
                               {"items", note.items}});
  }
  report["structures"] = rows_as_json(examination);
  report["findings"] = Json::array();
  for (const Finding& finding : examination.findings) {
    report["findings"].push_back(
        {{"kind", finding.kind},
         {"count", finding.count},
         {"message", finding.message},
         {"remedy", finding.remedy},
         {"place_lps_mm", finding.place_lps_mm ? Json(*finding.place_lps_mm) : Json()},
         {"structures", finding.structures}});
  }
  return json_text(report);
}

std::string report_as_html(const Notes* notes, const Examination& examination,
                           const std::filesystem::path& atlas) {
  std::string page = fmt::format(
      kHead, (notes != nullptr ? "Build of " : "Check of ") + escaped_html(atlas.filename().string()));
  if (notes != nullptr && notes->empty()) page += "<p>Nothing is odd.</p>\n";
  for (const Note& note : notes != nullptr ? notes->all() : std::span<const Note>()) {
    page +=
        fmt::format("<details class=\"{}\"><summary>{}</summary><ul>\n",
                    note.level() == NoteLevel::kWarning ? "warning" : "note", escaped_html(note.message()));
    for (const std::string& item : note.items) page += fmt::format("<li>{}</li>\n", escaped_html(item));
    page += "</ul></details>\n";
  }
  return page + findings_as_html(examination) + rows_as_html(examination) + "</body></html>\n";
}

std::vector<std::filesystem::path> ReportFiles::files() const {
  std::vector<std::filesystem::path> files{json, html};
  std::erase(files, std::filesystem::path());
  return files;
}

Result<void> ReportFiles::add(const Notes* notes, const Examination& examination,
                              const std::filesystem::path& atlas, std::vector<OutputFile>& added) const {
  const auto add_text = [&](const std::filesystem::path& path, const std::string& text) -> Result<void> {
    return path.empty() ? Result<void>() : add_file(path, std::as_bytes(std::span(text)), added);
  };
  SPLATLAS_RETURN_IF_ERROR(add_text(json, report_as_json(notes, examination)));
  return add_text(html, report_as_html(notes, examination, atlas));
}

}  // namespace splatlas
