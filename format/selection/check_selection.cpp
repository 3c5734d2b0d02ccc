// Validity of selections that programs fill in.
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "format/content/selection.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

/// First fault of an appearance; "" for none.
std::string fault_of(const VolumeStyle& style) {
  if (style.profile > TransferProfile::kHard) {
    return fmt::format("profile {} must be soft, thin or hard", static_cast<int>(style.profile));
  }
  if (style.low && !std::isfinite(*style.low)) return fmt::format("low {} must be finite", *style.low);
  if (style.high && !std::isfinite(*style.high)) return fmt::format("high {} must be finite", *style.high);
  if (style.low && style.high && !(*style.low < *style.high)) {
    return fmt::format("low {} must be below high {}", *style.low, *style.high);
  }
  if (!style.curve) return "";
  if (style.low || style.high || style.profile != TransferProfile::kSoft) {
    return "a curve replaces profile, low and high; reset them";
  }
  const Result<void> checked = check_curve(*style.curve);
  return checked ? "" : checked.error().message;
}

std::string fault_of(const StructureDraw& draw) {
  if (draw.mode > DrawMode::kBoth) {
    return fmt::format("mode {} must be off, volume, surface or both", static_cast<int>(draw.mode));
  }
  if (draw.mode == DrawMode::kOff) return "";
  if (draw.opacity && !(*draw.opacity >= 0 && *draw.opacity <= 1)) {
    return fmt::format("opacity {} must be from 0 to 1", *draw.opacity);
  }
  return fault_of(draw.volume);
}

}  // namespace

Result<void> check_selection(const Selection& selection, const StructureGraph& graph) {
  if (selection.structures.size() > graph.size()) {
    return fail(ErrorCode::kUsage,
                fmt::format("selection: {} structures, but the atlas has {}; make it for this atlas",
                            selection.structures.size(), graph.size()));
  }
  for (StructureIndex s = 0; s < selection.structures.size(); ++s) {
    const std::string fault = fault_of(selection.structures[s]);
    if (fault.empty()) continue;
    return fail(ErrorCode::kUsage,
                fmt::format("selection: structure {} ({}): {}", s, in_quotes(graph[s].id), fault));
  }
  return {};
}

}  // namespace splatlas
