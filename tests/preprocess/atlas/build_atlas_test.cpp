// Whole builds: round trips, invariances and refusals; centre, radius and window of their display.

#include "preprocess/atlas/build_atlas.h"

#include <cmath>
#include <fstream>
#include <map>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "format/content/decision_tree.h"
#include "format/derive/distinct_colors.h"
#include "preprocess/export/export_atlas.h"
#include "tests/preprocess/build_atlas_fixture.h"
#include "tests/preprocess/messages_of_notes.h"
#include "tests/preprocess/random_images.h"
#include "tests/preprocess/raw_image_files.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

/// Tolerance for numbers that ITK wrote as text or 32-bit floats.
void expect_near(const Grid& a, const Grid& b, double tolerance) {
  EXPECT_EQ(a.size, b.size);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_NEAR(a.spacing_mm[n], b.spacing_mm[n], tolerance);
    EXPECT_NEAR(a.origin_lps_mm[n], b.origin_lps_mm[n], 40 * tolerance);  // mm, up to 40
  }
  for (std::size_t n = 0; n < 9; ++n) EXPECT_NEAR(a.direction_lps[n], b.direction_lps[n], tolerance);
}

TEST_F(BuildAtlas, LabelsAndVolumeComeBackVoxelForVoxel) {
  std::mt19937 random(1);
  const std::vector<AxisOrder> orders = all_axis_orders();
  std::size_t next_order = 0;
  for (const std::string ending : {".nrrd", ".mha", ".nii", ".nii.gz"}) {
    // NIfTI stores geometry in 32-bit floats and directions as quaternions; others store doubles as text.
    const double tolerance = ending.starts_with(".nii") ? 2e-6 : 1e-12;
    for (const VoxelType type : kVoxelTypes) {
      for (const double angle : {0.0, 0.2}) {
        SCOPED_TRACE(ending + " " + name_of(type));
        // 7 and 48 are coprime: every order occurs.
        const AxisOrder& order = orders[next_order = (next_order + 7) % orders.size()];
        const Image labels = in_order(random_labels(awkward_grid(angle), type, random), order);
        const Image volume = in_order(random_volume(awkward_grid(angle), type, random), order);
        EXPECT_EQ(build(options(labels, volume, ending)).label_type, type);
        export_all("labels_back" + ending, "volume_back" + ending);

        for (const std::string name : {"labels", "volume"}) {
          const Result<Image> in = import_image(file(name + ending)),
                              out = import_image(file(name + "_back" + ending));
          ASSERT_TRUE(in && out);
          EXPECT_EQ(in->voxels.type, out->voxels.type);
          EXPECT_EQ(in->voxels, out->voxels);
          expect_near(in->grid, out->grid, tolerance);
          EXPECT_EQ(in->voxels, (name == "labels" ? labels : volume).voxels);
        }
      }
    }
  }
}

TEST_F(BuildAtlas, AllAxisOrdersOfOneVolumeGiveOneAtlas) {
  std::mt19937 random(2);
  const Grid grid = awkward_grid(0.15);
  const Image labels = random_labels(grid, VoxelType::kUInt8, random);
  const Image volume = random_volume(grid, VoxelType::kInt16, random);
  AtlasContent first;
  for (const AxisOrder& order : all_axis_orders()) {
    AtlasContent content = build(options(in_order(labels, order), in_order(volume, order)));
    if (first.surfaces.empty()) first = content;
    EXPECT_EQ(content.class_volume, first.class_volume);
    EXPECT_EQ(content.values, first.values);
    EXPECT_EQ(content.surfaces, first.surfaces);
    EXPECT_EQ(content.boundary_normals, first.boundary_normals);
    for (ClassId c = 0; c < first.classes.size(); ++c) {
      EXPECT_EQ(content.classes.voxels(c), first.classes.voxels(c));
      EXPECT_EQ(content.classes.box(c), first.classes.box(c));
    }
    EXPECT_TRUE(std::ranges::equal(content.graph.structures(), first.graph.structures()));
    // Equal up to the origin, the first corner in the axis order, in doubles.
    expect_near(storage_grid(content), storage_grid(first), 1e-13);
    EXPECT_EQ(storage_grid(content).direction_lps, storage_grid(first).direction_lps);
    EXPECT_EQ(content.display.window_low, first.display.window_low);
    EXPECT_EQ(content.display.window_high, first.display.window_high);
    EXPECT_DOUBLE_EQ(content.display.radius_mm, first.display.radius_mm);
    // Each export restores its own order.
    export_all("back.nrrd", "");
    EXPECT_EQ(import_image(file("back.nrrd"))->voxels, in_order(labels, order).voxels);
  }
}

