#include "preprocess/check/examine_atlas.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/classify/segment_volume.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// Kind, phrase and remedy, a line each.
constexpr std::string_view kFindings =
#include "preprocess/check/findings.txt"
    ;
constexpr std::string_view kHeadWords[] = {
#include "preprocess/check/head_words.txt"
};

class Examiner {
 public:
  Examiner(const Atlas& atlas, const AtlasMeasures& measures)
      : atlas_(atlas), graph_(atlas.graph()), measures_(measures) {
    for (const Structure& structure : graph_.structures()) sides_.push_back(sided_name(structure.name));
  }

  Examination examine(std::optional<Index3> nose) {
    check_each();
    check_same_keys();
    check_pairs();
    check_sides();
    if (nose) add("faces", 1, {}, nose);
    std::ranges::stable_sort(found_.findings, {},
                             [&](const Finding& f) { return kFindings.find(f.kind + " |"); });
    fill_rows();
    return std::move(found_);
  }

 private:
  [[nodiscard]] const StructureMeasures::Sums& sums(StructureIndex s) const {
    return measures_.structures[s].sums;
  }
  [[nodiscard]] Index3 middle_of(StructureIndex s) const {
    Index3 at{};
    for (std::size_t a = 0; a < 3; ++a)
      at[a] = std::llround(sums(s).index[a] / static_cast<double>(sums(s).voxels));
    return at;
  }
  [[nodiscard]] Index3 voxel_at(std::size_t offset) const {
    const auto at = static_cast<std::int64_t>(offset);
    const Index3& size = atlas_.grid().size;
    return {at % size[0], at / size[0] % size[1], at / (size[0] * size[1])};
  }

  /// Without a place: the middle of the first structure with voxels.
  void add(std::string_view kind, std::size_t count, const std::vector<StructureIndex>& structures,
           std::optional<Index3> place = {}) {
    Finding finding{std::string(kind), count, {}, {}, {}};
    for (const std::string_view line : split(kFindings, '\n')) {
      const std::vector<std::string_view> parts = split(line, '|');
      if (parts[0] != kind) continue;
      finding.message = fmt::format(fmt::runtime(parts[1]), count);
      finding.remedy = parts[2];
    }
    std::vector<std::string> names;
    for (const StructureIndex s : structures) {
      finding.structures.push_back(graph_[s].id);
      if (names.size() < 3) names.push_back(in_quotes(graph_[s].name));
      if (!place && sums(s).voxels > 0) place = middle_of(s);
    }
    if (!names.empty()) {
      finding.message = fmt::format("{}{}: {}", fmt::join(names, ", "), structures.size() > 3 ? " ..." : "",
                                    finding.message);
    }
    if (place) {
      finding.place_lps_mm = index_to_lps_mm(atlas_.grid())
                                 .apply({static_cast<double>((*place)[0]), static_cast<double>((*place)[1]),
                                         static_cast<double>((*place)[2])});
      finding.cell = cell_of(*place, atlas_.grid());
    }
    found_.findings.push_back(std::move(finding));
  }

  void check_each() {
    const bool has_groups =
        std::ranges::any_of(graph_.structures(), [](const Structure& s) { return !s.parents.empty(); });
    for (StructureIndex s = 0; s < graph_.size(); ++s) {
      const Structure& structure = graph_[s];
      const StructureMeasures& measures = measures_.structures[s];
      const std::size_t children = graph_.children(s).size();
      const bool is_empty = measures.pieces == 0 && atlas_.triangles(s) == 0;
      if (structure.label && structure.name == fmt::format("Label {}", *structure.label))
        add("unnamed-labels", 1, {s});
      if (is_empty && children == 0)
        add(structure.label || structure.external ? "empty-structures" : "empty-groups", 1, {s});
      if (is_empty && children == 1) add("single-members", 1, {s});
      if (has_groups && structure.label && children == 0 && structure.parents.empty())
        add("outside-tree", 1, {s});
      const auto add_parts = [&](std::string_view kind, const SmallParts& parts) {
        if (parts.count > 0) add(kind, parts.count, {s}, voxel_at(parts.voxel));
      };
      add_parts("stray-pieces", measures.stray_pieces);
      add_parts("holes", measures.small_holes);
    }
  }

  [[nodiscard]] bool are_partners(StructureIndex a, StructureIndex b) const {
    return sides_[a].side != 0 && sides_[b].side != 0 && sides_[a].side != sides_[b].side &&
           sides_[a].rest == sides_[b].rest;
  }

