#include "preprocess/segment_structures.h"

#include <algorithm>

#include <fmt/format.h>

#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
#include "preprocess/classify/fragments.h"
#include "preprocess/import/tables/structure_name.h"
#include "preprocess/import/tables/text_file.h"

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
    const auto set = [&](std::size_t structure, std::uint64_t below) {
      filter.below_[structure] = below;
      filter.has_rule_[structure] = true;
    };
    for (const FragmentRule& rule : rules) {
      for (std::size_t s = 0; s < count && rule.name.empty(); ++s) set(s, rule.below);
    }
    for (const FragmentRule& rule : rules) {
      bool found = rule.name.empty();
      for (std::size_t s = 0; s < count && !rule.name.empty(); ++s) {
        if (name_key(model.structures[s].name) != name_key(rule.name)) continue;
        set(s, rule.below);
        found = true;
      }
      if (!found) {
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
    append(kept_, find_fragments(memberships, reported));
    if (std::ranges::any_of(dropped, [](std::uint64_t below) { return below > 1; })) {
      append(dropped_, drop_fragments(memberships, dropped));
    }
  }

  void note(const SourceModel& model, std::vector<std::string>& notes) const {
    if (!kept_.empty()) {
      notes.push_back(
          fmt::format("{}; a fragment is a component of fewer than {} voxels beside the largest "
                      "one of its structure, --drop-fragments {} drops them",
                      describe(kept_, model), kReportedBelow, kReportedBelow));
    }
    if (!dropped_.empty()) notes.push_back("dropped " + describe(dropped_, model));
  }

 private:
  static void append(std::vector<StructureFragments>& to, const std::vector<StructureFragments>& from) {
    to.insert(to.end(), from.begin(), from.end());
  }

  std::vector<std::uint64_t> below_;  // [structure]
  std::vector<bool> has_rule_;
  std::vector<StructureFragments> kept_, dropped_;
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

Result<void> segment_structures(SourceModel& model, const Grid& grid, const std::vector<FragmentRule>& rules,
                                const std::function<void(double)>& progress,
                                std::vector<std::string>& notes) {
  SPLATLAS_ASSIGN_OR_RETURN(FragmentFilter fragments, FragmentFilter::make(model, rules));
  // Source numbers are in the order labels or masks, segments, meshes.
  const std::size_t first_segment = model.structures.size() - model.meshes.size() - model.segments.size();
  fragments.apply(model.memberships, 0, first_segment);
  for (std::size_t n = 0; n < model.segments.size(); ++n) {
    auto& [rule, mask] = model.segments[n];
    if (rule.kind != SegmentRule::Kind::kMask) {
      SPLATLAS_ASSIGN_OR_RETURN(mask, segment_volume(model.values, grid, rule));
    }
    const auto sets = model.memberships.voxels();
    for (std::size_t v = 0; v < mask.size(); ++v) mask[v] = mask[v] != 0 && sets[v] == 0;
    if (rule.open_mm > 0) {
      SPLATLAS_ASSIGN_OR_RETURN(mask, open_mask(mask, grid, rule));
    }
    const std::size_t structure = first_segment + n;
    if (model.memberships.add(static_cast<StructureIndex>(structure), mask) == 0) {
      notes.push_back("segment '" + rule.name + "' has no voxel outside the other structures");
    }
    mask = {};
    fragments.apply(model.memberships, structure, structure + 1);
    progress(static_cast<double>(n + 1) / static_cast<double>(model.segments.size()));
  }
  fragments.note(model, notes);
  return {};
}

}  // namespace splatlas
