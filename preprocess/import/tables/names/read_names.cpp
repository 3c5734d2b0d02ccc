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

struct Dialect {
  NamesFormatInfo info;
  bool (*recognise)(std::string_view head);
  Result<void> (*read)(const NamesInput& input, NamesCollector& into);
};

/// Detection takes the first that fits: those with a clear mark come first.
constexpr std::array kDialects{
    Dialect{{NamesFormat::kItkSnap, "itksnap", "ITK-SNAP labels"}, recognise_itk_snap, read_itk_snap},
    Dialect{{NamesFormat::kNiivue, "niivue", "NiiVue colour map"}, recognise_niivue, read_niivue},
    Dialect{{NamesFormat::kOpenAnatomy, "openanatomy", "Open Anatomy atlas"},
            recognise_open_anatomy,
            read_open_anatomy},
    Dialect{{NamesFormat::kBrainGlobe, "brainglobe", "BrainGlobe structures"},
            recognise_brainglobe,
            read_brainglobe},
    Dialect{{NamesFormat::kAllen, "allen", "Allen structure graph"}, recognise_allen, read_allen},
    Dialect{
        {NamesFormat::kDcmqi, "dcmqi", "description of a DICOM segmentation"}, recognise_dcmqi, read_dcmqi},
    Dialect{{NamesFormat::kJson, "json", "JSON class map"}, recognise_json_map, read_json_map},
    Dialect{{NamesFormat::kFreeSurfer, "freesurfer", "FreeSurfer colour table"},
            recognise_freesurfer,
            read_freesurfer},
    Dialect{{NamesFormat::kBids, "bids", "BIDS segmentation table"}, recognise_bids, read_csv},
    Dialect{{NamesFormat::kCsv, "csv", "table with columns (CSV or TSV)"}, recognise_csv, read_csv},
    Dialect{{NamesFormat::kCtbl, "ctbl", "3D Slicer colour table"}, recognise_ctbl, read_ctbl},
    Dialect{{NamesFormat::kFslEyes, "fsleyes", "FSLeyes colour table"}, recognise_fsleyes, read_fsleyes},
    Dialect{{NamesFormat::kFsl, "fsl", "FSL atlas"}, recognise_fsl, read_fsl},
    Dialect{{NamesFormat::kMricron, "mricron", "list of labels and names"}, recognise_mricron, read_mricron},
};

constexpr auto kInfos = [] {
  std::array<NamesFormatInfo, kDialects.size()> infos{};
  for (std::size_t n = 0; n < infos.size(); ++n) infos[n] = kDialects[n].info;
  return infos;
}();

const Dialect* find_dialect(NamesFormat format, std::string_view text) {
  const std::string_view head = text.substr(0, kNamesHeadBytes);
  const auto* found = std::ranges::find_if(kDialects, [&](const Dialect& dialect) {
    return format == NamesFormat::kAuto ? dialect.recognise(head) : dialect.info.format == format;
  });
  return found == kDialects.end() ? nullptr : found;
}

std::string list_of_options() {
  std::vector<const char*> options;
  for (const NamesFormatInfo& info : kInfos) options.push_back(info.option);
  return fmt::format("auto, {}", fmt::join(options, ", "));
}

}  // namespace

std::span<const NamesFormatInfo> names_formats() {
  return kInfos;
}

Result<NamesTable> read_names(const std::filesystem::path& path, NamesFormat format, Notes& notes) {
  SPLATLAS_ASSIGN_OR_RETURN(std::string text, read_text(path));
  const Dialect* dialect = find_dialect(format, text);
  if (dialect == nullptr) {
    const std::vector<TextLine> lines = lines_of(std::string_view(text).substr(0, kNamesHeadBytes));
    if (lines.empty()) return bad_file(path, "names no label");
    return bad_file(path, "line {}: {} begins no known table of names; give one of: --names-format {}",
                    lines.front().number, in_quotes(lines.front().text), list_of_options());
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
