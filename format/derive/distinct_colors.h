// Colours that keep structures which touch apart, also for colour-blind eyes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "format/content/class_table.h"
#include "format/content/run_model.h"

namespace splatlas {

/// [structure]: the structures that touch it, ascending. Two structures touch if they share a voxel or a face
/// of two voxels; voxels that an external surface crosses count as its own. `runs`: [class], principal axis
/// z. Throws as check_task() and check_memory(). Cost: O(runs * log(classes)), and pairs that touch.
[[nodiscard]] std::vector<std::vector<StructureIndex>> touching_structures(std::size_t structures,
                                                                           const ClassTable& classes,
                                                                           std::span<const ClassRuns> runs,
                                                                           const Index3& size);

/// Normal sight and the lack of one kind of cones.
enum class Sight : std::uint8_t { kNormal, kProtanopia, kDeuteranopia, kTritanopia };
inline constexpr std::array kSights{Sight::kNormal, Sight::kProtanopia, Sight::kDeuteranopia,
                                    Sight::kTritanopia};

/// Distance of two colours in OKLab (Ottosson 2020), as this sight sees them (Machado et al. 2009, severity
/// 1). Black and white have a distance of 1.
[[nodiscard]] double color_distance(Rgb a, Rgb b, Sight sight);

/// Colours for the structures that have none in `given`; those that are given stay. Greedy: the structure
/// with most neighbours first, ties by index. Each takes the first colour that all sights see clearly apart
/// from its neighbours' colours; without one, the colour farthest from them. With `wished` ([structure], or
/// empty) this is the first of that colour and its shades, those of least change first: lightness by up to
/// 0.345, chroma by half, hue by 20 degrees, in OKLab. Else it is the least used one of a fixed palette.
/// Thread-safe. Cost: linear in structures and neighbours.
[[nodiscard]] std::vector<Rgb> distinct_colors(std::span<const std::vector<StructureIndex>> neighbors,
                                               std::span<const std::optional<Rgb>> given,
                                               std::span<const std::optional<Rgb>> wished = {});

}  // namespace splatlas
