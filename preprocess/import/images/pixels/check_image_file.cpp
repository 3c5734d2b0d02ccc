#include "preprocess/import/images/pixels/check_image_file.h"

#include <algorithm>

#include "format/content/grid.h"
#include "format/io/memory_limit.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {

namespace fs = std::filesystem;

/// A unit of length, or the beginning of its name, and its millimetres, a line each.
constexpr std::string_view kUnits =
#include "preprocess/import/images/pixels/units.txt"
    ;

std::string shown(const std::string& value) {
  std::size_t end = value.size();
  for (const char* mark : {": ", " = ", ":=", " #"}) end = std::min(end, value.find(mark));
  if (end == value.size()) return value;
  return value.substr(0, value.find_last_of(' ', end)) + " ...";
}

Result<fs::path> pixel_file_beside(const fs::path& header, const std::string& name) {
  // ITK's readers take any name that begins so for a list, and follow its lines to any file.
  const std::string lower = to_lower(name);
  std::error_code error;
  const bool is_pattern =
      name.find('%') != std::string::npos && !fs::exists(header.parent_path() / name, error);
  if (lower.starts_with("list") || lower.starts_with("skiplist") || is_pattern)
    return bad_file(header, "spreads its pixels over several files; give one file");
  const fs::path folder =
      fs::canonical(header.has_parent_path() ? header.parent_path() : fs::path("."), error);
  const fs::path target = error ? fs::path() : fs::weakly_canonical(folder / name, error);
  const auto [rest_of_folder, unused] =
      std::mismatch(folder.begin(), folder.end(), target.begin(), target.end());
  if (error || rest_of_folder != folder.end() || fs::path(name).is_absolute()) {
    return bad_file(header, "names a pixel file outside its own folder: '{}'", shown(name));
  }
  SPLATLAS_RETURN_IF_ERROR(check_regular_file(target));
  return target;
}

std::optional<double> mm_of_unit(std::string_view unit) {
  const std::string lower = to_lower(trimmed(unit));
  const std::vector<std::string_view> words = split_blanks(kUnits);
  for (std::size_t n = 0; n < words.size(); n += 2) {
    if (lower == words[n] || (words[n].size() > 2 && lower.starts_with(words[n])))
      return parse_number(words[n + 1]);
  }
  return lower.empty() ? std::optional(1.0) : std::nullopt;
}

Result<std::uint64_t> payload_bytes(const fs::path& path, std::span<const std::int64_t> sizes,
                                    std::uint64_t bytes_per_voxel) {
  std::int64_t voxels = 1;
  for (const std::int64_t size : sizes) {
    if (size < 1 || size > kMaxAxisSize || voxels > kMaxVoxels / size) {
      return bad_file(path, "has an impossible size of {} voxels: at most {} along an axis, and {} in all",
                      fmt::join(sizes, " x "), kMaxAxisSize, kMaxVoxels);
    }
    voxels *= size;
  }
  return static_cast<std::uint64_t>(voxels) * bytes_per_voxel;
}

Result<void> check_image_memory(const fs::path& path, std::uint64_t bytes) {
  const std::uint64_t most = machine_memory() / 3 * 2;
  if (bytes <= most) return {};
  return fail(ErrorCode::kLimit,
              "{}: has {} MiB of pixels, and its reader may hold {} MiB; crop or downsample it",
              path.string(), bytes >> 20, most >> 20);
}

Result<void> check_raw_payload(const fs::path& path, std::uint64_t offset, std::uint64_t needed,
                               std::uint64_t expected) {
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  if (error) return bad_file(path, "{}", error.message());
  const std::uint64_t found = size > offset ? size - offset : 0;
  if (found < needed) return truncated_file(path, expected, found);
  return check_image_memory(path, expected);
}

tl::unexpected<Error> truncated_file(const fs::path& path, std::uint64_t expected, std::uint64_t found) {
  return bad_file(path, "is truncated: its header promises {} bytes of pixels, {} are there", expected,
                  found);
}

tl::unexpected<Error> bad_pixel_type(const fs::path& path, std::string_view type) {
  return bad_file(path, "has pixels of {}; 8, 16 and 32-bit integers, float and double are read", type);
}

}  // namespace splatlas
