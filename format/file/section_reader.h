// Streams of the open file: reads, checks and decodes their chunks, and counts the bytes.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "format/file/directory.h"
#include "format/file/file_layout.h"
#include "format/result.h"
#include "format/system/input_file.h"

namespace splatlas {

/// Reads streams by section and number. Thread-safe; holds references.
class SectionReader {
 public:
  SectionReader(const InputFile& file, const Directory& directory, const FileLayout& layout);

  /// A whole stream, decoded. kInvalidAtlas for damage, telling which stream of which section.
  [[nodiscard]] Result<std::vector<std::byte>> read_stream(const SectionLayout& section,
                                                           std::size_t stream) const;
  /// Reads a section's n-th chunk, checks its checksum, and decodes it where the section is known.
  [[nodiscard]] Result<void> check_chunk_of(const SectionLayout& section, std::uint32_t n) const;

  /// Stored bytes of the chunks touched so far, each once; and bytes decoded, each time.
  [[nodiscard]] std::uint64_t read_bytes() const { return read_bytes_; }
  [[nodiscard]] std::uint64_t decoded_bytes() const { return decoded_bytes_; }

 private:
  using Bytes = std::vector<std::byte>;
  /// A chunk of several streams that was decoded lately: its other streams are often next.
  struct Shared {
    std::size_t chunk = 0;
    std::shared_ptr<const Bytes> bytes;  // null while the thread that asked first is at it
  };
  static constexpr std::size_t kSharedKept = 16;  // per section; more than threads are at once

  [[nodiscard]] Result<Bytes> read_stored(std::size_t chunk) const;
  [[nodiscard]] Result<void> decode(const SectionLayout& section, std::size_t n,
                                    std::span<std::byte> to) const;
  /// Decodes a chunk once, however many threads ask for its streams.
  [[nodiscard]] Result<std::shared_ptr<const Bytes>> decode_shared(const SectionLayout& section,
                                                                   std::size_t n) const;
  /// "values of class 12", "runs_z of classes 4 to 9", "surfaces of structure 'ACC_L'".
  [[nodiscard]] std::string describe(const SectionLayout& section, std::size_t n) const;

  const InputFile& file_;
  const Directory& directory_;
  const FileLayout& layout_;
  mutable std::vector<std::atomic<bool>> touched_;  // per chunk of the file
  mutable std::atomic<std::uint64_t> read_bytes_{0}, decoded_bytes_{0};
  mutable std::mutex shared_mutex_;
  mutable std::condition_variable shared_changed_;
  mutable std::vector<std::deque<Shared>> shared_;  // per section, latest last
};

}  // namespace splatlas
