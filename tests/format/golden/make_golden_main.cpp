// splatlas-golden FOLDER: writes golden files of the current format version.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "format/io/output_file.h"
#include "tests/format/golden/golden_contents.h"

namespace {

void must(const splatlas::Result<void>& result) {
  if (!result) throw std::runtime_error(result.error().message);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) throw std::runtime_error("give the folder to write to");
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  std::string good;  // the first one
  for (const splatlas::GoldenContent& golden : splatlas::golden_contents()) {
    must(splatlas::write_atlas(golden.content, folder / (golden.name + ".atlas"),
                               {.compact = golden.compact, .means_from = golden.means_from}));
    std::string text = splatlas::content_text(golden.content);
    if (!good.empty()) text = splatlas::text_beside(good, text);
    if (good.empty()) good = text;
    must(splatlas::write_file(folder / (golden.name + ".txt"), std::as_bytes(std::span(text))));
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "splatlas-golden: %s\n", error.what());
  return 1;
}
