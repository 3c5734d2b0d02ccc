// Classes of a small atlas from the memberships of each voxel.
#pragma once

#include <vector>

#include "format/content/atlas_content.h"
#include "tests/support/neighbours.h"

namespace splatlas {

/// Fills the empty classes and class volume, in storage order. `members_of(index)`: memberships of a voxel.
template <typename MembersOf>
void fill_classes(AtlasContent& content, const MembersOf& members_of) {
  ClassTable classes;
  for_each_voxel(storage_grid(content).size, [&](const Index3& at) {
    const ClassId c = classes.intern(members_of(at));
    classes.count(c, 1, {at, at});
    content.class_volume.push_back(c);
  });
  const std::vector<ClassId> order = storage_order(classes, content.graph);
  std::vector<ClassId> number(order.size());
  for (ClassId c = 0; c < order.size(); ++c) number[order[c]] = c;
  for (ClassId& c : content.class_volume) c = number[c];
  content.classes = classes.renumbered(order);
}

}  // namespace splatlas
