#include "format/file/reader/value_cache.h"

#include <algorithm>

#include "format/result_macros.h"

namespace splatlas {
namespace {

std::uint64_t bytes_of_all(const ValueCache::GroupValues& values) {
  std::uint64_t bytes = 0;
  for (const std::vector<std::byte>& of_class : values) bytes += of_class.size();
  return bytes;
}

}  // namespace

void ValueCache::insert(std::size_t group, GroupValues values) {
  // Allocations come first: they may throw
  Slot& slot = slots_[group];
  std::vector<bool> taken(values.size(), false);
  std::list<std::size_t> latest{group};
  const std::lock_guard lock(mutex_);
  groups_.remove(group);
  groups_.splice(groups_.end(), latest);
  bytes_ += bytes_of_all(values);
  bytes_ -= bytes_of_all(slot.values);
  slot.values = std::move(values);
  slot.taken = std::move(taken);
  // Evict the oldest groups, except this one and those locked by other threads.
  for (auto next = groups_.begin(); next != groups_.end() && bytes_ > max_bytes_;) {
    const auto oldest = next++;
    if (*oldest == group) continue;
    Slot& old = slots_[*oldest];
    const std::unique_lock old_lock(old.mutex, std::try_to_lock);
    if (!old_lock) continue;
    bytes_ -= bytes_of_all(old.values);
    old.values.clear();
    groups_.erase(oldest);
  }
}

Result<std::vector<std::byte>> ValueCache::take(std::size_t group, std::size_t n,
                                                const std::function<Result<GroupValues>()>& decode) {
  Slot& slot = slots_[group];
  const std::lock_guard lock(slot.mutex);  // one thread decodes, others wait
  if (slot.values.empty() || slot.taken[n]) {
    SPLATLAS_ASSIGN_OR_RETURN(GroupValues decoded, decode());
    insert(group, std::move(decoded));
  }
  slot.taken[n] = true;
  std::vector<std::byte> values = std::move(slot.values[n]);
  slot.values[n].clear();
  const bool all_taken = std::ranges::count(slot.taken, false) == 0;
  if (all_taken) slot.values.clear();
  const std::lock_guard totals_lock(mutex_);
  bytes_ -= values.size();
  if (all_taken) groups_.remove(group);
  return values;
}

}  // namespace splatlas