TEST_F(BuildAtlas, ColoursThatNobodyGivesKeepNeighboursApart) {
  std::mt19937 random(3);
  const Image labels = random_labels(awkward_grid(0), VoxelType::kUInt8, random);
  BuildOptions build_options =
      options(labels, random_volume(awkward_grid(0), VoxelType::kUInt8, random), ".nrrd");
  std::ofstream(build_options.sources.names = file("names.txt")) << "1 Qq 10 20 30 255\n";
  const AtlasContent content = build(build_options);
  std::vector<std::optional<Rgb>> given(content.graph.size());
  given[content.graph.find("Qq")->front()] = Rgb{10, 20, 30};
  const Index3 size = storage_grid(content).size;
  const RunModel runs = encode_runs(content.class_volume, size, Axis::kZ, content.classes.size());
  const auto expected =
      distinct_colors(touching_structures(given.size(), content.classes, runs.classes, size), given);
  for (StructureIndex s = 0; s < given.size(); ++s) EXPECT_EQ(content.graph[s].color, expected[s]) << s;
}

TEST_F(BuildAtlas, ColoursOfAnatomyKeepNeighboursApart) {
  // In a row: label 7 has the table's colour from its author, 9 is alone, and 4 to 6 mirror 1 to 3
  const std::string row = "112233006655440077880099";
  BuildOptions build_options = options();
  build_options.sources.labels =
      write("row.nrrd", byte_image({.size = {24, 2, 2}}, [&](auto i, auto, auto) { return row[i] - '0'; }));
  std::ofstream(build_options.sources.names = file("names.csv"))
      << "label,name,color\n1,rib L1 left,\n2,rib 2 left,\n3,Left rib 3,\n4,rib L1 right,\n5,rib 2 right,\n"
         "6,Right rib 3,\n7,aorta,#c8352e\n8,renal artery,\n9,femur,\n";
  const AtlasContent content = build(build_options);
  std::map<char, Rgb> colors;
  for (const Structure& s : content.graph.structures())
    colors[row[row.find(std::to_string(*s.label))]] = s.color;
  for (std::size_t n = 1; n < row.size(); ++n) {
    if (row[n - 1] == row[n] || row[n - 1] == '0' || row[n] == '0') continue;
    const Rgb left = colors[row[n - 1]], right = colors[row[n]];
    for (const Sight sight : kSights) EXPECT_GE(color_distance(left, right, sight), 0.112) << row[n];
    EXPECT_LE(color_distance(left, right, Sight::kNormal), row[n] < '7' ? 0.13 : 0.25);  // one step, or two
  }
  for (const char label : {'2', '9'}) EXPECT_EQ(to_hex(colors[label]), "#e6dcc3") << label;
  EXPECT_EQ(to_hex(colors['7']), "#c8352e");
  for (const char left : {'1', '2', '3'}) EXPECT_EQ(colors[left], colors[left + 3]) << left;
}

