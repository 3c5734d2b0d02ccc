// Fixture of tests that left stays left: marks at the sides of a body.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "preprocess/import/labels/import_labels.h"
#include "tests/preprocess/import/side_volumes.h"
#include "tests/preprocess/messages_of_notes.h"
#include "tests/support/axis_orders.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {

/// An upright and an oblique body, whose axes have sizes `in_file` in a file of this order.
inline std::vector<Body> bodies(const AxisOrder& order = {}, const Index3& in_file = {8, 6, 5}) {
  Body upright;
  for (std::size_t a = 0; a < 3; ++a) upright.size[order.from[a]] = in_file[a];
  Body oblique = upright;
  oblique.axes_lps = oblique_axes();
  return {upright, oblique};
}

/// The structure of a mark: by its label, or by its name in segmentations.
inline StructureIndex structure_of(const ImportedLabels& labels, std::uint8_t mark) {
  const std::array<std::string, 4> names{"", "left", "front", "top"};
  for (StructureIndex s = 0; s < labels.structures.size(); ++s) {
    const SourceStructure& structure = labels.structures[s];
    if (structure.name == names.at(mark) || structure.name == fmt::format("Label {}", mark)) return s;
  }
  ADD_FAILURE() << "no structure for mark " << int{mark};
  return 0;
}

inline Vec3 centroid_of(const ImportedLabels& labels, StructureIndex structure) {
  const Grid grid = reordered(labels.source_grid, storage_order(labels.source_grid));
  const Affine to_mm = index_to_lps_mm(grid);
  Vec3 sum{0, 0, 0};
  double count = 0;
  for (std::int64_t v = 0; v < grid.voxels(); ++v) {
    const auto& set = labels.memberships.sets()[labels.memberships.voxels()[static_cast<std::size_t>(v)]];
    if (std::ranges::find(set, structure) == set.end()) continue;
    const std::int64_t row = v / grid.size[0];
    const Vec3 at =
        to_mm.apply({static_cast<double>(v % grid.size[0]), static_cast<double>(row % grid.size[1]),
                     static_cast<double>(row / grid.size[1])});
    for (std::size_t a = 0; a < 3; ++a) sum[a] += at[a];
    ++count;
  }
  return {sum[0] / count, sum[1] / count, sum[2] / count};
}

inline std::string name_of(const AxisOrder& order) {
  return fmt::format("order {}, reversed {}", fmt::join(order.from, " "), fmt::join(order.flipped, " "));
}

class Sides : public testing::Test {
 protected:
  /// Expects the marks of `body` where they are, within a thousandth of its smallest spacing.
  void expect_sides(const std::filesystem::path& path, const Body& body) const {
    const ImportedLabels labels = value_or_throw(import_labels(path));
    EXPECT_THAT(messages_of(labels.notes), testing::IsEmpty());
    ASSERT_EQ(labels.structures.size(), 3u);
    const double tolerance = 1e-3 * *std::ranges::min_element(body.spacing_mm);
    for (std::uint8_t mark = 1; mark <= 3; ++mark) {
      const Vec3 expected = body.centroid(mark), found = centroid_of(labels, structure_of(labels, mark));
      for (std::size_t a = 0; a < 3; ++a)
        EXPECT_NEAR(found[a], expected[a], tolerance) << "mark " << int{mark} << " axis " << a;
    }
  }

  void expect_sides_of_all_orders(const std::string& name,
                                  const std::function<std::string(const PlacedVolume&)>& write) const {
    for (const AxisOrder& order : all_axis_orders()) {
      for (const Body& body : bodies()) {
        ASSERT_TRUE(write_bytes(folder_.file(name), write(placed(body, order))));
        expect_sides(folder_.file(name), body);
        if (HasFailure()) FAIL() << name_of(order);
      }
    }
  }
  TemporaryFolder folder_;
};

}  // namespace splatlas
