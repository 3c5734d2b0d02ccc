#include "player/web/page_labels.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "format/result_macros.h"
#include "player/page/annotate_picture.h"
#include "player/page/named_structures.h"

namespace splatlas {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMinDpi = 36, kMaxDpi = 2400;  // from 4 to 280 pixels a letter

/// Sums the widths of letters, by their bytes in UTF-8.
class LetterWidths {
 public:
  explicit LetterWidths(const Json& glyphs) {
    for (const auto& [letter, width] : glyphs.items()) widths_.emplace(letter, width.get<double>());
  }

  double operator()(std::string_view text, double size, FontStyle /*style*/) const {
    constexpr double kUnknown = 0.6;
    double sum = 0;
    for (std::size_t begin = 0; begin < text.size();) {
      std::size_t end = begin + 1;
      while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) ++end;
      const auto found = widths_.find(std::string(text.substr(begin, end - begin)));
      sum += found == widths_.end() ? kUnknown : found->second;
      begin = end;
    }
    return sum * size;
  }

 private:
  std::unordered_map<std::string, double> widths_;
};

Result<std::vector<bool>> labelled_by(const Json& names, const Renderer& renderer) {
  const StructureGraph& graph = renderer.atlas().graph();
  std::vector<bool> labelled(graph.size());
  for (const Json& name : names) {
    SPLATLAS_ASSIGN_OR_RETURN(const auto named, graph.find_named(name.get<std::string>()));
    for (const StructureIndex s : graph.descendants(named)) labelled[s] = true;
  }
  if (!names.empty()) return labelled;
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    const StructureDraw& draw = renderer.selection().structures[s];
    labelled[s] = draw.mode != DrawMode::kSurface || !draw.ghost;
  }
  return labelled;
}

Json json_of(const AnnotationLayer& layer, double label_size) {
  Json json{{"lines", Json::array()}, {"dots", Json::array()}, {"texts", Json::array()}};
  for (const PlacedLine& one : layer.lines)
    json["lines"].push_back({one.from.x, one.from.y, one.to.x, one.to.y, one.width, to_hex(one.color),
                             one.casing, to_hex(one.casing_color)});
  for (const PlacedDot& one : layer.dots)
    json["dots"].push_back(
        {one.center.x, one.center.y, one.radius, to_hex(one.color), one.casing, to_hex(one.casing_color)});
  for (const PlacedText& one : layer.texts) {
    if (one.size < label_size) continue;  // a note about those without a label
    json["texts"].push_back({one.text, one.x, one.y, one.size, to_hex(one.color)});
  }
  return json;
}

}  // namespace

Result<Json> page_labels(const Json& request, const Frame& frame, const Camera& camera,
                         const Renderer& renderer) {
  SPLATLAS_ASSIGN_OR_RETURN(const View view, view_of(camera, frame.picture.size, renderer.atlas().display()));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<bool> labelled,
                            labelled_by(request.value("labels", Json::array()), renderer));
  SPLATLAS_ASSIGN_OR_RETURN(const Rgb background, parse_color(request.at("background").get<std::string>()));
  const AnnotatedScene scene{
      .picture = frame.picture,
      .view = view,
      .background = background,
      .structures = named_structures(frame.picture, structure_at(frame), renderer.atlas().graph(),
                                     renderer.selection(), labelled)};
  AnnotationOptions options;
  options.items.labels = true;
  options.dpi = std::clamp(request.at("dpi").get<double>(), kMinDpi, kMaxDpi);
  SPLATLAS_ASSIGN_OR_RETURN(const AnnotationLayer layer,
                            annotate_picture(scene, options, LetterWidths(request.at("glyphs"))));
  return json_of(layer, 0.99 * kLabelPoints * *options.dpi / 72);
}

}  // namespace splatlas