TEST_F(BuildAtlas, ThreadsDoNotChangeTheFile) {
  std::mt19937 random(3);
  BuildOptions build_options = options(random_labels(awkward_grid(0), VoxelType::kUInt8, random),
                                       random_volume(awkward_grid(0), VoxelType::kInt16, random));
  build_options.threads = 1;
  ASSERT_TRUE(build_atlas(build_options));
  const std::string one = read_bytes(build_options.output);
  build_options.output = file("five.atlas");
  build_options.threads = 5;
  ASSERT_TRUE(build_atlas(build_options));
  EXPECT_EQ(one, read_bytes(build_options.output));
}

TEST_F(BuildAtlas, OverlappingMasksComeBackAsMasks) {
  const Grid grid{.size = {6, 6, 6}};
  std::filesystem::create_directory(file("masks"));
  const Image body = byte_image(grid, [](auto i, auto, auto) { return i > 0; }),
              heart = byte_image(grid, [](auto i, auto j, auto k) { return i > 1 && j > 1 && k > 1; }),
              none = zeros(grid, VoxelType::kUInt8);
  write("masks/body.nii.gz", body);
  write("masks/a_heart.nii.gz", heart);
  write("masks/spleen.nii.gz", none);
  write_bytes(file("masks/readme.txt"), "not a mask");

  BuildOptions build_options = options();
  build_options.sources.labels = file("masks");
  const BuildReport report = value_or_throw(build_atlas(build_options));
  EXPECT_THAT(messages_of(report.notes), ElementsAre("1 mask without voxels is dropped: spleen"));
  const auto atlas = *Atlas::open(file("a.atlas"));
  // The larger one first, so that the more specific one has the higher number.
  ASSERT_EQ(atlas->graph().size(), 2u);
  EXPECT_EQ(atlas->graph()[0].name, "body");
  EXPECT_EQ(atlas->graph()[1].name, "a_heart");
  EXPECT_EQ(atlas->label_type(), VoxelType::kNone);

  ExportOptions back;
  back.atlas = file("a.atlas");
  back.labels = file("labels.nii.gz");
  EXPECT_THAT(export_atlas(back).error().message, HasSubstr("--labels FOLDER/"));
  EXPECT_FALSE(std::filesystem::exists(back.labels));
  back.labels = file("masks_back") + "/";
  ASSERT_TRUE(export_atlas(back));
  for (const auto& [name, image] :
       {std::pair<const char*, const Image*>{"body", &body}, {"a_heart", &heart}}) {
    const Image out = value_or_throw(import_image(file(std::string("masks_back/") + name + ".nii.gz")));
    EXPECT_EQ(out.voxels, image->voxels);
  }
  EXPECT_THAT(export_atlas(back).error().message, HasSubstr("not an empty folder"));
}

TEST_F(BuildAtlas, SegmentsTakeWhatNoLabelHoldsAndLeaveLabelsAlone) {
  const Grid grid{.size = {8, 8, 8}};
  const auto in_cube = [](std::int64_t low, auto... at) {
    return std::min({at...}) >= low && std::max({at...}) <= 7 - low;
  };
  const Image labels = byte_image(grid, [&](auto... at) { return in_cube(3, at...) ? 7 : 0; });  // 8 voxels
  const Image mask = byte_image(grid, [&](auto... at) { return in_cube(2, at...); });            // 64
  Image values = byte_image(
      grid, [&](auto... at) { return in_cube(1, at...) && !in_cube(3, at...) ? 100 : 0; });  // 216 - 8
  values.voxels.bytes[0] = std::byte{200};  // a disconnected speck
  BuildOptions build_options = options(labels, values);
  build_options.sources.segments = {*parse_segment("Middle=mask:" + write("mask.nrrd", mask)),
                                    *parse_segment("Outer=threshold:50")};
  const AtlasContent content = build(build_options);
  ASSERT_EQ(content.graph.size(), 3u);
  const auto counts =
      subtree_counts(content.graph, content.classes, DecisionTree(content.graph, content.classes),
                     std::array<std::uint64_t, 3>{});
  const auto voxels = [&](StructureIndex s) { return counts[s].interior + counts[s].boundary; };
  EXPECT_EQ(content.graph[0].label, 7);
  EXPECT_EQ(voxels(0), 8u);
  EXPECT_EQ(content.graph[1].name, "Middle");
  EXPECT_FALSE(content.graph[1].label);
  EXPECT_EQ(voxels(1), 64u - 8u);
  EXPECT_EQ(voxels(2), 216u - 64u);  // its hole is filled, but belongs to another structure
  export_all("back.nrrd", "");
  EXPECT_EQ(import_image(file("back.nrrd"))->voxels, labels.voxels);
}

