#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "format/content/selection.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/atlas/build_atlas.h"
#include "preprocess/classify/fragments.h"
#include "preprocess/import/tables/text_file.h"
#include "preprocess/surfaces/vtk_surface.h"

namespace splatlas {
namespace {

/// Components of fewer voxels are reported for structures without a rule.
constexpr std::uint64_t kReportedBelow = 100;
constexpr std::size_t kNamedStructures = 3;

/// "612 fragments with 1534 voxels in 41 structures, most in ...".
std::string describe(std::vector<StructureFragments> found, const SourceModel& model) {
  std::ranges::stable_sort(found, std::ranges::greater{}, &StructureFragments::components);
  std::uint64_t components = 0, voxels = 0;
  for (const StructureFragments& one : found) {
    components += one.components;
    voxels += one.voxels;
  }
  std::string text =
      fmt::format("{} fragment{} with {} voxel{} in {} structure{}: ", components, components == 1 ? "" : "s",
                  voxels, voxels == 1 ? "" : "s", found.size(), found.size() == 1 ? "" : "s");
  for (std::size_t n = 0; n < std::min(found.size(), kNamedStructures); ++n) {
    text += fmt::format("{}{} ({} with {})", n > 0 ? ", " : "",
                        in_quotes(model.structures[found[n].structure].name), found[n].components,
                        found[n].voxels);
  }
  return found.size() > kNamedStructures ? text + ", ..." : text;
}

/// Reports and drops fragments by the rules.
class FragmentFilter {
 public:
  static Result<FragmentFilter> make(const SourceModel& model, const std::vector<FragmentRule>& rules) {
    const std::size_t count = model.structures.size() - model.meshes.size();
    FragmentFilter filter;
    filter.below_.assign(count, kReportedBelow);
    filter.has_rule_.assign(count, false);
    for (const bool is_named : {false, true}) {  // a name overrules the rule for all
      for (const FragmentRule& rule : rules) {
        if (rule.name.empty() == is_named) continue;
        bool found = !is_named;
        for (std::size_t s = 0; s < count; ++s) {
          if (is_named && name_key(model.structures[s].name) != name_key(rule.name)) continue;
          filter.below_[s] = rule.below;
          filter.has_rule_[s] = found = true;
        }
        if (found) continue;
        return fail(ErrorCode::kUsage, "--drop-fragments: no label, mask or segment is called {}",
                    in_quotes(rule.name));
      }
    }
    return filter;
  }

  /// Applies the rules to structures `first` to `last` - 1.
  void apply(MembershipVolume& memberships, std::size_t first, std::size_t last) {
    std::vector<std::uint64_t> reported(last), dropped(last);
    for (std::size_t s = first; s < last; ++s) (has_rule_[s] ? dropped : reported)[s] = below_[s];
    std::ranges::move(find_fragments(memberships, reported), std::back_inserter(kept_));
    if (std::ranges::any_of(dropped, [](std::uint64_t below) { return below > 1; }))
      std::ranges::move(drop_fragments(memberships, dropped), std::back_inserter(dropped_));
  }

  void note(const SourceModel& model, Notes& notes) const {
    if (!kept_.empty()) {
      notes.add("fragments",
                fmt::format("{}; a fragment is a component of fewer than {} voxels beside the largest "
                            "one of its structure, --drop-fragments {} drops them",
                            describe(kept_, model), kReportedBelow, kReportedBelow));
    }
    if (!dropped_.empty()) notes.add("dropped-fragments", "dropped " + describe(dropped_, model));
  }

 private:
  std::vector<std::uint64_t> below_;  // [structure]
  std::vector<bool> has_rule_;
  std::vector<StructureFragments> kept_, dropped_;
};

/// Finds the voxels of single segments.
class Segmenter {
 public:
  Segmenter(SourceModel& model, const PlacedStructures& placed, const Grid& grid)
      : model_(model), placed_(placed), grid_(grid) {}

  /// Source numbers are in the order labels or masks, segments, meshes.
  [[nodiscard]] std::size_t first_source() const {
    return model_.structures.size() - model_.meshes.size() - model_.segments.size();
  }

  /// The mask of segment n. Consumes the mask from its file.
  [[nodiscard]] Result<std::vector<std::uint8_t>> voxels_of(std::size_t n, Notes& notes) const {
    auto& [rule, mask] = model_.segments[n];
    if (rule.kind == SegmentRule::Kind::kIsosurface) return isosurface(rule, n);
    const bool is_mask = rule.kind == SegmentRule::Kind::kMask;
    if (!is_mask) mask = voxels_between(model_.values, rule);
    SPLATLAS_RETURN_IF_ERROR(keep_within(rule, n, mask));
    if (!is_mask) {
      const auto before = std::ranges::count(mask, 1);
      SPLATLAS_RETURN_IF_ERROR(refine_segment(mask, grid_, rule));
      SPLATLAS_RETURN_IF_ERROR(keep_within(rule, n, mask));  // again: holes may lie outside
      if (const auto after = std::ranges::count(mask, 1); 3 * after > 4 * before)
        notes.add("filled-segments", fmt::format("{} ({} of {} voxels; :fill=no keeps holes)", rule.name,
                                                 after - before, after));
    }
    std::vector<bool> excludes(placed_.index_of_source.size(), true);  // [source]
    for (std::size_t other = 0; other < model_.segments.size(); ++other) {
      if (model_.segments[other].rule.kind == SegmentRule::Kind::kIsosurface)
        excludes[first_source() + other] = false;
    }
    if (!rule.overlaps) keep_voxels(mask, excludes, false);
    if (is_mask) SPLATLAS_RETURN_IF_ERROR(refine_segment(mask, grid_, rule));
    return std::exchange(mask, {});
  }

