#include "tests/fuzz/seed_atlases.h"

#include <random>

#include "format/atlas_writer.h"
#include "tests/campaigns/faults/work_bombs.h"
#include "tests/format/random_content.h"
#include "tests/support/fit_parts.h"
#include "tests/support/sparse_atlas.h"

namespace splatlas {

AtlasContent seed_content(Random& random) {
  std::mt19937 twister(static_cast<std::uint32_t>(random()));
  AtlasContent content = random_content(twister, {.max_side = 7, .max_structures = 5, .max_vertices = 12});
  return below(2, random) == 0 ? fitted(std::move(content)) : content;
}

std::vector<std::byte> seed_atlas(Random& random) {
  const AtlasContent content = seed_content(random);
  return encode_atlas(
             content,
             {.level = 1, .compact = below(3, random) == 0, .threads = 1, .means_from = below(40, random)})
      .value();
}

std::vector<std::byte> work_seed(Random& random) {
  constexpr std::size_t kMaxBytes = 8 << 10;  // of scripts/fuzz.sh
  const auto number = [&](std::size_t first, std::size_t last) {
    return first + below(last - first + 1, random);
  };
  while (true) {
    std::vector<std::byte> file;
    switch (below(6, random)) {
      case 0:
        file =
            fitted_pairs(static_cast<std::int64_t>(number(1, 12)), static_cast<std::int64_t>(number(2, 200)));
        break;
      case 1: file = layered_graph(number(1, 20), number(1, 3)); break;
      case 2: file = layered_graph(2, number(1, 30)); break;
      case 3: {
        const auto side = static_cast<std::int64_t>(number(2, 90));
        file = with_zero_values(sparse_atlas(
            {side, side, side}, {{voxel_box({0, 0, 0}), voxel_box({side - 1, side - 1, side - 1})}}));
        break;
      }
      default:
        file = sparse_giant(static_cast<std::uint32_t>(random()), {.structures = 8, .boxes = 5, .side = 40});
        break;
    }
    if (file.size() <= kMaxBytes) return file;
  }
}

}  // namespace splatlas
