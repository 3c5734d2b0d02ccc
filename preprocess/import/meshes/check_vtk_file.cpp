#include "preprocess/import/meshes/check_vtk_file.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// Bytes of a number in binary files. VTK writes vtkIdType as int.
std::optional<std::size_t> bytes_of_type(const std::string& type) {
  static const std::map<std::string, std::size_t> kTypes{
      {"char", 1},          {"unsigned_char", 1}, {"short", 2},        {"unsigned_short", 2},
      {"int", 4},           {"unsigned_int", 4},  {"long", 8},         {"unsigned_long", 8},
      {"float", 4},         {"double", 8},        {"vtkidtype", 4},    {"vtktypeint32", 4},
      {"vtktypeuint32", 4}, {"vtktypeint64", 8},  {"vtktypeuint64", 8}};
  const auto found = kTypes.find(to_lower(type));
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

/// Walks through the geometry of a file.
class VtkFileCheck {
 public:
  VtkFileCheck(const fs::path& path, std::string_view text) : path_(path), text_(text) {}

  Result<void> check() {
    const std::string_view version = line();
    if (!version.starts_with("# vtk DataFile")) return bad_file(path_, "is not a legacy VTK file");
    // Since 5.1, cells are offsets and corners.
    has_offsets_ = parse_number(version.substr(version.find_last_of(' ') + 1)).value_or(0) >= 5;
    line();  // a title
    const std::string coding = to_lower(word());
    if (coding != "ascii" && coding != "binary") return bad_file(path_, "is neither ASCII nor BINARY");
    is_binary_ = coding == "binary";
    const bool has_dataset = to_lower(word()) == "dataset";
    if (const std::string type(word()); !has_dataset || to_lower(type) != "polydata")
      return bad_file(path_, "holds a dataset of type '{}'; POLYDATA is needed", type);
    while (true) {
      const std::string section = to_lower(word());
      if (section == "points") {
        SPLATLAS_RETURN_IF_ERROR(check_points());
      } else if (section == "vertices" || section == "lines" || section == "polygons" ||
                 section == "triangle_strips") {
        SPLATLAS_RETURN_IF_ERROR(check_cells(section));
      } else if (section == "metadata") {
        line();
        while (!line().empty()) continue;
      } else if (section == "field" && !has_points_) {
        at_ = std::min(text_.find("\nPOINTS ", at_), text_.size());
      } else {
        break;
      }
    }
    if (!has_points_) return bad_file(path_, "holds no points; it is cut short, or no surface");
    return {};
  }

 private:
  Result<void> check_points() {
    const std::int64_t points = count();
    const std::string type(word());
    const std::optional<std::size_t> bytes = bytes_of_type(type);
    if (!bytes) return bad_file(path_, "has points of type '{}'", type);
    has_points_ = true;
    return skip_numbers(points, 3, *bytes, "points");
  }

  Result<void> check_cells(const std::string& section) {
    const std::int64_t cells = count(), size = count();
    if (!has_offsets_) {
      SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::int64_t> list, numbers(size, 4, section));
      std::int64_t found = 0;
      std::size_t at = 0;
      for (; at < list.size(); ++found) at += 1 + static_cast<std::size_t>(list[at]);
      if (found == cells && at == list.size()) return {};
      return bad_file(path_, "is damaged: its {} do not fill their list of {} numbers", section, size);
    }
    if (cells == 0) return {};
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::int64_t> offsets, array("offsets", cells, section));
    SPLATLAS_RETURN_IF_ERROR(array("connectivity", size, section));
    bool rises = offsets.front() == 0 && offsets.back() == size;
    for (std::size_t n = 1; n < offsets.size(); ++n) rises = rises && offsets[n - 1] <= offsets[n];
    if (!rises)
      return bad_file(path_, "is damaged: its {} have offsets that do not rise to {}", section, size);
    return {};
  }

  /// "OFFSETS vtktypeint64" and the numbers.
  Result<std::vector<std::int64_t>> array(const char* name, std::int64_t size, const std::string& section) {
    const bool is_there = to_lower(word()) == name;
    const std::optional<std::size_t> bytes = bytes_of_type(std::string(word()));
    if (!is_there || !bytes) return bad_file(path_, "is damaged: its {} have no {}", section, name);
    return numbers(size, *bytes, section);
  }

  Result<std::vector<std::int64_t>> numbers(std::int64_t size, std::size_t bytes, const std::string& what) {
    const std::size_t first = text_.find('\n', at_) + 1;
    SPLATLAS_RETURN_IF_ERROR(skip_numbers(size, 1, bytes, what));
    std::vector<std::int64_t> list;
    for (std::size_t n = 0; is_binary_ && n < static_cast<std::size_t>(size); ++n) {
      std::uint64_t value = 0;
      for (std::size_t b = 0; b < bytes; ++b)
        value = value << 8 | static_cast<unsigned char>(text_[first + n * bytes + b]);
      list.push_back(bytes == 4 ? static_cast<std::int32_t>(value) : static_cast<std::int64_t>(value));
    }
    if (!is_binary_) at_ = first;
    for (std::int64_t n = 0; n < size && !is_binary_; ++n) list.push_back(parse_integer(word()).value_or(-1));
    if (std::ranges::any_of(list, [](std::int64_t number) { return number < 0; }))
      return bad_file(path_, "is damaged: its {} have a corner that is no number from 0", what);
    return list;
  }

  /// Skips `rows` times `columns` numbers, which follow the line. `what` names the rows in messages.
  Result<void> skip_numbers(std::int64_t rows, std::size_t columns, std::size_t bytes,
                            const std::string& what) {
    if (rows < 0) return bad_file(path_, "promises no number of {}", what);
    line();
    const std::uint64_t needed = static_cast<std::uint64_t>(rows),
                        each = is_binary_ ? columns * bytes : columns;
    std::uint64_t found = 0;
    if (is_binary_) {
      found = std::min((text_.size() - at_) / each, needed);
      at_ += found * each;
    } else {
      while (found < needed * columns && parse_number(word())) ++found;
      found /= columns;
    }
    if (found == needed) return {};
    return bad_file(path_, "is cut short or damaged: it promises {} {}{}, {} are there", rows,
                    what == "points" ? "" : "numbers of ", what, found);
  }

  std::string_view line() {
    const std::size_t first = std::min(at_, text_.size()),
                      end = std::min(text_.find('\n', first), text_.size());
    at_ = std::min(end + 1, text_.size());
    return trimmed(text_.substr(first, end - first));
  }
  std::string_view word() {
    constexpr const char* kBlanks = " \t\r\n\v\f";
    const std::size_t first = std::min(text_.find_first_not_of(kBlanks, at_), text_.size());
    at_ = std::min(text_.find_first_of(kBlanks, first), text_.size());
    return text_.substr(first, at_ - first);
  }
  /// A number of items; -1 if there is none.
  std::int64_t count() {
    constexpr std::int64_t kMost = std::int64_t{1} << 40;
    const std::int64_t value = parse_integer(word()).value_or(-1);
    return value <= kMost ? value : -1;
  }

  const fs::path& path_;
  std::string_view text_;
  std::size_t at_ = 0;
  bool is_binary_ = false, has_offsets_ = false, has_points_ = false;
};

}  // namespace

Result<void> check_vtk_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return VtkFileCheck(path, text).check();
}

}  // namespace splatlas
