#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "format/result.h"
#include "format/text/json_text.h"
#include "preprocess/commands/commands.h"

namespace splatlas {
namespace {

std::string escaped_html(const std::string& text) {
  return escaped_markup(printable(text));
}

constexpr const char* kHead =
#include "preprocess/commands/report_head.txt"
    ;

}  // namespace

std::string report_as_json(const Notes& notes) {
  nlohmann::ordered_json report{{"notes", nlohmann::ordered_json::array()}};
  for (const Note& note : notes.all()) {
    report["notes"].push_back({{"kind", note.kind},
                               {"warning", note.level() == NoteLevel::kWarning},
                               {"count", note.items.size()},
                               {"message", note.message()},
                               {"items", note.items}});
  }
  return json_text(report);
}

std::string report_as_html(const Notes& notes, const std::filesystem::path& atlas) {
  std::string page = fmt::format(kHead, "Build of " + escaped_html(atlas.filename().string()));
  if (notes.empty()) page += "<p>Nothing is odd.</p>\n";
  for (const Note& note : notes.all()) {
    page +=
        fmt::format("<details class=\"{}\"><summary>{}</summary><ul>\n",
                    note.level() == NoteLevel::kWarning ? "warning" : "note", escaped_html(note.message()));
    for (const std::string& item : note.items) page += fmt::format("<li>{}</li>\n", escaped_html(item));
    page += "</ul></details>\n";
  }
  return page + "</body></html>\n";
}

}  // namespace splatlas
