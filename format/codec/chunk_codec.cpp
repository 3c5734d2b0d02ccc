#include "format/codec/chunk_codec.h"

#include <cstring>
#include <memory>
#include <mutex>
#include <new>

#include <zstd.h>

#include "format/io/checksum.h"
#include "format/result_macros.h"

namespace splatlas {

namespace {

template <auto release>
struct Release {
  void operator()(auto* context) const { release(context); }
};
using CompressContext = std::unique_ptr<ZSTD_CCtx, Release<ZSTD_freeCCtx>>;
using DecompressContext = std::unique_ptr<ZSTD_DCtx, Release<ZSTD_freeDCtx>>;

/// Pool of reusable contexts: creating one costs more than a small chunk. Not thread_local: the first use of
/// a thread_local with a destructor takes the dynamic linker's lock, which loading a module holds for long.
template <typename Context, auto create>
class ContextPool {
 public:
  /// Exclusive use of a context. Returns it to the pool on destruction.
  class Lease {
   public:
    Lease(ContextPool& pool, Context context) : pool_(pool), context_(std::move(context)) {}
    ~Lease() {
      const std::lock_guard lock(pool_.mutex_);
      pool_.idle_.push_back(std::move(context_));
    }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    [[nodiscard]] auto* get() const { return context_.get(); }

   private:
    ContextPool& pool_;
    Context context_;
  };

  [[nodiscard]] static Lease take() {
    static ContextPool pool;
    {
      const std::lock_guard lock(pool.mutex_);
      if (!pool.idle_.empty()) {
        Context context = std::move(pool.idle_.back());
        pool.idle_.pop_back();
        return Lease(pool, std::move(context));
      }
      pool.idle_.reserve(++pool.made_);  // returning the context cannot throw
    }
    Context context(create());
    if (!context) throw std::bad_alloc();
    return Lease(pool, std::move(context));
  }

 private:
  std::mutex mutex_;
  std::vector<Context> idle_;
  std::size_t made_ = 0;  // upper bound: includes contexts that could not be created
};
using CompressContexts = ContextPool<CompressContext, ZSTD_createCCtx>;
using DecompressContexts = ContextPool<DecompressContext, ZSTD_createDCtx>;

/// Checks for exactly one frame of the expected decoded length. Zstandard takes several and skippable ones.
Result<void> check_frame(std::span<const std::byte> stored, std::size_t decoded_bytes) {
  constexpr std::uint32_t kMagic = ZSTD_MAGICNUMBER;
  if (stored.size() < sizeof kMagic || std::memcmp(stored.data(), &kMagic, sizeof kMagic) != 0) {
    return invalid_atlas("not a Zstandard frame");
  }
  const std::size_t frame_bytes = ZSTD_findFrameCompressedSize(stored.data(), stored.size());
  if (ZSTD_isError(frame_bytes) || frame_bytes != stored.size())
    return invalid_atlas("not one Zstandard frame");
  const unsigned long long content = ZSTD_getFrameContentSize(stored.data(), stored.size());
  if (content != decoded_bytes) return invalid_atlas("wrong frame length (expected {} bytes)", decoded_bytes);
  if (ZSTD_getDictID_fromFrame(stored.data(), stored.size()) != 0)
    return invalid_atlas("its frame needs a dictionary");
  return {};
}

}  // namespace

EncodedChunk encode_chunk(std::span<const std::byte> decoded, int level, ChunkContent content) {
  EncodedChunk chunk;
  chunk.bytes.resize(ZSTD_compressBound(decoded.size()));
  const auto context = CompressContexts::take();
  ZSTD_CCtx_reset(context.get(), ZSTD_reset_session_and_parameters);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, level);
  if (content == ChunkContent::kNoise) {
    // This strategy splits blocks and weighs matches. Small tables find few, mostly profitable ones.
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_strategy, ZSTD_btultra);
    for (const ZSTD_cParameter table : {ZSTD_c_hashLog, ZSTD_c_chainLog})
      ZSTD_CCtx_setParameter(context.get(), table, 6);
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_searchLog, 1);
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_minMatch, 7);
  }
  const std::size_t size =
      ZSTD_compress2(context.get(), chunk.bytes.data(), chunk.bytes.size(), decoded.data(), decoded.size());
  if (ZSTD_isError(size)) throw std::bad_alloc();  // the only possible failure with a worst-case buffer
  if (size < decoded.size()) {
    chunk.bytes.resize(size);
    chunk.entry.codec = ChunkCodec::kZstd;
  } else {
    chunk.bytes.assign(decoded.begin(), decoded.end());
    chunk.entry.codec = ChunkCodec::kStored;
  }
  chunk.bytes.shrink_to_fit();
  chunk.entry.stored_bytes = static_cast<std::uint32_t>(chunk.bytes.size());
  chunk.entry.checksum = checksum_of(chunk.bytes);
  return chunk;
}

Result<void> check_chunk(std::span<const std::byte> stored, const ChunkEntry& entry) {
  if (checksum_of(stored) != entry.checksum) return invalid_atlas("checksum");
  return {};
}

Result<void> decode_chunk(std::span<const std::byte> stored, const ChunkEntry& entry,
                          std::span<std::byte> decoded) {
  SPLATLAS_RETURN_IF_ERROR(check_chunk(stored, entry));
  if (entry.filter != 0) return invalid_atlas("unknown filter {}", entry.filter);
  switch (entry.codec) {
    case ChunkCodec::kStored:
      if (stored.size() != decoded.size()) {
        return invalid_atlas("{} bytes, expected {}", stored.size(), decoded.size());
      }
      if (!decoded.empty()) std::memcpy(decoded.data(), stored.data(), stored.size());
      return {};
    case ChunkCodec::kZstd: {
      SPLATLAS_RETURN_IF_ERROR(check_frame(stored, decoded.size()));
      const auto context = DecompressContexts::take();
      const std::size_t size =
          ZSTD_decompressDCtx(context.get(), decoded.data(), decoded.size(), stored.data(), stored.size());
      if (ZSTD_isError(size)) return invalid_atlas("Zstandard: {}", ZSTD_getErrorName(size));
      if (size != decoded.size()) return invalid_atlas("{} bytes, expected {}", size, decoded.size());
      return {};
    }
  }
  return invalid_atlas("unknown codec {}", static_cast<unsigned>(entry.codec));
}

}  // namespace splatlas