TEST_F(BuildAtlas, ProvenanceHoldsHashesAndWordsOfTheAuthorOnly) {
  std::mt19937 random(5);
  BuildOptions build_options = options();
  build_options.title = "A title";
  build_options.citation = "A citation";
  build_options.licence = "CC0";
  build_options.tool = "tests";
  const Grid grid = awkward_grid(0);
  build_options.sources.labels = write("CANARY-labels.nrrd", random_labels(grid, VoxelType::kUInt8, random));
  build_options.sources.volume = write("CANARY.nrrd", random_volume(grid, VoxelType::kInt16, random));
  const AtlasContent content = build(build_options);
  EXPECT_EQ(content.provenance.title, "A title");
  EXPECT_EQ(content.provenance.citation, "A citation");
  EXPECT_EQ(content.provenance.licence, "CC0");
  EXPECT_EQ(content.provenance.tool, "tests");
  ASSERT_EQ(content.provenance.sources.size(), 2u);
  EXPECT_EQ(content.provenance.sources[0].role, "labels");
  EXPECT_EQ(content.provenance.sources[1].role, "volume");
  EXPECT_THAT(content.provenance.sources[1].hash, testing::MatchesRegex("sha256:[0-9a-f]{64}"));
  EXPECT_EQ(read_bytes(build_options.output).find("CANARY"), std::string::npos);
}

/// The note on resampled labels has the names of --names.
TEST_F(BuildAtlas, ResampledStructuresHaveTheirFinalNames) {
  Image labels = zeros({.size = {4, 1, 1}}, VoxelType::kUInt8);
  labels.voxels.as<std::uint8_t>()[1] = labels.voxels.as<std::uint8_t>()[2] = 7;
  BuildOptions build_options =
      options(labels, zeros({.size = {8, 1, 1}, .spacing_mm = {0.5, 1, 1}}, VoxelType::kUInt8));
  build_options.sources.resample = ResampleTo::kVolume;
  build_options.sources.names = file("names.txt");
  write_bytes(file("names.txt"), "7 Spleen\n");
  const BuildReport report = value_or_throw(build_atlas(build_options));
  EXPECT_THAT(messages_of(report.notes),
              testing::Contains(HasSubstr("Spleen (2 voxels, 0.002 ml, become 4 voxels, 0.002 ml)")));

  // A voxel that lies between those of the volume is lost, under the name of the table.
  build_options = options(
      labels,
      zeros({.size = {2, 1, 1}, .spacing_mm = {4, 1, 1}, .origin_lps_mm = {-0.1, 0, 0}}, VoxelType::kUInt8));
  build_options.output = file("b.atlas");
  build_options.sources.resample = ResampleTo::kVolume;
  build_options.sources.names = file("names.txt");
  const BuildReport lost = value_or_throw(build_atlas(build_options));
  EXPECT_THAT(
      messages_of(lost.notes),
      testing::Contains("1 structure has no voxel left on the other grid: Spleen (2 voxels, 0.002 ml)"));
  EXPECT_THAT(messages_of(lost.notes), testing::Not(testing::Contains(HasSubstr("and is dropped"))));
}

