// Measurements of the paper (section 4, tables 1 to 4), corrected where its own numbers reveal slips.
#pragma once

#include <array>
#include <cstdint>

namespace splatlas::paper {

/// A region of table 1 or 3.
struct Region {
  const char* name;       ///< name in the paper
  const char* structure;  ///< id or name of our structure
  std::uint64_t interior, boundary, triangles;
};

/// A row of table 2 or 4.
struct Traversal {
  const char* figure;
  std::uint64_t volume, surface, hybrid;  ///< k_vol, k_sur, k_hyb
  double cost_ratio;
};

/// Occupancy by the counts of the row.
[[nodiscard]] constexpr double occupancy(const Traversal& row, std::uint64_t voxels) {
  return static_cast<double>(row.volume + row.surface + row.hybrid) / static_cast<double>(voxels);
}

inline constexpr std::uint64_t kPhantomVoxels = std::uint64_t{32} * 32 * 32;
inline constexpr std::uint64_t kPhantomEmpty = 27722;
inline constexpr std::array<Region, 2> kTable1{{
    {"Sphere 1", "Sphere 1", 2705, 1440, 3704},
    {"Sphere 2", "Sphere 2", 437, 464, 1352},
}};
/// Rows 3 and 4 are printed with the two subtrees exchanged.
inline constexpr std::array<Traversal, 4> kTable2{{
    {"4a", 0, 1904, 0, 0.283},
    {"4b", 5046, 0, 0, 0.359},
    {"4c", 437, 1440, 464, 0.325},
    {"4d", 4145, 464, 0, 0.362},
}};

inline constexpr std::uint64_t kHeadVoxels = std::uint64_t{190} * 220 * 178;
/// AAL divides the cortex; the remainder of the brain ("Rest of brain", both sides) stands for white matter.
inline constexpr std::array<Region, 8> kTable3{{
    {"Right cerebral cortex", "Right cerebrum", 511036, 77792, 382609},
    {"Right cerebral white matter", "Rest of brain", 165956, 103513, 256691},
    {"Right caudate", "Caudate_R", 1462, 2693, 7056},
    {"Right cerebellum cortex", "Right cerebellum", 60600, 16410, 52430},
    {"Left cerebral cortex", "Left cerebrum", 509588, 83890, 388824},
    {"Left caudate", "Caudate_L", 1588, 2576, 6609},
    {"Left cerebellum cortex", "Left cerebellum", 60484, 16664, 53871},
    {"Non-brain head region", "Non-brain head", 4423855, 464540, 958439},
}};
/// Rows 5a and 6a include their surface voxels (16664 and 166951, by table 3) in the volume voxels.
inline constexpr std::array<Traversal, 6> kTable4{{
    {"5a", 862461, 16664, 0, 0.294},
    {"5b", 0, 166951, 0, 0.194},
    {"6a", 165956, 166951, 103513, 0.291},
    {"6b", 1020624, 106301, 161682, 0.469},
    {"7a", 1235910, 0, 100554, 0.447},
    {"7b", 4936479, 83890, 0, 0.867},
}};

}  // namespace splatlas::paper
