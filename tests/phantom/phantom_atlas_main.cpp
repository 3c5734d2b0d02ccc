// splatlas-phantom-atlas FILE [KIND]: the golden phantom as an atlas, without ITK and VTK.
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>

#include <CLI/CLI.hpp>

#include "format/atlas_writer.h"
#include "format/program/command_options.h"
#include "format/program/standard_output.h"
#include "tests/format/atlas_surgery.h"
#include "tests/support/phantom_content.h"

namespace splatlas {
namespace {

AtlasContent empty_content() {
  TestVolume volume;
  volume.grid.size = {phantom::kSize, phantom::kSize, phantom::kSize};
  return make_content(volume);
}

Bytes with_damage(Bytes file) {
  const AtlasParts parts = take_apart(file);
  const FileLayout layout = lay_out(parts.directory, directory_bytes(file).size()).value();
  file[layout.chunk_offset[layout.find(SectionKind::kSurfaces)->first_chunk]] ^= std::byte{1};
  return file;
}

Result<void> write_kind(const std::string& path, const std::string& kind) {
  if (kind != "damaged") return write_atlas(kind == "empty" ? empty_content() : phantom_content(), path);
  const Bytes file = with_damage(encode_atlas(phantom_content()).value());
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
  out.close();
  if (out) return {};
  return fail(ErrorCode::kFailed, path + ": cannot be written");
}

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) try {
  using namespace splatlas;
  CLI::App app("Writes the golden phantom as an atlas.", "splatlas-phantom-atlas");
  std::string path, kind = "whole";
  add_path(app, "FILE", path, "the atlas to write")->required();
  app.add_option("KIND", kind, "damaged: with a flipped byte in the first surface; empty: its grid alone")
      ->check(CLI::IsMember({"whole", "damaged", "empty"}))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : exit_status(ErrorCode::kUsage);
  }
  const auto written = write_kind(path, kind);
  if (written) return 0;
  std::fprintf(stderr, "splatlas-phantom-atlas: %s\n", written.error().message.c_str());
  return exit_status(written.error().code);
} catch (const std::exception& error) {
  std::fprintf(stderr, "splatlas-phantom-atlas: %s\n", error.what());
  return 1;
}
