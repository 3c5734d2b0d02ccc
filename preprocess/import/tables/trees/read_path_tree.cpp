// Tree files: one path per line (see kTreeFormat).
#include "format/result_macros.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/structure_name.h"
#include "preprocess/import/tables/text_file.h"
#include "preprocess/import/tables/trees/dialects.h"

namespace splatlas {
namespace {

/// Parses "#rrggbb" or "#rrggbb-#rrggbb".
Result<ColorRange> parse_color_range(std::string_view text) {
  const std::size_t dash = text.find('-');
  SPLATLAS_ASSIGN_OR_RETURN(const Rgb first, parse_color(text.substr(0, dash)));
  if (dash == std::string_view::npos) return ColorRange{first, first};
  SPLATLAS_ASSIGN_OR_RETURN(const Rgb last, parse_color(text.substr(dash + 1)));
  return ColorRange{first, last};
}

Result<TreeLine> parse_line(std::string_view text) {
  TreeLine line;
  constexpr std::string_view kColor = " color=";
  if (const std::size_t at = text.rfind(kColor); at != std::string_view::npos) {
    SPLATLAS_ASSIGN_OR_RETURN(line.color, parse_color_range(trimmed(text.substr(at + kColor.size()))));
    text = trimmed(text.substr(0, at));
  }
  const std::vector<std::string_view> parts = split(text, '/');
  for (std::size_t n = 0; n < parts.size(); ++n) {
    const bool last = n + 1 == parts.size();
    if (parts[n].empty() && !(last && n > 0)) return fail(ErrorCode::kUsage, "a part of the path is empty");
    if (!last && parts[n].find('*') != std::string_view::npos) {
      return fail(ErrorCode::kUsage, "'{}': only the last part may be a pattern", parts[n]);
    }
    if (last) {
      line.member = std::string(parts[n]);
    } else {
      if (const auto fit = check_structure_name(parts[n]); !fit)
        return fail(ErrorCode::kUsage, fit.error().message);
      line.groups.emplace_back(parts[n]);
    }
  }
  return line;
}

}  // namespace

bool recognise_path_tree(std::string_view /*head*/) {
  return true;
}

Result<std::vector<TreeLine>> read_path_tree(const NamesInput& input, NamesCollector& /*into*/) {
  std::vector<TreeLine> result;
  for (const TextLine& text : lines_of(input.text)) {
    Result<TreeLine> line = parse_line(text.text);
    if (!line) return bad_file(input.path, "line {}: {}", text.number, line.error().message);
    line->number = text.number;
    result.push_back(std::move(*line));
  }
  return result;
}

}  // namespace splatlas
