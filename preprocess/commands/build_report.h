// Report of a build: all notes, for programs and for people.
#pragma once

#include <filesystem>
#include <string>

#include "preprocess/import/notes.h"

namespace splatlas {

/// {"notes": [{"kind": "empty-masks", "warning": bool, "count": N, "message": "...",
/// "items": [...]}]}.
[[nodiscard]] std::string report_as_json(const Notes& notes);
/// A page of its own, without scripts. `atlas` is named in its title.
[[nodiscard]] std::string report_as_html(const Notes& notes, const std::filesystem::path& atlas);

}  // namespace splatlas
