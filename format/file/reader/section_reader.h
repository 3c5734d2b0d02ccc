// Reader of the streams of an open file.
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
#include "format/io/input_file.h"
#include "format/result.h"

namespace splatlas {

/// Reads, checks and decodes streams by section and index. Counts bytes. Thread-safe. Keeps references.
class SectionReader {
 public:
  SectionReader(const InputFile& file, const Directory& directory, const FileLayout& layout);

  /// Decodes a whole stream. kInvalidAtlas for damage, with the section and stream in the message.
  [[nodiscard]] Result<std::vector<std::byte>> read_stream(const SectionLayout& section,
                                                           std::size_t stream) const;
  /// Reads the n-th chunk of a section and verifies its checksum. Decodes chunks of known sections.
  [[nodiscard]] Result<void> check_chunk_of(const SectionLayout& section, std::uint32_t n) const;
  /// The stored bytes of the n-th chunk of a section, with a right checksum.
  [[nodiscard]] Result<std::vector<std::byte>> read_chunk_of(const SectionLayout& section,
                                                             std::uint32_t n) const;

  /// Stored bytes of the chunks read so far, each counted once, and decoded bytes, counted every time.
  [[nodiscard]] std::uint64_t read_bytes() const { return read_bytes_; }
  [[nodiscard]] std::uint64_t decoded_bytes() const { return decoded_bytes_; }

 private:
  using Bytes = std::vector<std::byte>;
  /// Cached chunk of several streams: its other streams are often read next.
  struct Shared {
    std::size_t chunk = 0;
    std::shared_ptr<const Bytes> bytes;  // null while another thread decodes it
  };
  static constexpr std::size_t kSharedKept = 16;  // per section

  [[nodiscard]] Result<Bytes> read_stored(std::size_t chunk) const;
  [[nodiscard]] Result<void> decode(const SectionLayout& section, std::size_t n,
                                    std::span<std::byte> to) const;
  /// Decodes a chunk once, even if several threads request its streams.
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
  mutable std::vector<std::deque<Shared>> shared_;  // per section, most recent last
};

}  // namespace splatlas
