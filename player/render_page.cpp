#include "player/render_page.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "player/files/draw_annotations.h"
#include "player/files/picture_encoder.h"
#include "player/page/annotate_picture.h"
#include "player/page/visible_structures.h"

namespace splatlas {
namespace {

/// Composites a picture over a vertical gradient.
void paint_behind(Picture& picture, Rgb top, Rgb bottom) {
  const auto [width, height] = picture.size;
  for (int y = 0; y < height; ++y) {
    const double share = height > 1 ? static_cast<double>(y) / (height - 1) : 0;
    const Rgb color = mix(top, bottom, share);
    const std::array<float, 3> behind{srgb_to_linear(color.r), srgb_to_linear(color.g),
                                      srgb_to_linear(color.b)};
    float* const row = &picture.rgba[4 * picture.size.pixel(0, y)];
    for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
      float* const pixel = row + 4 * x;
      for (std::size_t c = 0; c < 3; ++c) pixel[c] += (1 - pixel[3]) * behind[c];
      pixel[3] = 1;
    }
  }
}

/// The control of one of two passes, whose progress goes from `from` to `from` + 0.5.
RenderControl half_of(const RenderControl& control, double from) {
  RenderControl half{.stop = control.stop};
  if (control.progress) half.progress = [&control, from](double done) { control.progress(from + done / 2); };
  return half;
}

/// The selection without ghosts and translucent surfaces, which have no outlines.
Selection solids_of(Selection selection) {
  for (StructureDraw& draw : selection.structures) {
    if (!draw.ghost && draw.opacity.value_or(1) >= 1) continue;
    if (draw.mode == DrawMode::kSurface) draw.mode = DrawMode::kOff;
    if (draw.mode == DrawMode::kBoth) draw.mode = DrawMode::kVolume;
  }
  return selection;
}

}  // namespace

struct PageRenderer::Impl {
  Impl(const std::filesystem::path& path, PageOptions page_options)
      : options(std::move(page_options)),
        encoder(path),
        measure([this](std::string_view text, double size, FontStyle style) {
          return (*drawer)->width(text, size, style);
        }),
        keeps_alpha(PictureEncoder::is_linear(path)) {
    if (options.items.any()) drawer.emplace(options.font);
  }

  [[nodiscard]] bool names_structures() const { return options.items.labels || options.items.legend; }

  [[nodiscard]] AnnotationOptions annotation_options(const Provenance& provenance) const {
    return {options.items, options.max_labels, printed_lines(options.caption.value_or(provenance.title)),
            printed_line(provenance.citation), options.dpi};
  }

