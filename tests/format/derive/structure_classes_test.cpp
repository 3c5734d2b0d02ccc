#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/derive/structure_crop.h"
#include "format/file/fitted_content.h"
#include "tests/format/random_content.h"

namespace splatlas {
namespace {

/// The structures that contain the voxels of a class.
std::set<StructureIndex> holders_of(const ClassTable& classes, ClassId c) {
  std::set<StructureIndex> holders;
  for (const Membership& m : classes.members(c)) {
    if (m.holds()) holders.insert(m.structure);
  }
  return holders;
}

RC_GTEST_PROP(StructureClasses, AreThoseThatNameTheStructure, ()) {
  std::mt19937 random(*rc::gen::arbitrary<std::uint32_t>());
  const AtlasContent content = random_content(random, {9, 6, 3});
  const ClassTable& classes = content.classes;
  const std::size_t structures = content.graph.size();
  const StructureClasses held(classes, structures);
  const std::vector<bool> alike = find_uniform(classes, held, structures);
  for (StructureIndex s = 0; s < structures; ++s) {
    IndexBox box;
    std::set<std::set<StructureIndex>> combinations;
    std::size_t n = 0;
    for (ClassId c = 0; c < classes.size(); ++c) {
      const auto members = classes.members(c);
      const auto member = std::ranges::find(members, s, &Membership::structure);
      if (member == members.end() || member->part == Part::kCrossed) continue;
      RC_ASSERT(n < held.of(s).size());
      RC_ASSERT(held.of(s)[n].id == c);
      RC_ASSERT(held.of(s)[n].part == member->part);
      box.include(classes.box(c));
      combinations.insert(holders_of(classes, c));
      ++n;
    }
    RC_ASSERT(n == held.of(s).size());
    RC_ASSERT(box_of(classes, held.of(s)) == box);
    RC_ASSERT(alike[s] == (combinations.size() <= 1));
  }
}

}  // namespace
}  // namespace splatlas
