// Fuzz target: untrusted directories, refused or valid enough to be laid out and written again.
// Input: the bytes of the FlatBuffer.
#include <cstdint>
#include <vector>

#include "format/file/directory.h"
#include "format/file/file_layout.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/require.h"

namespace splatlas {
namespace {

void check_layout(const Directory& directory, std::uint64_t directory_bytes) {
  const auto layout = lay_out(directory, directory_bytes);
  if (!layout) return require_error(layout.error(), {ErrorCode::kInvalidAtlas});
  std::uint64_t offset = sizeof(FileHeader) + directory_bytes;
  for (std::size_t n = 0; n < directory.chunks.size(); ++n) {
    require(layout->chunk_offset[n] == offset, "chunks do not lie back to back");
    offset += directory.chunks[n].stored_bytes;
  }
  require(layout->file_bytes() == offset, "the last chunk is not at the end");
  for (const SectionLayout& section : layout->sections) {
    if (section.chunk_begin.empty()) continue;
    require(section.chunk_begin.back() == section.stream_begin.back(), "chunks and streams end apart");
  }
}

/// A directory survives a round trip.
void check_rewriting(const Directory& directory) {
  const auto bytes = require_value(encode_directory(directory));
  const Directory again = require_value(decode_directory(bytes));
  require(require_value(encode_directory(again)) == bytes, "a directory is another one when read again");
  require(validate(again).has_value(), "a sound directory is not sound when read again");
}

void fuzz_directories(FuzzInput input) {
  const auto rest = input.rest();
  const std::vector<std::byte> bytes(rest.begin(), rest.end());  // aligned
  const auto directory = decode_directory(bytes);
  if (!directory) return require_error(directory.error(), {ErrorCode::kInvalidAtlas});
  if (const auto valid = validate(*directory); !valid)
    return require_error(valid.error(), {ErrorCode::kInvalidAtlas});
  check_layout(*directory, bytes.size());
  check_rewriting(*directory);
}

const FuzzTarget kDirectories("directories", fuzz_directories);

}  // namespace
}  // namespace splatlas
