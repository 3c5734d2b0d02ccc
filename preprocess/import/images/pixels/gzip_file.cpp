#include "preprocess/import/images/pixels/gzip_file.h"

#include <algorithm>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {

Result<GzipFile> GzipFile::open(const std::filesystem::path& path) {
  GzipFile file;
  file.path_ = path;
  file.stream_.reset(gzopen(path.c_str(), "rb"));
  if (!file.stream_) return bad_file(path, "cannot be opened for reading");
  const std::string name = to_lower(path.filename().string());
  const bool should_be = name.ends_with(".gz") || name.ends_with(".mgz");
  if (file.is_compressed() == should_be) return file;
  if (should_be && first_bytes(path, 1).empty()) return bad_file(path, "is empty");
  return bad_file(path, "is {}compressed, which its ending denies; rename it", should_be ? "not " : "");
}

Result<std::size_t> GzipFile::read_some(std::span<std::byte> bytes) {
  constexpr std::size_t kMaxRead = std::size_t{1} << 30;  // zlib's counts are of type int
  std::size_t done = 0;
  while (done < bytes.size()) {
    const int count =
        gzread(stream_.get(), &bytes[done], static_cast<unsigned>(std::min(bytes.size() - done, kMaxRead)));
    if (count < 0) SPLATLAS_RETURN_IF_ERROR(check_status(done));
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

Result<std::vector<std::byte>> GzipFile::read(std::uint64_t offset, std::uint64_t count) {
  constexpr std::size_t kPiece = std::size_t{16} << 20;  // touched memory follows the file, not its header
  std::vector<std::byte> bytes;
  bytes.reserve(count);
  const auto start = static_cast<z_off_t>(offset);
  if (gzseek(stream_.get(), start, SEEK_SET) != start) return truncated_file(path_, count, 0);
  while (bytes.size() < count) {
    const std::size_t done = bytes.size();
    bytes.resize(std::min<std::uint64_t>(count, done + kPiece));
    SPLATLAS_ASSIGN_OR_RETURN(const std::size_t found, read_some(std::span(bytes).subspan(done)));
    if (done + found == bytes.size()) continue;
    SPLATLAS_RETURN_IF_ERROR(check_status(done + found));
    return truncated_file(path_, count, done + found);
  }
  return bytes;
}

Result<void> GzipFile::check_end() {
  if (!is_compressed()) return {};
  std::vector<std::byte> surplus(1 << 18);
  for (std::uint64_t found = 0; found < kMaxSurplus; found += surplus.size()) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::size_t read, read_some(surplus));
    if (read < surplus.size()) break;
  }
  int status = Z_OK;
  const char* const reason = gzerror(stream_.get(), &status);
  if (status == Z_OK) return {};
  return bad_file(path_, "is truncated or damaged at the end of its compressed pixels ({})", reason);
}

Result<void> GzipFile::check_status(std::uint64_t read) const {
  int status = Z_OK;
  const char* const reason = gzerror(stream_.get(), &status);
  if (status == Z_OK || status == Z_BUF_ERROR) return {};
  return bad_file(path_, "its compressed bytes are damaged after {} bytes ({})", read, reason);
}

}  // namespace splatlas