TEST_F(BuildAtlas, EveryStructureHasANameOfItsOwn) {
  std::mt19937 random(12);
  BuildOptions build_options = options();
  build_options.sources.labels =
      write("labels.nrrd", random_labels(awkward_grid(0), VoxelType::kUInt8, random));
  build_options.sources.meshes = {{"Screw", "missing.stl"}, {"screw", "missing too.stl"}};
  EXPECT_THAT(error_of(build_options), testing::AllOf(HasSubstr("--mesh"), HasSubstr("\"screw\"")));
  build_options.sources.meshes.pop_back();
  build_options.sources.segments = {*parse_segment("SCREW =mask:missing.nrrd")};
  EXPECT_THAT(error_of(build_options), testing::AllOf(HasSubstr("--segment"), HasSubstr("--mesh")));
  build_options.sources.segments.clear();
  for (const std::string name : {"Label 1", "label 1"}) {
    build_options.sources.meshes = {{name, "missing.stl"}};
    EXPECT_THAT(error_of(build_options), testing::AllOf(HasSubstr("--mesh"), HasSubstr("labels.nrrd")));
  }
  for (const std::string& name : {std::string("a\nb"), std::string(201, 'x')}) {
    build_options.sources.meshes = {{name, "missing.stl"}};
    EXPECT_THAT(build_atlas(build_options), FailsWith(ErrorCode::kUsage, Not(HasSubstr("\n"))));
  }
}

TEST_F(BuildAtlas, PathsThatCannotBeFollowedAreToldInOneLine) {
  BuildOptions build_options = options();
  build_options.sources.labels = file(std::string(300, 'x') + ".nii");
  EXPECT_THAT(error_of(build_options), HasSubstr("cannot be read: File name too long"));
  std::filesystem::create_symlink("loop.nii", file("loop.nii"));
  build_options.sources.labels = file("loop.nii");
  EXPECT_THAT(error_of(build_options), HasSubstr("loop.nii: cannot be read: Too many levels of symbolic"));
}

TEST_F(BuildAtlas, NoOutputGoesOverDetachedPixels) {
  write_bytes(file("a.hdr"), nifti_header());
  write_bytes(file("a.nhdr"), nrrd_header("raw", "data file: pixels.raw\n"));
  write_bytes(file("a.mhd"), meta_header("", "pixels.raw"));
  for (const std::string pixels : {"a.img", "pixels.raw"}) write_bytes(file(pixels), RawImage::payload());
  for (const auto& [input, pixels] : {std::pair("a.hdr", "a.img"), std::pair("a.img", "a.hdr"),
                                      std::pair("a.nhdr", "pixels.raw"), std::pair("a.mhd", "pixels.raw")}) {
    BuildOptions build_options = options();
    build_options.output = file(pixels);
    build_options.sources.labels = file(input);
    EXPECT_THAT(build_atlas(build_options), FailsWith(ErrorCode::kUsage, HasSubstr("is an input")));
  }
}

TEST_F(BuildAtlas, RefusesWhatDoesNotFitTogether) {
  std::mt19937 random(6);
  BuildOptions build_options = options();
  build_options.sources.labels =
      write("labels.nrrd", random_labels(awkward_grid(0), VoxelType::kUInt8, random));
  Grid other = awkward_grid(0);
  other.origin_lps_mm[1] += 1e4;
  build_options.sources.volume = write("volume.nrrd", random_volume(other, VoxelType::kUInt8, random));
  EXPECT_THAT(error_of(build_options), HasSubstr("they do not overlap"));
  build_options.sources.resample = ResampleTo::kVolume;
  EXPECT_THAT(error_of(build_options), HasSubstr("they do not overlap"));
  build_options.sources.resample = ResampleTo::kAsk;
  build_options.sources.volume.clear();
  build_options.sources.segments = {*parse_segment("S=mask:" + file("volume.nrrd"))};
  EXPECT_THAT(error_of(build_options), HasSubstr("lies outside the grid"));
}

ClassifiedVoxels classify(const Masks& masks, const Grid& grid, const StructureGraph& graph) {
  return *classify_voxels(memberships_of(masks, grid.size), {}, graph, 1);
}

