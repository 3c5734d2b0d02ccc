#include "preprocess/export/file_names.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include <fmt/format.h>

#include "format/text/ascii_text.h"
#include "preprocess/import/tables/structure_name.h"

namespace splatlas {
namespace {

// A mask builds back if its name is one of a structure. NAME_MAX of Linux is 255 bytes; NTFS and APFS allow
// as many characters.
constexpr std::size_t kMaxBytes = kMaxNameCharacters;
static_assert(kMaxBytes + std::string_view(".nii.gz").size() <= 255);

bool is_safe_character(char c) {
  return is_ascii_letter_or_digit(c) || c == '_' || c == '-' || c == '.';
}

/// Windows opens a device for these names, whatever follows the first dot.
bool is_device(std::string_view name) {
  const std::string base = to_lower(name.substr(0, name.find('.')));
  constexpr std::array<std::string_view, 4> kDevices{"con", "prn", "aux", "nul"};
  if (std::ranges::find(kDevices, base) != kDevices.end()) return true;
  return base.size() == 4 && (base.starts_with("com") || base.starts_with("lpt")) && base[3] >= '0' &&
         base[3] <= '9';
}

/// The name with safe characters only, of at most kMaxBytes. Safe names are unchanged.
std::string safe_name(std::string_view name) {
  std::string safe;
  bool in_run = false;
  for (const char c : name) {
    const bool is_safe = is_safe_character(c);
    if (is_safe || !in_run) safe += is_safe ? c : '_';
    in_run = !is_safe;
  }
  if (safe.empty() || safe.front() == '-' || safe.front() == '.' || is_device(safe)) safe.insert(0, 1, '_');
  safe.resize(std::min(safe.size(), kMaxBytes));
  if (safe.back() == '.') safe.back() = '_';
  return safe;
}

}  // namespace

std::vector<std::string> file_names_of(std::span<const std::string> names, std::string_view ending) {
  std::vector<std::string> result;
  std::set<std::string> taken;  // lower case

  // Keep safe names, the first of those that differ only by case
  std::vector<bool> is_kept;
  for (const std::string& name : names) {
    result.push_back(safe_name(name));
    is_kept.push_back(result.back() == name && taken.insert(to_lower(name)).second);
  }

  // Number the others where their name is taken
  std::map<std::string, int> last_number;  // by lower case
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (is_kept[n] || taken.insert(to_lower(result[n])).second) continue;
    const std::string base = result[n];
    int& number = last_number.try_emplace(to_lower(base), 1).first->second;
    do {
      const std::string suffix = fmt::format("_{}", ++number);
      result[n] = base.substr(0, kMaxBytes - suffix.size()) + suffix;
    } while (!taken.insert(to_lower(result[n])).second);
  }
  for (std::string& name : result) name += ending;
  return result;
}

}  // namespace splatlas
