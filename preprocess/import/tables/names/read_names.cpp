#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/tables/names_collector.h"
#include "preprocess/import/tables/names_table.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {

std::optional<std::int64_t> parse_label(std::string_view text) {
  const double number = parse_number(text).value_or(-1);  // doubles hold all labels
  const bool is_label = number >= 0 && number <= double{kMaxLabel} && std::floor(number) == number;
  return is_label ? std::optional(static_cast<std::int64_t>(number)) : std::nullopt;
}

tl::unexpected<Error> NamesInput::refuse(const std::string& fault) const {
  return bad_file(path, "cannot be read as {}: {}", title, fault);
}

std::string NamesCollector::place(std::size_t line) const {
  return fmt::format("{} {} {}", input_.path.filename().string(), input_.unit(), line);
}

void NamesCollector::add(std::string_view label, LabelName name) {
  if (label.empty()) return add(std::move(name));
  name.label = parse_label(label);
  if (!name.label) {
    return add_fault(name.line, fmt::format("{} is no label (whole, 0 to {})", in_quotes(label), kMaxLabel));
  }
  add(std::move(name));
}

void NamesCollector::add(LabelName name) {
  if (name.label == 0) {
    table_.zero_name = name.name;
    return;
  }
  name.name = std::string(trimmed(name.name));
  if (name.name.empty()) {
    if (!name.label) return add_fault(name.line, "has neither a label nor a name");
    name.name = fmt::format("Label {}", *name.label);
    notes_.add("missing-names", fmt::format("{} ({})", *name.label, place(name.line)));
  }
  if (const auto fit = check_structure_name(name.name); !fit)
    return add_fault(name.line, fit.error().message);
  const bool is_new = name.label ? line_of_label_.emplace(*name.label, name.line).second
                                 : unlabelled_.insert(name_key(name.name)).second;
  if (!is_new) {
    const std::string again = name.label ? fmt::format("label {}", *name.label) : in_quotes(name.name);
    return notes_.add("duplicate-labels", fmt::format("{} at {}", again, place(name.line)));
  }
  table_.names.push_back(std::move(name));
}

void NamesCollector::add_fault(std::size_t line, const std::string& fault) {
  if (first_fault_.empty()) first_fault_ = fmt::format("{} {}: {}", input_.unit(), line, fault);
  notes_.add("faulty-rows", fmt::format("{}: {}", place(line), fault));
}

void NamesCollector::add_note(std::string_view kind, std::size_t line, std::string_view value) {
  notes_.add(kind, fmt::format("{}: {}", place(line), in_quotes(value)));
}

void NamesCollector::add_ignored_column(std::string_view name) {
  notes_.add("ignored-columns", in_quotes(name));
}

Result<NamesTable> NamesCollector::finish() {
  if (table_.names.empty()) {
    return input_.refuse((first_fault_.empty() ? "names no label" : first_fault_) +
                         "; correct it, or give another --names-format");
  }
  return std::move(table_);
}

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
