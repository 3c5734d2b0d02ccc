#include "preprocess/commands/build_command.h"

#include <fmt/format.h>

#include "format/system/ascii_text.h"
#include "format/system/plain_text.h"
#include "format/system/result_macros.h"
#include "preprocess/build_atlas.h"
#include "preprocess/commands/name_and_file.h"
#include "preprocess/commands/progress_display.h"

namespace splatlas {

struct BuildWords {
  BuildOptions options;
  std::vector<std::string> meshes, segments;
  std::string mesh_frame = "lps", progress = "auto";
};

void ForgetBuildWords::operator()(BuildWords* words) const {
  delete words;
}

namespace {

constexpr const char* kFooter = R"(Examples:
  splatlas-preprocess build -o brain.atlas --labels aal.nii.gz --names aal.nii.txt --volume ch2.nii.gz
  splatlas-preprocess build -o body.atlas --labels segmentations/ --volume ct.nii.gz
  splatlas-preprocess build -o knee.atlas --labels knee.mha --volume knee_ct.mha --mesh Screw=screw.stl
  splatlas-preprocess build -o head.atlas --volume t1.nii.gz --segment Head=threshold:otsu:close=2

Volumes: NIfTI (.nii, .nii.gz), NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd); all of one build on one grid.

Labels: a label map, every value above 0 a structure; or a folder with one mask per structure (TotalSegmentator's
way), named by its file; masks may overlap.

Names: one label a line, "label name [code]" as AAL's file has it, or the eight columns of ITK-SNAP. Without names
label 7 is "Label 7".

Tree: )";

constexpr const char* kFooterEnd = R"(

Segments: voxels that no label holds yet get a structure of their own, in the order of the command line.
  NAME=mask:FILE                        what is not 0 in another volume on the same grid
  NAME=threshold:LOW[:HIGH][:close=MM]  grey values from LOW to HIGH: the largest connected piece, gaps up to twice
                                        MM closed, holes filled
  NAME=threshold:otsu[:close=MM]        the same from Otsu's threshold on

Exit status: 0 done; 1 could not be done; 2 wrong usage. A failed or interrupted build leaves nothing behind.)";

Result<SourceFiles> sources_of(const BuildWords& words) {
  SourceFiles sources = words.options.sources;
  for (const std::string& text : words.segments) {
    SPLATLAS_ASSIGN_OR_RETURN(sources.segments.emplace_back(), parse_segment(text));
  }
  for (const std::string& text : words.meshes) {
    SPLATLAS_ASSIGN_OR_RETURN(auto mesh, split_name_and_file("--mesh", text));
    sources.meshes.push_back({std::move(mesh.first), std::move(mesh.second)});
  }
  if (words.mesh_frame != "lps" && words.mesh_frame != "ras") {
    return fail(ErrorCode::kUsage, fmt::format("--mesh-frame {}: must be lps or ras", words.mesh_frame));
  }
  sources.mesh_frame = words.mesh_frame == "ras" ? MeshFrame::kRas : MeshFrame::kLps;
  return sources;
}

/// What is kept in the atlas as it is typed.
Result<void> check_texts(const BuildOptions& options) {
  const std::pair<const char*, const std::string&> texts[] = {
      {"--title", options.title}, {"--citation", options.citation}, {"--licence", options.licence}};
  for (const auto& [option, text] : texts) {
    if (const std::string fault = fault_of_text(text); !fault.empty())
      return fail(ErrorCode::kUsage, fmt::format("{} {} {}", option, in_quotes(text), fault));
  }
  return {};
}

void print_summary(const BuildReport& report, const std::string& output) {
  double seconds = 0;
  for (const auto& stage : report.stages) seconds += stage.seconds;
  fmt::print("{}: {} structures, {} classes, {} + {} + {} runs, {} triangles, {} bytes, {:.2f} s\n", output,
             report.structures, report.classes, report.runs[0], report.runs[1], report.runs[2],
             report.triangles, report.bytes, seconds);
}

}  // namespace

BuildWordsPtr add_build(CLI::App& app) {
  BuildWordsPtr words(new BuildWords);
  BuildOptions& options = words->options;
  SourceFiles& sources = options.sources;
  CLI::App* build =
      app.add_subcommand("build", "Make an atlas from volumes, labels, names, trees and surfaces");
  build->footer(std::string(kFooter) + kTreeFormat + kFooterEnd);
  build->add_option("-o,--output", options.output, "atlas file to write")->required();
  build->add_option("--labels", sources.labels, "label map, or folder of masks");
  build->add_option("--volume", sources.volume, "grey values");
  build->add_option("--names", sources.names, "what the labels are called");
  build->add_option("--colors", sources.colors, "colour table of 768 bytes (MRIcron's .lut)");
  build->add_option("--tree", sources.tree, "how structures belong together");
  build->add_option("--segment", words->segments,
                    "NAME=RULE: a structure from thresholds or a mask (repeatable)");
  build->add_option("--mesh", words->meshes,
                    "NAME=FILE: an external surface, .stl .obj .ply .vtk (repeatable)");
  build
      ->add_option("--mesh-frame", words->mesh_frame,
                   "lps or ras: which way the coordinates of surfaces run, in mm")
      ->capture_default_str();
  build->add_flag("--allow-empty", sources.allow_empty,
                  "keep named labels that no voxel has, as empty structures");
  build->add_option("--title", options.title, "kept in the atlas");
  build->add_option("--citation", options.citation, "kept in the atlas");
  build->add_option("--licence,--license", options.licence, "kept in the atlas");
  build->add_flag("--compact", options.compact, "leave out what a player derives in milliseconds");
  build->add_option("--level", options.level, "Zstandard level, 1 (fast) to 22 (small)")
      ->capture_default_str();
  build->add_option("--threads", options.threads, "0: one per core")->capture_default_str();
  build->add_option("--progress", words->progress, "auto, none or json, on standard error")
      ->capture_default_str();
  return words;
}

Result<void> run_build(const BuildWords& words, const std::string& tool) {
  BuildOptions options = words.options;
  options.tool = tool;
  if (options.level < 1 || options.level > 22) {
    return fail(ErrorCode::kUsage, fmt::format("--level {}: must be 1 to 22", options.level));
  }
  SPLATLAS_RETURN_IF_ERROR(check_texts(options));
  SPLATLAS_ASSIGN_OR_RETURN(options.sources, sources_of(words));
  SPLATLAS_ASSIGN_OR_RETURN(const ProgressMode mode, progress_mode(words.progress, stderr));
  ProgressDisplay display(mode, stderr);
  options.progress = [&](const BuildProgress& progress) { display.show(progress); };
  const Result<BuildReport> report = build_atlas(options);
  display.finish();
  if (!report) return tl::unexpected(report.error());
  if (mode != ProgressMode::kJson) {
    for (const std::string& note : report->notes) fmt::print(stderr, "note: {}\n", note);
  }
  print_summary(*report, options.output.string());
  return {};
}

}  // namespace splatlas
