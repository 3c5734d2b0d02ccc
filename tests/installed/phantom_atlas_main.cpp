// splatlas-phantom-atlas FILE [KIND]: the golden phantom as an atlas, without ITK and VTK. KIND "damaged":
// with a flipped byte in the first surface; "empty": its grid without structures.
#include <cstdio>
#include <fstream>
#include <string_view>

#include "format/atlas_writer.h"
#include "format/system/exit_status.h"
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

Result<void> write_kind(const char* path, std::string_view kind) {
  if (kind != "damaged") return write_atlas(kind == "empty" ? empty_content() : phantom_content(), path);
  const Bytes file = with_damage(encode_atlas(phantom_content()).value());
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
  out.close();
  if (out) return {};
  return fail(ErrorCode::kFailed, "cannot write");
}

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) {
  const std::string_view kind = argc == 3 ? argv[2] : "";
  const bool is_known = argc == 2 || kind == "damaged" || kind == "empty";
  if (argc < 2 || argc > 3 || !is_known) {
    std::fputs("usage: splatlas-phantom-atlas FILE [damaged|empty]\n", stderr);
    return 2;
  }
  const auto written = splatlas::write_kind(argv[1], kind);
  if (written) return 0;
  std::fprintf(stderr, "splatlas-phantom-atlas: %s: %s\n", argv[1], written.error().message.c_str());
  return splatlas::exit_status(written.error().code);
}
