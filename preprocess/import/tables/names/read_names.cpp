#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/names/dialects.h"
#include "preprocess/import/tables/names_table.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// Detection takes the first that fits: those with a clear mark come first.
constexpr std::array kDialects{
    &kItkSnapNames, &kNiivueNames,  &kOpenAnatomyNames, &kBrainGlobeNames, &kAllenNames,
    &kDcmqiNames,   &kJsonNames,    &kFreeSurferNames,  &kBidsNames,       &kCsvNames,
    &kCtblNames,    &kFslEyesNames, &kFslNames,         &kMricronNames,
};

const Dialect* find_dialect(NamesFormat format, std::string_view text) {
  const std::string_view head = text.substr(0, kNamesHeadBytes);
  const auto* found = std::ranges::find_if(kDialects, [&](const Dialect* dialect) {
    return format == NamesFormat::kAuto ? dialect->recognise(head) : dialect->info.format == format;
  });
  return found == kDialects.end() ? nullptr : *found;
}

}  // namespace

std::span<const NamesFormatInfo> names_formats() {
  static const auto kInfos = [] {
    std::array<NamesFormatInfo, kDialects.size()> infos{};
    std::ranges::transform(kDialects, infos.begin(), &Dialect::info);
    return infos;
  }();
  return kInfos;
}

Result<NamesTable> read_names(const std::filesystem::path& path, NamesFormat format, Notes& notes) {
  SPLATLAS_ASSIGN_OR_RETURN(std::string text, read_text(path));
  const Dialect* dialect = find_dialect(format, text);
  if (dialect == nullptr) {
    const std::vector<TextLine> lines = lines_of(std::string_view(text).substr(0, kNamesHeadBytes));
    if (lines.empty()) return bad_file(path, "names no label");
    std::string options = "auto";
    for (const NamesFormatInfo& info : names_formats()) options += std::string(", ") + info.option;
    return bad_file(path, "line {}: {} begins no known table of names; give one of: --names-format {}",
                    lines.front().number, in_quotes(lines.front().text), options);
  }
  const NamesInput input{path, std::move(text), dialect->info.title};
  NamesCollector collector(input, notes);
  SPLATLAS_RETURN_IF_ERROR(dialect->read(input, collector));
  Result<NamesTable> table = collector.finish();
  if (!table) return table;
  table->dialect = dialect->info.format;
  notes.add("names-format", fmt::format("{} is read as {}", path.filename().string(), dialect->info.title));
  return table;
}

}  // namespace splatlas
