// Reading of streams and chunks.
#include <algorithm>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "format/codec/chunk_codec.h"
#include "format/file/reader/atlas_impl.h"

namespace splatlas {

SectionReader::SectionReader(const InputFile& file, const Directory& directory, const FileLayout& layout)
    : file_(file),
      directory_(directory),
      layout_(layout),
      touched_(directory.chunks.size()),
      shared_(layout.sections.size()) {}

Result<SectionReader::Bytes> SectionReader::read_stored(std::size_t chunk) const {
  Bytes stored(directory_.chunks[chunk].stored_bytes);
  SPLATLAS_RETURN_IF_ERROR(file_.read(layout_.chunk_offset[chunk], stored));
  if (!touched_[chunk].exchange(true)) read_bytes_ += stored.size();
  return stored;
}

Result<void> SectionReader::decode(const SectionLayout& section, std::size_t n,
                                   std::span<std::byte> to) const {
  check_task();
  const std::size_t chunk = section.first_chunk + n;
  SPLATLAS_ASSIGN_OR_RETURN(const Bytes stored, read_stored(chunk));
  if (auto decoded = decode_chunk(stored, directory_.chunks[chunk], to); !decoded) {
    return fail(decoded.error().code, "damaged: {} of {}", decoded.error().message, describe(section, n));
  }
  decoded_bytes_ += to.size();
  return {};
}

Result<std::shared_ptr<const SectionReader::Bytes>> SectionReader::decode_shared(const SectionLayout& section,
                                                                                 std::size_t n) const {
  std::deque<Shared>& kept = shared_[static_cast<std::size_t>(&section - layout_.sections.data())];
  const std::size_t chunk = section.first_chunk + n;
  const auto find = [&] { return std::ranges::find(kept, chunk, &Shared::chunk); };
  {
    std::unique_lock lock(shared_mutex_);
    shared_changed_.wait(lock, [&] { return find() == kept.end() || find()->bytes != nullptr; });
    if (const auto found = find(); found != kept.end()) return found->bytes;
    kept.push_back({chunk, nullptr});
  }
  std::shared_ptr<const Bytes> bytes;
  const auto finish = [&] {  // without bytes on failure: waiting threads then retry
    const std::lock_guard lock(shared_mutex_);
    if (bytes) {
      find()->bytes = bytes;
    } else {
      kept.erase(find());
    }
    const auto done =
        std::ranges::find_if(kept, [](const Shared& shared) { return shared.bytes != nullptr; });
    if (kept.size() > kSharedKept && done != kept.end()) kept.erase(done);
    shared_changed_.notify_all();
  };
  Result<void> result;
  try {
    check_memory(static_cast<double>(kSharedKept * (section.chunk_begin[n + 1] - section.chunk_begin[n])));
    auto decoded = std::make_shared<Bytes>(section.chunk_begin[n + 1] - section.chunk_begin[n]);
    result = decode(section, n, *decoded);
    if (result) bytes = std::move(decoded);
  } catch (...) {
    finish();
    throw;
  }
  finish();
  if (!result) return tl::unexpected(std::move(result).error());  // a copy could throw
  return bytes;
}

Result<SectionReader::Bytes> SectionReader::read_stream(const SectionLayout& section,
                                                        std::size_t stream) const {
  const std::uint64_t begin = section.stream_begin[stream], end = section.stream_begin[stream + 1];
  Bytes bytes(end - begin);
  if (bytes.empty()) return bytes;
  const auto& cuts = section.chunk_begin;
  auto n = static_cast<std::size_t>(std::ranges::upper_bound(cuts, begin) - cuts.begin()) - 1;
  if (cuts[n] < begin || cuts[n + 1] > end) {  // the chunk contains other streams, too
    SPLATLAS_ASSIGN_OR_RETURN(const auto shared, decode_shared(section, n));
    std::memcpy(bytes.data(), shared->data() + (begin - cuts[n]), bytes.size());
    return bytes;
  }
  for (; n + 1 < cuts.size() && cuts[n] < end; ++n) {
    SPLATLAS_RETURN_IF_ERROR(
        decode(section, n, std::span(bytes).subspan(cuts[n] - begin, cuts[n + 1] - cuts[n])));
  }
  return bytes;
}

Result<SectionReader::Bytes> SectionReader::read_chunk_of(const SectionLayout& section,
                                                          std::uint32_t n) const {
  const std::size_t chunk = section.first_chunk + n;
  SPLATLAS_ASSIGN_OR_RETURN(Bytes stored, read_stored(chunk));
  if (auto sound = check_chunk(stored, directory_.chunks[chunk]); !sound) {
    return fail(sound.error().code, "damaged: {} of {}", sound.error().message, describe(section, n));
  }
  return stored;
}

Result<void> SectionReader::check_chunk_of(const SectionLayout& section, std::uint32_t n) const {
  if (section.chunk_begin.empty()) {
    SPLATLAS_RETURN_IF_ERROR(read_chunk_of(section, n));
    return {};
  }
  check_memory(static_cast<double>(section.chunk_begin[n + 1] - section.chunk_begin[n]));
  Bytes decoded(section.chunk_begin[n + 1] - section.chunk_begin[n]);
  return decode(section, n, decoded);
}

std::string SectionReader::describe(const SectionLayout& section, std::size_t n) const {
  const std::string name = section_name(section.kind);
  if (section.chunk_begin.empty()) return fmt::format("{} chunk {}", name, n);
  // Find the first and the last stream with bytes in the chunk.
  const auto& begins = section.stream_begin;
  const auto first = std::ranges::upper_bound(begins, section.chunk_begin[n]) - begins.begin() - 1;
  const auto last = std::ranges::lower_bound(begins, section.chunk_begin[n + 1]) - begins.begin() - 1;
  const auto from_to = [&](const char* one, const char* several, const auto& from, const auto& to) {
    return from == to ? fmt::format("{} of {} {}", name, one, from)
                      : fmt::format("{} of {} {} to {}", name, several, from, to);
  };
  if (section.kind == static_cast<std::uint32_t>(SectionKind::kSurfaces)) {
    const auto id = [&](auto stream) {
      return fmt::format("'{}'", directory_.graph[directory_.graph.preorder()[stream]].id);
    };
    return from_to("structure", "structures", id(first), id(last));
  }
  if (section.kind != static_cast<std::uint32_t>(SectionKind::kValues) &&
      section.kind != static_cast<std::uint32_t>(SectionKind::kMeans))
    return from_to("class", "classes", first, last);
  const ValueGroups groups(directory_.classes);
  return from_to("class", "classes", groups.classes[static_cast<std::size_t>(first)].front(),
                 groups.classes[static_cast<std::size_t>(last)].back());
}

}  // namespace splatlas
