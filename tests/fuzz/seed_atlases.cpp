#include "tests/fuzz/seed_atlases.h"

#include <random>

#include "format/atlas_writer.h"
#include "tests/format/random_content.h"
#include "tests/support/fit_parts.h"

namespace splatlas {

AtlasContent seed_content(Random& random) {
  std::mt19937 twister(static_cast<std::uint32_t>(random()));
  AtlasContent content = random_content(twister, {.max_side = 7, .max_structures = 5, .max_vertices = 12});
  return below(2, random) == 0 ? fitted(std::move(content)) : content;
}

std::vector<std::byte> seed_atlas(Random& random) {
  const AtlasContent content = seed_content(random);
  return encode_atlas(content, {.level = 1, .compact = below(3, random) == 0, .threads = 1}).value();
}

}  // namespace splatlas
