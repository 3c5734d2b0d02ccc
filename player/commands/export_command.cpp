#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <webp/encode.h>

#include "format/atlas_reader.h"
#include "format/io/input_file.h"
#include "format/io/output_file.h"
#include "format/program/command_options.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "format/text/ascii_text.h"
#include "player/camera_moves.h"
#include "player/commands/commands.h"
#include "player/renderer.h"
#include "player/web/html_page.h"

namespace splatlas {
namespace {

constexpr const char* kExportFooter =
#include "player/commands/export_help.txt"
    ;

/// Of the opening picture. The page fits it into its own picture, where the same camera shows the same.
constexpr PictureSize kOpeningSize{800, 800};
/// A page of base64, and the module with the atlas in its memory of 2 GiB, twice.
constexpr std::uint64_t kMaxAtlasBytes = std::uint64_t{256} << 20;

/// Memory limit of the module (default_memory_limit() in player/web/web_system.cpp).
constexpr std::uint64_t kModuleMemory = std::uint64_t{1} << 30;

Result<std::vector<std::byte>> read_atlas(const std::filesystem::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const InputFile file, InputFile::open(path));
  if (file.size() > kMaxAtlasBytes) {
    return fail(ErrorCode::kLimit,
                "{}: {} bytes; a page holds at most {}: make an atlas with fewer structures or larger voxels",
                path.string(), file.size(), kMaxAtlasBytes);
  }
  std::vector<std::byte> bytes(file.size());
  SPLATLAS_RETURN_IF_ERROR(file.read(0, bytes));
  return bytes;
}

/// As WebP, a tenth of a PNG, with a transparent background.
Result<std::vector<std::byte>> encode_webp(const Picture& picture) {
  constexpr float kQuality = 90;
  const std::vector<std::uint8_t> pixels = to_srgba8(picture);
  const auto [width, height] = picture.size;
  std::uint8_t* encoded = nullptr;
  const std::size_t size = WebPEncodeRGBA(pixels.data(), width, height, 4 * width, kQuality, &encoded);
  const std::unique_ptr<std::uint8_t, decltype(&WebPFree)> owner(encoded, &WebPFree);
  if (size == 0) return fail(ErrorCode::kLimit, "the opening picture does not fit into memory");
  const auto* const bytes = reinterpret_cast<const std::byte*>(encoded);
  return std::vector(bytes, bytes + size);
}

/// Fits the camera and draws the picture.
Result<std::vector<std::byte>> draw(const std::shared_ptr<const Atlas>& atlas, Opening& opening) {
  const Result<Selection> selection = [&] {
    const TaskControl task({}, {}, &atlas->work_budget());
    return Selection::parse(opening.select, atlas->graph());
  }();
  if (!selection)
    return tl::unexpected(
        in_selection(selection.error(), *atlas, opening.scene ? atlas->scenes()[*opening.scene].name : ""));
  Renderer renderer(atlas, {.max_memory_bytes = kModuleMemory});
  SPLATLAS_RETURN_IF_ERROR(renderer.select(*selection));
  const RenderOptions options{
      .size = kOpeningSize, .depth_cue = DepthCue::kEdges, .cuts = opening.framing.cuts};
  SPLATLAS_ASSIGN_OR_RETURN(opening.camera, renderer.fit(opening.camera, options));
  opening.camera = zoomed(opening.camera, opening.zoom);
  if (opening.framing.center_lps_mm) opening.camera.center_lps_mm = opening.framing.center_lps_mm;
  opening.is_fitted = true;
  SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, renderer.render(opening.camera, options));
  return encode_webp(frame.picture);
}

/// The page of an intact atlas, without the atlas itself. Opens surfaces where volumes take too much memory.
Result<HtmlPage> draw_page(const ExportRequest& request, const std::shared_ptr<const Atlas>& atlas) {
  SPLATLAS_RETURN_IF_ERROR(atlas->verify());
  SPLATLAS_ASSIGN_OR_RETURN(Opening opening, opening_of(request.opening, *atlas));
  Result<std::vector<std::byte>> drawn = draw(atlas, opening);
  const bool is_too_large = !drawn && drawn.error().code == ErrorCode::kLimit;
  if (is_too_large && request.opening.select.empty() && !opening.scene) {
    opening.select = "*:surface";
    drawn = draw(atlas, opening);
  }
  if (!drawn) return tl::unexpected(std::move(drawn).error());
  return HtmlPage{.title = atlas->provenance().title,
                  .caption = opening.caption,
                  .opening = json_of(opening),
                  .picture = *std::move(drawn)};
}

Result<void> write_page(const ExportRequest& request) {
  const std::filesystem::path& path = request.atlases.front();
  SPLATLAS_RETURN_IF_ERROR(check_outputs(std::vector{request.html}, request.atlases));
  SPLATLAS_RETURN_IF_ERROR(check_writable_file(request.html));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> bytes, read_atlas(path));
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open_bytes(bytes, path.string()));
  SPLATLAS_ASSIGN_OR_RETURN(HtmlPage page, draw_page(request, atlas));
  page.atlas = bytes;
  SPLATLAS_ASSIGN_OR_RETURN(const std::string html, encode_html(page));
  return write_file(request.html, std::as_bytes(std::span(html)));
}