TEST(MeasureDisplay, TheBallReachesTheFarthestCorner) {
  Grid grid = awkward_grid(0.2);
  grid.size = {10, 10, 10};
  const Masks box{make_mask(grid.size, [](auto i, auto j, auto k) {
    return i >= 2 && i <= 5 && j >= 3 && j <= 3 && k >= 1 && k <= 8;
  })};
  const StructureGraph graph = flat_graph(1);
  const Display display = measure_display(classify(box, grid, graph), graph, {}, grid);
  const Vec3 center = index_to_lps_mm(grid).apply({3.5, 3, 4.5});
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(display.center_lps_mm[a], center[a], 1e-12);
  // Half of 4 x 1 x 8 voxels of 0.75 x 1.5 x 3.25 mm.
  EXPECT_NEAR(display.radius_mm, std::hypot(2 * 0.75, 0.5 * 1.5, 4 * 3.25), 1e-12);
}

TEST(MeasureDisplay, NothingAtAllFramesTheGrid) {
  const Grid grid{.size = {4, 4, 4}};
  const StructureGraph graph = flat_graph(1);
  const Display display =
      measure_display(classify({std::vector<std::uint8_t>(64, 0)}, grid, graph), graph, {}, grid);
  EXPECT_EQ(display.center_lps_mm, (Vec3{1.5, 1.5, 1.5}));
  EXPECT_NEAR(display.radius_mm, std::sqrt(12.0), 1e-12);
}

TEST(MeasureDisplay, TheWindowIsOfLabelledStructures) {
  // Values 0..999 along i; structure A has a label and holds 100..299, B has none and holds the rest.
  const Grid grid{.size = {1000, 1, 1}};
  VoxelBuffer values{VoxelType::kUInt16, std::vector<std::byte>(2000)};
  for (std::size_t v = 0; v < 1000; ++v) values.as<std::uint16_t>()[v] = static_cast<std::uint16_t>(v);
  const Masks masks{make_mask(grid.size, [](auto i, auto, auto) { return i >= 100 && i < 300; }),
                    make_mask(grid.size, [](auto i, auto, auto) { return i < 100 || i >= 300; })};
  std::vector<SourceStructure> sources(2);
  sources[0].name.push_back('A');
  sources[1].name.push_back('B');
  sources[0].label = 1;
  Notes notes;
  const StructureGraph labelled = build_graph(sources, {}, "", notes)->graph;
  Display display = measure_display(classify(masks, grid, labelled), labelled, values, grid);
  EXPECT_EQ(display.window_low, 101);   // 1 % of 200 values above 100
  EXPECT_EQ(display.window_high, 298);  // 99.5 %
  const StructureGraph bare = flat_graph(2);
  display = measure_display(classify(masks, grid, bare), bare, values, grid);
  EXPECT_EQ(display.window_low, 9);
  EXPECT_EQ(display.window_high, 994);
}

TEST(MeasureDisplay, ConstantAndBrokenValuesStillGiveAWindow) {
  const Grid grid{.size = {4, 1, 1}};
  VoxelBuffer values{VoxelType::kFloat32, std::vector<std::byte>(16)};
  const StructureGraph graph = flat_graph(1);
  const ClassifiedVoxels all = classify({std::vector<std::uint8_t>(4, 1)}, grid, graph);
  for (std::size_t v = 0; v < 4; ++v) values.as<float>()[v] = 5;
  Display display = measure_display(all, graph, values, grid);
  EXPECT_EQ(display.window_low, 4);
  EXPECT_EQ(display.window_high, 5);  // full opacity
  for (std::size_t v = 0; v < 4; ++v) values.as<float>()[v] = v < 2 ? std::nanf("") : INFINITY;
  display = measure_display(all, graph, values, grid);
  EXPECT_LT(display.window_low, display.window_high);
}

}  // namespace
}  // namespace splatlas
