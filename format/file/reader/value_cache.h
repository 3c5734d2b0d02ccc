// Cache of grey values that are decoded by group and read by class.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <mutex>
#include <vector>

#include "format/result.h"

namespace splatlas {

/// Keeps values of classes that were decoded with others of their group, until they are read. Thread-safe.
class ValueCache {
 public:
  using GroupValues = std::vector<std::vector<std::byte>>;  ///< [class of the group]

  /// Evicts the groups decoded first while the cache exceeds `max_bytes`.
  ValueCache(std::size_t groups, std::uint64_t max_bytes) : max_bytes_(max_bytes), slots_(groups) {}

  /// Returns the values of the n-th class of a group and removes them from the cache. On a miss, decodes the
  /// group; other threads wait for it. Errors of `decode` and exceptions leave the cache unchanged.
  [[nodiscard]] Result<std::vector<std::byte>> take(std::size_t group, std::size_t n,
                                                    const std::function<Result<GroupValues>()>& decode);

 private:
  struct Slot {
    std::mutex mutex;
    GroupValues values;       // empty if not decoded, or if all were taken
    std::vector<bool> taken;  // [class of the group]
  };

  /// Inserts a decoded group. The caller has locked its slot.
  void insert(std::size_t group, GroupValues values);

  std::uint64_t max_bytes_;
  std::vector<Slot> slots_;        // [group]
  std::mutex mutex_;               // guards the members below; locked after a slot's mutex
  std::list<std::size_t> groups_;  // those with values; most recent last
  std::uint64_t bytes_ = 0;
};

}  // namespace splatlas
