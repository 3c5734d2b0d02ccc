#include "format/derive/structure_classes.h"

#include <numeric>

namespace splatlas {
namespace {

/// Calls visit(class, membership) for every membership inside a structure.
template <typename Visit>
void for_each_holding(const ClassTable& classes, const Visit& visit) {
  for (ClassId c = 0; c < classes.size(); ++c) {
    for (const Membership& m : classes.members(c)) {
      if (m.holds()) visit(c, m);
    }
  }
}

}  // namespace

StructureClasses::StructureClasses(const ClassTable& classes, std::size_t structures)
    : first_(structures + 1, 0) {
  for_each_holding(classes, [&](ClassId, const Membership& m) { ++first_[m.structure + 1]; });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  list_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for_each_holding(classes, [&](ClassId c, const Membership& m) {
    list_[next[m.structure]++] = {c, m.part};
  });
}

IndexBox box_of(const ClassTable& classes, std::span<const StructureClass> members) {
  IndexBox box;
  for (const StructureClass& h : members) box.include(classes.box(h.id));
  return box;
}

}  // namespace splatlas