Result<void> copy(const std::filesystem::path& path, OutputFile& file) {
  constexpr std::uint64_t kPieceBytes = std::uint64_t{1} << 20;
  SPLATLAS_ASSIGN_OR_RETURN(const InputFile from, InputFile::open(path));
  std::vector<std::byte> piece;
  for (std::uint64_t offset = 0; offset < from.size(); offset += piece.size()) {
    piece.resize(std::min(kPieceBytes, from.size() - offset));
    SPLATLAS_RETURN_IF_ERROR(from.read(offset, piece));
    SPLATLAS_RETURN_IF_ERROR(file.write(piece));
  }
  return {};
}

/// Names of the files of the atlases in the site, without endings.
Result<std::vector<std::string>> site_names(const std::vector<std::filesystem::path>& atlases) {
  std::vector<std::string> names;
  for (const std::filesystem::path& atlas : atlases) {
    const std::string name = atlas.stem().string();
    const auto same = [&](const std::string& other) { return equal_ignoring_case(other, name); };
    if (std::ranges::any_of(names, same) || (atlases.size() > 1 && equal_ignoring_case(name, "index")))
      return fail(ErrorCode::kUsage, "{}: the name {} is taken in the site; rename the file", atlas.string(),
                  in_quotes(name));
    names.push_back(name);
  }
  return names;
}

/// Draws all pages before it writes the first.
Result<void> write_site(const ExportRequest& request) {
  SPLATLAS_RETURN_IF_ERROR(check_writable_folder(request.site));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::string> names, site_names(request.atlases));
  const bool is_catalogue = names.size() > 1;
  std::vector<std::string> pages;
  std::vector<CatalogueEntry> entries;
  for (std::size_t n = 0; n < names.size(); ++n) {
    SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(request.atlases[n]));
    SPLATLAS_ASSIGN_OR_RETURN(HtmlPage page, draw_page(request, atlas));
    page.url = percent_encoded(names[n] + ".atlas");
    SPLATLAS_ASSIGN_OR_RETURN(std::string html, encode_html(page));
    pages.push_back(std::move(html));
    entries.push_back({.title = page.title.empty() ? names[n] : page.title,
                       .text = fmt::format("{} structures, {:.1f} MB", atlas->graph().size(),
                                           static_cast<double>(atlas->counters().file) / 1e6),
                       .url = percent_encoded(names[n] + ".html"),
                       .picture = std::move(page.picture)});
  }

  const auto text = [](const std::string& bytes) {
    return [&bytes](OutputFile& file) { return file.write(std::as_bytes(std::span(bytes))); };
  };
  SPLATLAS_ASSIGN_OR_RETURN(OutputFolder folder, OutputFolder::create(request.site));
  for (std::size_t n = 0; n < names.size(); ++n) {
    const std::string page = is_catalogue ? names[n] + ".html" : "index.html";
    SPLATLAS_RETURN_IF_ERROR(folder.add(page, text(pages[n])));
    SPLATLAS_RETURN_IF_ERROR(
        folder.add(names[n] + ".atlas", [&](OutputFile& file) { return copy(request.atlases[n], file); }));
  }
  if (is_catalogue) SPLATLAS_RETURN_IF_ERROR(folder.add("index.html", text(encode_catalogue(entries))));
  return folder.commit();
}

}  // namespace

CLI::App* add_export(CLI::App& app, ExportRequest& request) {
  CLI::App* command = app.add_subcommand("export", "Write pages that play atlases in browsers");
  add_path(*command, "ATLAS", request.atlases, "atlas file; --site takes several")->required();
  constexpr auto file = non_empty<std::filesystem::path>;
  constexpr auto given = non_empty<std::string>;
  CLI::Option* html =
      add_parsed(*command, "--html", request.html, file, "must name a file", "page to write: one HTML file");
  add_parsed(*command, "--site", request.site, file, "must name a folder",
             "folder to write, for a web server; must not exist, or be empty")
      ->excludes(html);
  CLI::Option* select =
      add_parsed(*command, "--select", request.opening.select, given, "must be a selection text",
                 "selection of the opening picture: see splatlas-player render --help");
  add_view(*command, request.opening.camera, "direction of the opening picture")
      ->each([&request](const std::string&) { request.opening.names_view = true; });
  add_parsed(*command, "--scene", request.opening.scene, given, "must name a scene",
             "scene of the opening picture")
      ->excludes(select);
  command->parse_complete_callback([&request, command] {
    if (request.html.empty() && request.site.empty())
      throw CLI::ValidationError("export", "needs --html OUT.html or --site FOLDER");
    if (request.atlases.size() == 1 || command->remaining_size() > 0) return;  // these are told next
    for (const char* option : {"--html", "--select", "--scene", "--view"}) {
      if (command->get_option(option)->count() > 0)
        throw CLI::ValidationError(option, "goes with one atlas; leave it out, or name one");
    }
  });
  command->footer(kExportFooter);
  return command;
}

Result<void> run_export(const ExportRequest& request) {
  SPLATLAS_RETURN_IF_ERROR(check_web_module());
  return request.site.empty() ? write_page(request) : write_site(request);
}

}  // namespace splatlas
