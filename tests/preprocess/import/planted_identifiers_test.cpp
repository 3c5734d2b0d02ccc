// No free text of a source file reaches an atlas, a report or a message.
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "format/atlas_reader.h"
#include "preprocess/atlas/build_atlas.h"
#include "preprocess/commands/commands.h"
#include "tests/preprocess/import/images/dicom/dicom_files.h"
#include "tests/preprocess/import/planted_files.h"
#include "tests/preprocess/import/side_volumes.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"
#include "tests/support/repetitions.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

/// Notes and error in every form in which people see them.
std::string reports(const Notes& notes, const std::string& error) {
  std::string all = report_as_json(&notes, {}) + report_as_html(&notes, {}, "a.atlas") + error;
  for (const Note& note : notes.all()) {
    all += note.message();
    for (const std::string& item : note.items) all += item + "\n";
  }
  return all;
}

/// The bytes of an atlas file, and all its texts, which are compressed there.
std::string texts_of_atlas(const std::filesystem::path& path) {
  std::string all = read_bytes(path);
  const auto atlas = Atlas::open(path);
  if (!atlas) return all + atlas.error().message;
  const AtlasContent content = *(*atlas)->read_all();
  for (const Structure& structure : content.graph.structures()) {
    all += structure.id + "\n" + structure.name + "\n";
    for (const auto& term : structure.terms) all += term.vocabulary + " " + term.value + "\n";
  }
  const Provenance& provenance = content.provenance;
  all += provenance.title + provenance.citation + provenance.licence + provenance.tool;
  for (const Source& source : provenance.sources) all += source.role + " " + source.hash + "\n";
  return all;
}

class PlantedIdentifiers : public testing::Test {
 protected:
  /// All that a build of `sources` shows and writes.
  [[nodiscard]] std::string all_of_build(const SourceFiles& sources) const {
    BuildOptions options;
    options.sources = sources;
    options.output = folder_.file("out.atlas");
    options.level = 1;
    options.threads = 1;
    std::filesystem::remove(options.output);
    Notes notes;
    const Result<BuildReport> report = build_atlas(options, notes);
    return reports(notes, report ? "" : report.error().message) +
           (report ? "built\n" + texts_of_atlas(options.output) : "");
  }

  static void expect_clean(const std::string& text, const std::string& what) {
    EXPECT_THAT(text.find("PLANT"), std::string::npos)
        << what << ": "
        << text.substr(text.find("PLANT") - std::min<std::size_t>(text.find("PLANT"), 200), 400);
    EXPECT_EQ(text.find("9.8.7"), std::string::npos) << what;
  }

  /// Builds from a file that is cut at a place, and from one with a wrong byte there.
  void expect_variants_clean(const SourceFiles& sources, const std::string& path, const std::string& bytes,
                             std::size_t at) const {
    write_bytes(path, bytes.substr(0, at));
    expect_clean(all_of_build(sources), fmt::format("{} cut at {}", path, at));
    std::string damaged = bytes;
    damaged[at] ^= 0x11;
    write_bytes(path, damaged);
    expect_clean(all_of_build(sources), fmt::format("{} damaged at {}", path, at));
  }

  /// Builds from the whole file, and from files that are cut, or have a wrong byte.
  void expect_clean_builds(const std::string& path, const std::string& bytes,
                           const SourceFiles& sources) const {
    write_bytes(path, bytes);
    const std::string whole = all_of_build(sources);
    EXPECT_THAT(whole, HasSubstr("built\n")) << path;
    expect_clean(whole, path);
    // Text headers are short; pixels are not worth as many.
    constexpr std::size_t kPlaces = kAllRepetitions ? 20 : 7;
    const std::size_t step = std::max<std::size_t>(std::min<std::size_t>(bytes.size(), 1500) / kPlaces, 1);
    for (std::size_t at = 0; at < std::min<std::size_t>(bytes.size(), 1500); at += step) {
      expect_variants_clean(sources, path, bytes, at);
    }
    write_bytes(path, bytes);
  }
  TemporaryFolder folder_;
};

TEST_F(PlantedIdentifiers, OfImagesStayThere) {
  Planter plant;
  for (const PlantedFile& file : planted_images(plant)) {
    SourceFiles sources;
    sources.labels = folder_.file(file.name);
    sources.volume = folder_.file(file.name);
    expect_clean_builds(folder_.file(file.name), file.bytes, sources);
  }
  EXPECT_GE(plant.count(), 200u);
}

