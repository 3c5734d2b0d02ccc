// Values that are decoded together and asked for one by one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <vector>

#include "format/result.h"

namespace splatlas {

/// Values of decoded groups' classes that nobody has asked for yet: they are likely to be next. Thread-safe.
class HeldValues {
 public:
  using GroupValues = std::vector<std::vector<std::byte>>;  ///< [class of the group]

  /// Lets go of the groups that were decoded first where all together hold more than `max_bytes`.
  HeldValues(std::size_t groups, std::uint64_t max_bytes) : max_bytes_(max_bytes), slots_(groups) {}

  /// The values of the n-th class of a group, which are held no longer then. Where they are not held the
  /// group is decoded, and whoever asks for its values meanwhile waits. Errors are those of `decode`; nothing
  /// has changed then, nor when memory runs out.
  [[nodiscard]] Result<std::vector<std::byte>> take(std::size_t group, std::size_t n,
                                                    const std::function<Result<GroupValues>()>& decode);

 private:
  struct Slot {
    std::mutex mutex;
    GroupValues values;       // empty: not decoded, or all given away
    std::vector<bool> taken;  // [class of the group]
  };

  /// Holds a group that was decoded. The mutex of its slot is held.
  void hold(std::size_t group, GroupValues values);

  std::uint64_t max_bytes_;
  std::vector<Slot> slots_;         // [group]
  std::mutex mutex_;                // of what follows; taken after that of a slot
  std::deque<std::size_t> groups_;  // latest last; may name one twice
  std::uint64_t bytes_ = 0;
};

}  // namespace splatlas