 private:
  /// Clears voxels outside all `sources` (`kept`), or inside any of them.
  void keep_voxels(std::vector<std::uint8_t>& mask, const std::vector<bool>& sources, bool kept) const {
    std::vector<bool> keeps;  // [set]
    for (const auto& set : model_.memberships.sets()) {
      keeps.push_back(std::ranges::any_of(set, [&](StructureIndex s) { return sources[s]; }) == kept);
    }
    const auto sets = model_.memberships.voxels();
    for (std::size_t v = 0; v < mask.size(); ++v) mask[v] = mask[v] != 0 && keeps[sets[v]];
  }

  /// Clears voxels outside the structure that encloses segment n.
  [[nodiscard]] Result<void> keep_within(const SegmentRule& rule, std::size_t n,
                                         std::vector<std::uint8_t>& mask) const {
    if (rule.within.empty()) return {};
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<bool> enclosing, enclosing_sources(rule, n));
    keep_voxels(mask, enclosing, true);
    return {};
  }

  [[nodiscard]] Result<std::vector<std::uint8_t>> isosurface(const SegmentRule& rule, std::size_t n) const {
    if (std::ranges::max(grid_.size) > kMaxIsosurfaceSize) {
      return fail(ErrorCode::kLimit,
                  "--segment \"{}\": an isosurface needs a grid of at most {} voxels along each axis; crop "
                  "the volume",
                  rule.name, kMaxIsosurfaceSize);
    }
    std::vector<std::uint8_t> mask = voxels_from(model_.values, rule.low);
    SPLATLAS_RETURN_IF_ERROR(keep_within(rule, n, mask));
    if (std::ranges::find(mask, 1) == mask.end()) {
      return fail(ErrorCode::kFailed, "--segment \"{}\": no voxel {} has a value of {} or above", rule.name,
                  rule.within.empty() ? "of the volume" : "in " + in_quotes(rule.within), rule.low);
    }
    return mask;
  }

  /// [source]: true for labels, masks and earlier segments in the enclosing structure.
  [[nodiscard]] Result<std::vector<bool>> enclosing_sources(const SegmentRule& rule, std::size_t n) const {
    const Result<std::vector<StructureIndex>> found = placed_.graph.find(rule.within);
    if (!found)
      return fail(found.error().code, "--segment \"{}\": within={}", rule.name, found.error().message);
    const std::vector<StructureIndex> inside = placed_.graph.descendants(*found);
    std::vector<bool> sources(placed_.index_of_source.size(), false);
    bool any = false;
    for (std::size_t s = 0; s < first_source() + n; ++s) {
      sources[s] = std::ranges::find(inside, placed_.index_of_source[s]) != inside.end();
      any = any || sources[s];
    }
    if (!any) {
      return fail(
          ErrorCode::kUsage,
          "--segment \"{}\": within={} must be a label, a mask, an earlier segment or a group of them",
          rule.name, in_quotes(rule.within));
    }
    return sources;
  }

  SourceModel& model_;
  const PlacedStructures& placed_;
  const Grid& grid_;
};

}  // namespace

Result<FragmentRule> parse_fragments(std::string_view text) {
  const std::size_t equals = text.rfind('=');
  const bool named = equals != std::string_view::npos;
  FragmentRule rule;
  if (named) rule.name = std::string(trimmed(text.substr(0, equals)));
  const auto below = parse_integer(trimmed(named ? text.substr(equals + 1) : text));
  if (!below || *below < 0 || *below > kMaxVoxels || (named && rule.name.empty())) {
    return fail(ErrorCode::kUsage, "--drop-fragments {}: must be N or NAME=N, with N voxels from 0 to {}",
                in_quotes(text), kMaxVoxels);
  }
  rule.below = static_cast<std::uint64_t>(*below);
  return rule;
}

Result<void> segment_structures(SourceModel& model, const PlacedStructures& placed, const Grid& grid,
                                const std::vector<FragmentRule>& rules,
                                const std::function<void(double)>& progress, Notes& notes) {
  SPLATLAS_ASSIGN_OR_RETURN(FragmentFilter fragments, FragmentFilter::make(model, rules));
  const Segmenter segmenter(model, placed, grid);
  const std::size_t first_segment = segmenter.first_source();
  fragments.apply(model.memberships, 0, first_segment);
  for (std::size_t n = 0; n < model.segments.size(); ++n) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::uint8_t> mask, segmenter.voxels_of(n, notes));
    const std::size_t structure = first_segment + n;
    if (model.memberships.add(static_cast<StructureIndex>(structure), mask) == 0) {
      notes.add("segments-without-voxels", model.segments[n].rule.name);
    }
    fragments.apply(model.memberships, structure, structure + 1);
    progress(static_cast<double>(n + 1) / static_cast<double>(model.segments.size()));
  }
  fragments.note(model, notes);
  return {};
}

}  // namespace splatlas
