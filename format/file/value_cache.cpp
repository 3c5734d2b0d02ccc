#include "format/file/value_cache.h"

#include <algorithm>
#include <utility>

#include "format/system/result_macros.h"

namespace splatlas {
namespace {

std::uint64_t bytes_of_all(const ValueCache::GroupValues& values) {
  std::uint64_t bytes = 0;
  for (const std::vector<std::byte>& of_class : values) bytes += of_class.size();
  return bytes;
}

}  // namespace

void ValueCache::insert(std::size_t group, GroupValues values) {
  Slot& slot = slots_[group];
  std::vector<bool> taken(values.size(), false);
  const std::lock_guard lock(mutex_);
  groups_.push_back(group);  // may throw: first, so that nothing has changed
  bytes_ += bytes_of_all(values);
  bytes_ -= bytes_of_all(slot.values);
  slot.values = std::move(values);
  slot.taken = std::move(taken);
  // Evict the oldest groups, except this one and those locked by other threads.
  for (std::size_t n = groups_.size(); n > 0 && bytes_ > max_bytes_; --n) {
    const std::size_t oldest = groups_.front();
    const std::unique_lock oldest_lock = oldest == group
                                             ? std::unique_lock<std::mutex>()
                                             : std::unique_lock(slots_[oldest].mutex, std::try_to_lock);
    if (!oldest_lock) groups_.push_back(oldest);
    groups_.pop_front();
    if (!oldest_lock) continue;
    bytes_ -= bytes_of_all(slots_[oldest].values);
    slots_[oldest].values.clear();
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
  if (all_taken) std::erase(groups_, group);
  return values;
}

}  // namespace splatlas