  /// Structures of a small draft, with areas as in the picture. `decode_ms`: adds the draft's.
  [[nodiscard]] Result<std::vector<NamedStructure>> structures_of_draft(Renderer& renderer,
                                                                        const Camera& camera,
                                                                        double& decode_ms) const {
    constexpr int kLongSide = 320;
    const auto [width, height] = options.render.size;
    const double scale = std::min(1.0, static_cast<double>(kLongSide) / std::max(width, height));
    const auto side = [&](int pixels) { return std::max(1, static_cast<int>(pixels * scale)); };
    RenderOptions draft = options.render;
    draft.size = {side(width), side(height)};
    draft.quality = Quality::kDraft;
    draft.depth_cue = DepthCue::kNone;
    draft.ids = draft.depths = false;
    SPLATLAS_ASSIGN_OR_RETURN(const Camera whole, renderer.fit(camera, draft));
    SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, renderer.render(whole, draft));
    decode_ms += frame.stats.decode_ms;
    std::vector<NamedStructure> structures = named_structures(
        frame.picture, structure_at(frame), renderer.atlas().graph(), renderer.selection(), options.bearers);
    for (NamedStructure& one : structures) one.visible.pixels /= scale * scale;
    return structures;
  }

  /// Region of the picture that leaves room for the annotations around the selection.
  [[nodiscard]] Result<PictureRegion> region_beside_annotations(Renderer& renderer, Camera whole,
                                                                double& decode_ms) {
    const Picture blank{options.render.size, {}};
    whole.zoom = 1;
    whole.center_lps_mm.reset();
    SPLATLAS_ASSIGN_OR_RETURN(const View view,
                              view_of(whole, options.render.size, renderer.atlas().display()));
    AnnotatedScene scene{blank, view};
    if (names_structures()) {
      SPLATLAS_ASSIGN_OR_RETURN(scene.structures, structures_of_draft(renderer, whole, decode_ms));
    }
    SPLATLAS_RETURN_IF_ERROR(drawer->wait());
    return region_of_figure(scene, annotation_options(renderer.atlas().provenance()), measure);
  }

  /// The camera of the page.
  [[nodiscard]] Result<Camera> fit(Renderer& renderer, const Camera& camera, double& decode_ms) {
    if (!options.fits_selection) return camera;
    PictureRegion region;
    if (options.items.any()) {
      SPLATLAS_ASSIGN_OR_RETURN(region, region_beside_annotations(renderer, camera, decode_ms));
    }
    SPLATLAS_ASSIGN_OR_RETURN(Camera fitted, renderer.fit(camera, options.render, std::nullopt, region));
    const double zoom = camera.zoom * fitted.zoom;
    if (!(zoom >= kMinZoom && zoom <= kMaxZoom)) {
      return bad_camera(
          "zoom",
          fmt::format("{}: multiplied by {}, the zoom that fits the selection, it must be from {} to {}",
                      camera.zoom, fitted.zoom, kMinZoom, kMaxZoom));
    }
    fitted.zoom = zoom;
    if (camera.center_lps_mm) fitted.center_lps_mm = camera.center_lps_mm;
    return fitted;
  }

  [[nodiscard]] Result<AnnotationLayer> annotate(const Frame& frame, const Camera& camera,
                                                 const Renderer& renderer) {
    const Atlas& atlas = renderer.atlas();
    SPLATLAS_ASSIGN_OR_RETURN(const View view, view_of(camera, options.render.size, atlas.display()));
    AnnotatedScene scene{frame.picture, view};
    if (!keeps_alpha)
      scene.background = options.background, scene.background_bottom = options.background_bottom;
    if (names_structures())
      scene.structures = named_structures(frame.picture, structure_at(frame), renderer.atlas().graph(),
                                          renderer.selection(), options.bearers);
    SPLATLAS_RETURN_IF_ERROR(drawer->wait());
    const AnnotationOptions content = annotation_options(atlas.provenance());
    SPLATLAS_ASSIGN_OR_RETURN(AnnotationLayer layer, annotate_picture(scene, content, measure));
    if (options.items.caption && content.caption.empty() && !options.caption)
      layer.notes.emplace_back("the atlas has no title; give a caption with --caption TEXT");
    note_missing_glyphs(layer.texts, layer.notes);
    if (names_structures() && scene.structures.empty() && frame.stats.triangles > 0)
      layer.notes.emplace_back(
          "the memory does not suffice to name structures; raise --memory, or take a smaller --size");
    if (options.items.citation && content.citation.empty())
      layer.notes.emplace_back("the atlas has no citation; build it with --citation TEXT");
    return layer;
  }

  /// Paints the background, and returns what to draw over the picture.
  [[nodiscard]] FileAnnotations prepare(Page& page) {
    if (options.background && options.background_bottom && !keeps_alpha)
      paint_behind(page.frame.picture, *options.background, *options.background_bottom);
    if (!options.items.any()) return {nullptr, nullptr, title, options.dpi};
    return {&page.annotations, &*drawer, title, annotation_dpi({.dpi = options.dpi}, options.render.size)};
  }

  /// Notes the first text whose letters no font has.
  void note_missing_glyphs(const std::vector<PlacedText>& texts, std::vector<std::string>& notes) const {
    const auto lacks = [this](const PlacedText& text) { return (*drawer)->lacks_glyphs(text.text); };
    const auto first = std::ranges::find_if(texts, lacks);
    if (first == texts.end()) return;
    const auto others = std::count_if(first + 1, texts.end(), lacks);
    notes.push_back(
        fmt::format("no font has all letters of \"{}\"{}; install one, such as fonts-noto or fonts-noto-cjk, "
                    "or take --font FILE",
                    first->text,
                    others == 0   ? ""
                    : others == 1 ? " and another text"
                                  : fmt::format(" and {} other texts", others)));
  }

  PageOptions options;
  PictureEncoder encoder;
  std::optional<TextDrawer> drawer;  // of annotations
  MeasureText measure;
  bool keeps_alpha;
  std::string title;  // of the document
};