  /// Names and labels that members of one group share, and codes.
  void check_same_keys() {
    std::map<std::tuple<std::string_view, std::string, std::string>, std::vector<StructureIndex>> same;
    for (StructureIndex s = 0; s < graph_.size(); ++s) {
      const Structure& structure = graph_[s];
      std::vector<StructureIndex> parents = structure.parents;
      if (parents.empty()) parents.push_back(kNoStructure);
      for (const StructureIndex parent : parents) {
        same[{"equal-names", std::to_string(parent), to_lower(structure.name)}].push_back(s);
        if (structure.label)
          same[{"labels-twice", std::to_string(parent), std::to_string(*structure.label)}].push_back(s);
      }
      for (const Term& term : structure.terms) {
        const bool is_code = term.vocabulary.size() > 3 && term.vocabulary != "synonym" &&
                             std::ranges::any_of(term.value, [](char c) { return c >= '0' && c <= '9'; });
        if (is_code) same[{"codes-twice", term.vocabulary, term.value}].push_back(s);
      }
    }
    std::set<std::pair<std::string_view, std::vector<StructureIndex>>> told;  // with several parents, once
    for (const auto& [key, structures] : same) {
      const auto& kind = std::get<0>(key);
      const bool is_pair = structures.size() == 2 && are_partners(structures[0], structures[1]);
      if (structures.size() > 1 && !(kind == "codes-twice" && is_pair) &&
          told.emplace(kind, structures).second)
        add(kind, structures.size(), structures);
    }
  }

  [[nodiscard]] bool is_above(StructureIndex a, StructureIndex b) const {
    return std::ranges::count(graph_.descendants(a), b) > 0;
  }

  void check_pairs() {
    for (const auto& [surface, middle] : measures_.apart) add("meshes-apart", 1, {surface}, middle);
    for (const auto& [pair, touching] : measures_.touching) {
      if (!are_partners(pair.first, pair.second))
        add("equal-colors", 2, {pair.first, pair.second}, voxel_at(touching.second));
    }
    for (const auto& [pair, shared] : measures_.shared) {
      const auto [a, b] = pair;
      const bool is_partial = 2 * shared.first < std::min(sums(a).voxels, sums(b).voxels);
      if (is_partial && !is_above(a, b) && !is_above(b, a))
        add("overlaps", shared.first, {a, b}, voxel_at(shared.second));
    }
  }

  /// Of pairs, "left" lies left of "right". Others lie not as a whole beyond the middle of the pairs.
  void check_sides() {
    std::map<std::string, std::array<std::vector<StructureIndex>, 2>> pairs;
    for (StructureIndex s = 0; s < graph_.size(); ++s) {
      if (sides_[s].side != 0 && measures_.structures[s].pieces > 0)
        pairs[sides_[s].rest][sides_[s].side == 'l' ? 0 : 1].push_back(s);
    }
    const auto column = [&](StructureIndex s) {
      return sums(s).index[0] / static_cast<double>(sums(s).voxels);
    };
    std::vector<double> middles;
    for (const auto& [rest, sides] : pairs) {
      if (sides[0].size() != 1 || sides[1].size() != 1) continue;
      const double left = column(sides[0][0]), right = column(sides[1][0]);
      middles.push_back((left + right) / 2);
      if (left < right - 1) add("wrong-side", 2, {sides[0][0], sides[1][0]});
    }
    if (middles.empty()) return;
    const auto [low, high] = std::ranges::minmax(middles);
    const double margin = 0.05 * static_cast<double>(measures_.all.box.last[0] - measures_.all.box.first[0]);
    for (const auto& [rest, sides] : pairs) {
      if (sides[0].size() == 1 && sides[1].size() == 1) continue;
      for (const StructureIndex s : sides[0])
        if (static_cast<double>(sums(s).box.last[0]) < low - margin) add("wrong-side", 1, {s});
      for (const StructureIndex s : sides[1])
        if (static_cast<double>(sums(s).box.first[0]) > high + margin) add("wrong-side", 1, {s});
    }
  }

  void fill_rows() {
    found_.shape = measures_.all.shape;
    for (StructureIndex s = 0; s < graph_.size(); ++s) {
      const StructureMeasures& measures = measures_.structures[s];
      StructureRow row{graph_[s], measures.pieces == 0 && !graph_.children(s).empty(), measures};
      row.ml = static_cast<double>(sums(s).voxels) * voxel_volume_mm3(atlas_.grid()) / 1000;
      if (sums(s).voxels > 0) row.box_lps_mm = box_lps_mm(atlas_.grid(), sums(s).box.first, sums(s).box.last);
      found_.rows.push_back(std::move(row));
    }
  }