TEST_F(PlantedIdentifiers, OfMeshesStayThere) {
  Planter plant;
  write_bytes(folder_.file("labels.nrrd"), nrrd_in(placed(Body(), {}), "LPS"));
  for (const PlantedFile& file : planted_meshes(plant)) {
    SourceFiles sources;
    sources.labels = folder_.file("labels.nrrd");
    sources.meshes = {{.name = "Screw", .file = folder_.file(file.name)}};
    sources.fit_grid = true;
    expect_clean_builds(folder_.file(file.name), file.bytes, sources);
  }
  EXPECT_EQ(plant.count(), 57u);
}

/// Header fields that occur twice, and values that end up in another field, are not repeated in messages.
TEST_F(PlantedIdentifiers, OfDamagedTextHeadersStayThere) {
  Planter plant;
  for (const PlantedFile& file : planted_images(plant)) {
    if (!file.name.ends_with(".nrrd") && !file.name.ends_with(".mha")) continue;
    SourceFiles sources;
    sources.labels = folder_.file(file.name);
    const std::size_t end = std::min(file.bytes.find("\n\n"), file.bytes.find("LOCAL"));
    for (std::size_t at = file.bytes.find('\n'); at < end; at = file.bytes.find('\n', at + 1)) {
      std::string joined = file.bytes, twice = file.bytes;
      // The name of a segment may be any text.
      const bool is_name = file.bytes.substr(0, at).rfind("_Name:=") > file.bytes.rfind('\n', at - 1) &&
                           file.bytes.rfind("_Name:=", at) != std::string::npos;
      if (!is_name) joined[at] = ' ';
      const std::size_t next = file.bytes.find('\n', at + 1);
      if (next < end) twice.insert(next, file.bytes.substr(at, next - at));
      for (const std::string& bytes : {joined, twice}) {
        write_bytes(sources.labels, bytes);
        expect_clean(all_of_build(sources), fmt::format("{}, line at {}", file.name, at));
      }
    }
  }
}

TEST_F(PlantedIdentifiers, OfDicomStayThere) {
  std::filesystem::create_directory(folder_.path() / "series");
  for (int k = 0; k < 5; ++k) {
    TestSlice slice;
    slice.position = {0, 0, 2. * k};
    slice.stored.assign(TestSlice::kPixels, 0);
    for (std::size_t v = 0; v < 20; ++v) slice.stored[v] = static_cast<std::uint16_t>(100 * k);
    const std::filesystem::path file = folder_.path() / "series" / std::to_string(k);
    write_slice(slice, file);
    EXPECT_GE(plant_identifiers(file), 200u);
  }
  TestSegmentation segmentation;
  segmentation.segments = {{1, "Liver", {}, "SCT", "10200004", ""}};
  for (const double z : {0., 2., 4.})
    segmentation.frames.push_back({1, z, std::vector<std::uint16_t>(TestSegmentation::kPixels, 1)});
  write_segmentation(segmentation, folder_.file("seg.dcm"));
  EXPECT_GE(plant_identifiers(folder_.file("seg.dcm")), 200u);
  SourceFiles sources;
  sources.labels = folder_.file("seg.dcm");
  sources.volume = folder_.path() / "series";
  const std::string built = all_of_build(sources);
  EXPECT_THAT(built, HasSubstr("built\n"));
  EXPECT_THAT(built, HasSubstr("Liver"));
  expect_clean(built, "DICOM");
  for (const std::string& path : {folder_.file("seg.dcm"), folder_.file("series/2")}) {
    const std::string bytes = read_bytes(path);
    for (std::size_t at = 200; at < bytes.size(); at += bytes.size() / 25) {
      expect_variants_clean(sources, path, bytes, at);
    }
    write_bytes(path, bytes);
  }
  TestSlice localizer;
  localizer.axes = {0, 1, 0, 0, 0, -1};
  localizer.stored.assign(TestSlice::kPixels, 0);
  write_slice(localizer, folder_.file("series/localizer"));
  EXPECT_GE(plant_identifiers(folder_.file("series/localizer")), 200u);
  const std::string list = all_of_build(sources);
  EXPECT_THAT(list, HasSubstr("holds 2 series"));
  expect_clean(list, "DICOM");
}

}  // namespace
}  // namespace splatlas