Result<PageRenderer> PageRenderer::create(const std::filesystem::path& path, PageOptions options) {
  SPLATLAS_RETURN_IF_ERROR(PictureEncoder::check_ending(path));
  SPLATLAS_RETURN_IF_ERROR(PictureEncoder::check_size(path, options.render.size, options.background));
  std::error_code error;
  if (!options.font.empty() && !std::filesystem::is_regular_file(options.font, error)) {
    return fail(ErrorCode::kFailed, "{}: {}; give a .ttf or .otf file", options.font.string(),
                error ? error.message() : "is no font file");
  }
  return PageRenderer(std::make_shared<Impl>(path, std::move(options)));
}

void PageRenderer::set_caption(std::string caption) {
  impl_->options.caption = std::move(caption);
}

void PageRenderer::set_framing(const SceneFraming& framing) {
  impl_->options.render.cuts = framing.cuts;
  if (impl_->options.items.labels) impl_->options.bearers = framing.bearers;  // legends list the parts
}

Result<Camera> PageRenderer::fit(Renderer& renderer, const Camera& camera) {
  double decode_ms = 0;
  return impl_->fit(renderer, camera, decode_ms);
}

Result<Page> PageRenderer::render(Renderer& renderer, const Camera& camera, const RenderControl& control,
                                  bool fitted) {
  const PageOptions& options = impl_->options;
  impl_->title = printed_lines(options.caption.value_or(renderer.atlas().provenance().title));
  std::replace(impl_->title.begin(), impl_->title.end(), '\n', ' ');
  double decode_ms = 0;
  Page page;
  page.camera = camera;
  if (!fitted) {
    SPLATLAS_ASSIGN_OR_RETURN(page.camera, impl_->fit(renderer, camera, decode_ms));
  }
  RenderOptions render = options.render;
  RenderControl drawing = control;
  const Selection all = renderer.selection(), solid = options.outlines ? solids_of(all) : all;
  Frame solids;
  if (solid != all) {  // first: names are picked in the latest frame
    render.ids = render.depths = true;
    SPLATLAS_RETURN_IF_ERROR(renderer.select(solid));
    Result<Frame> drawn = renderer.render(page.camera, render, half_of(control, 0));
    SPLATLAS_RETURN_IF_ERROR(renderer.select(all));
    SPLATLAS_ASSIGN_OR_RETURN(solids, std::move(drawn));
    render = options.render;
    drawing = half_of(control, 0.5);
  } else if (options.outlines) {
    render.ids = render.depths = true;
  }
  SPLATLAS_ASSIGN_OR_RETURN(page.frame, renderer.render(page.camera, render, drawing));
  page.frame.stats.decode_ms += decode_ms;
  if (options.outlines) {
    SPLATLAS_ASSIGN_OR_RETURN(const View view,
                              view_of(page.camera, options.render.size, renderer.atlas().display()));
    const double width = annotation_dpi({.dpi = options.dpi}, options.render.size) / 144;  // half a point
    const Frame& lines = solid != all ? solids : page.frame;
    draw_outlines(lines.picture, lines.ids, lines.depths, view.plane.mm_per_pixel, width, page.frame.picture);
  }
  if (!options.items.any()) return page;
  SPLATLAS_ASSIGN_OR_RETURN(page.annotations, impl_->annotate(page.frame, page.camera, renderer));
  return page;
}

Result<std::vector<std::byte>> PageRenderer::encode(Page& page) {
  const FileAnnotations annotations = impl_->prepare(page);
  return impl_->encoder.encode(page.frame.picture, impl_->options.background, annotations);
}

Result<std::vector<std::byte>> PageRenderer::encode_in_document(Page& page, const PageTexts& texts,
                                                                bool is_last) {
  std::optional<TextDrawer>& drawer = impl_->drawer;
  if (!drawer) drawer.emplace(impl_->options.font);
  SPLATLAS_RETURN_IF_ERROR(drawer->wait());
  FileAnnotations annotations = impl_->prepare(page);
  annotations.drawer = &*drawer;
  annotations.texts = {printed_line(texts.heading), printed_lines(texts.question),
                       printed_lines(texts.caption)};
  annotations.is_last = is_last;
  impl_->note_missing_glyphs({{texts.heading}, {texts.question}, {texts.caption}}, page.annotations.notes);
  return PictureEncoder("handout.pdf").encode(page.frame.picture, impl_->options.background, annotations);
}

}  // namespace splatlas