  const Atlas& atlas_;
  const StructureGraph& graph_;
  const AtlasMeasures& measures_;
  std::vector<SidedName> sides_;  // [structure]
  Examination found_;
};

bool tells_of_a_head(const StructureGraph& graph) {
  const std::vector<std::string_view> heads = split(kHeadWords[0], ' '), others = split(kHeadWords[1], ' ');
  return std::ranges::any_of(graph.structures(), [&](const Structure& structure) {
    auto words = words_of(structure.name);
    const auto has = [&](const auto& list) {
      return std::ranges::any_of(words, [&](const auto& word) { return std::ranges::count(list, word) > 0; });
    };
    if (has(others)) std::erase(words, "head");
    return has(heads);
  });
}

/// The nose of a head, of the grey values if there are any.
Result<std::optional<Index3>> nose_of(const Atlas& atlas, std::span<const ClassId> class_volume) {
  if (!tells_of_a_head(atlas.graph())) return std::nullopt;
  const Grid& grid = atlas.grid();
  std::vector<std::uint8_t> mask;
  if (atlas.value_type() == VoxelType::kNone) {
    for (const ClassId c : class_volume)
      mask.push_back(std::ranges::any_of(atlas.classes().members(c), &Membership::holds) ? 1 : 0);
    return find_nose(mask, grid);
  }
  SPLATLAS_ASSIGN_OR_RETURN(const VoxelBuffer values, atlas.read_value_volume(class_volume));
  SegmentRule rule;
  rule.kind = SegmentRule::Kind::kOtsu;
  rule.fills = false;
  mask = voxels_between(values, rule);
  if (!refine_segment(mask, grid, rule)) return std::nullopt;
  return find_nose(mask, grid);
}

}  // namespace

std::optional<Index3> find_nose(std::span<const std::uint8_t> mask, const Grid& grid) {
  constexpr double kSideMm = 25, kRiseMm = 12, kHeightMm = 10, kMinWidthMm = 90, kMaxWidthMm = 230;
  const std::int64_t width = grid.size[0], depth = grid.size[1];
  const auto side = static_cast<std::int64_t>(std::ceil(kSideMm / grid.spacing_mm[0]));
  const double rise = kRiseMm / grid.spacing_mm[1];
  std::vector<Index3> tips;  // one a slice, upwards
  const auto is_nose = [&] { return static_cast<double>(tips.size()) * grid.spacing_mm[2] >= kHeightMm; };
  for (std::int64_t k = 0; k < grid.size[2]; ++k) {
    std::vector<std::int64_t> fronts(static_cast<std::size_t>(width), depth);
    std::int64_t first = width, last = -1;
    for (std::int64_t i = 0; i < width; ++i) {
      std::int64_t& front = fronts[static_cast<std::size_t>(i)];
      for (front = 0; front < depth && mask[static_cast<std::size_t>(grid.offset(i, front, k))] == 0;)
        ++front;
      if (front < depth) first = std::min(first, i), last = i;
    }
    const std::int64_t i = std::ranges::min_element(fronts) - fronts.begin();
    const double width_mm = static_cast<double>(last - first + 1) * grid.spacing_mm[0];
    const auto falls = [&](std::int64_t beside) {
      if (beside < 0 || beside >= width || fronts[static_cast<std::size_t>(beside)] == depth) return false;
      const std::int64_t fall =
          fronts[static_cast<std::size_t>(beside)] - fronts[static_cast<std::size_t>(i)];
      return static_cast<double>(fall) >= rise;
    };
    if (width_mm < kMinWidthMm || width_mm > kMaxWidthMm || !falls(i - side) || !falls(i + side)) {
      if (is_nose()) break;
      tips.clear();
    } else {
      tips.push_back({i, fronts[static_cast<std::size_t>(i)], k});
    }
  }
  return is_nose() ? std::optional(tips[tips.size() / 2]) : std::nullopt;
}

Result<Examination> examine_atlas(const Atlas& atlas) {
  SPLATLAS_ASSIGN_OR_RETURN(AtlasContent content, atlas.read_classes());
  SPLATLAS_ASSIGN_OR_RETURN(const std::optional<Index3> nose, nose_of(atlas, content.class_volume));
  const AtlasMeasures measures = measure_structures(atlas, std::move(content.class_volume));
  return Examiner(atlas, measures).examine(nose);
}

}  // namespace splatlas
