// The player as C functions, for a page's script: splatlas.js calls them. Tests call them natively, too.
//
// A module holds one atlas with one selection, camera and picture. Functions that may fail return 0, or 1 +
// ErrorCode with the message as text. Answers of several values are JSON, as text, too. A text, a picture and
// the input are valid until the next call. Not thread-safe.
#pragma once

#include <cstdint>

#ifdef __wasm__
#define SPLATLAS_WEB(name) extern "C" __attribute__((export_name(#name), used))
#else
#define SPLATLAS_WEB(name) extern "C"
#endif

/// Makes room for the input of the next call: the bytes of an atlas, or a text in UTF-8. Null when out of
/// memory.
SPLATLAS_WEB(splatlas_input) std::uint8_t* splatlas_input(std::uint32_t bytes);
/// The latest message or JSON document, in UTF-8, and its bytes.
SPLATLAS_WEB(splatlas_text) const char* splatlas_text();
SPLATLAS_WEB(splatlas_text_bytes) std::uint32_t splatlas_text_bytes();

/// Opens the atlas in the input, in place of the one before. Nothing is selected.
SPLATLAS_WEB(splatlas_open) int splatlas_open();
/// Opens an atlas of this many bytes on a server, in place of the one before. Fails until splatlas_give() has
/// brought what splatlas_wanted() names. Nothing is selected.
SPLATLAS_WEB(splatlas_open_remote) int splatlas_open_remote(double bytes);
/// Text: the ranges that the calls since the last one have missed: [[offset, bytes], ...]. After a picture
/// that wanted some, give them and render again.
SPLATLAS_WEB(splatlas_wanted) int splatlas_wanted();
/// Adds the input as a piece of the file of splatlas_open_remote().
SPLATLAS_WEB(splatlas_give) int splatlas_give(double offset);
/// Text: the document of `splatlas-player info --json`.
SPLATLAS_WEB(splatlas_info) int splatlas_info();

/// Selects by the text in the input (format/content/selection.h). Text: an array of warnings. An error keeps
/// the selection.
SPLATLAS_WEB(splatlas_select) int splatlas_select();
/// Text: mode, opacity and colour of every structure in the selection, by index:
/// [["surface", 0.4, "#c0392b"], ["off"], ...]. The opacity is null where it is the default.
SPLATLAS_WEB(splatlas_drawn) int splatlas_drawn();
/// Shows the n-th scene of the atlas in a picture of this size: selects, turns and fits the camera. Text:
/// name, caption, selection, camera and warnings.
SPLATLAS_WEB(splatlas_scene) int splatlas_scene(std::uint32_t n, std::int32_t width, std::int32_t height);

/// Sets the camera: angles and field of view in degrees. `has_center`: (x, y, z) in LPS mm is in the middle
/// of the picture, else the centre of the atlas. Errors come with the picture.
SPLATLAS_WEB(splatlas_camera)
void splatlas_camera(double azimuth, double elevation, double zoom, std::int32_t has_center, double x,
                     double y, double z, std::int32_t is_perspective, double field_of_view);
/// Fits the camera to the selection in a picture of this size, or to its part in a structure and its
/// descendants; -1: all. Keeps the direction. Text: the camera.
SPLATLAS_WEB(splatlas_fit) int splatlas_fit(std::int32_t width, std::int32_t height, std::int32_t structure);

/// Removes all cuts.
SPLATLAS_WEB(splatlas_clear_cuts) void splatlas_clear_cuts();
/// Adds a cut, which removes the points p with n.p > offset (LPS mm). At most six.
SPLATLAS_WEB(splatlas_cut) int splatlas_cut(double nx, double ny, double nz, double offset);
/// Sets options of pictures: CapMode, DepthCue, hybrid shading, and the time for drafts in ms; 0: any.
SPLATLAS_WEB(splatlas_options)
int splatlas_options(std::int32_t caps, std::int32_t depth_cue, std::int32_t is_shaded,
                     double draft_budget_ms);

/// Renders a picture of a Quality. Text: an array of messages about missing parts of a damaged atlas.
SPLATLAS_WEB(splatlas_render)
int splatlas_render(std::int32_t width, std::int32_t height, std::int32_t quality);
/// The picture: linear RGBA, premultiplied; 4 * width * height floats, top row first.
SPLATLAS_WEB(splatlas_floats) const float* splatlas_floats();
/// The same as 8-bit sRGB with straight alpha, for ImageData. Null when out of memory.
SPLATLAS_WEB(splatlas_pixels) const std::uint8_t* splatlas_pixels();
/// Text: the structure at picture coordinates (x, y) of the latest picture, and its point; "null" for the
/// background.
SPLATLAS_WEB(splatlas_pick) int splatlas_pick(double x, double y);
/// Text: counts and times of the latest picture.
SPLATLAS_WEB(splatlas_stats) int splatlas_stats();
