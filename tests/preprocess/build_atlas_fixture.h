// Test fixture of whole builds in a temporary folder.
#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "format/atlas_reader.h"
#include "preprocess/atlas/build_atlas.h"
#include "preprocess/export/export_atlas.h"
#include "preprocess/export/write_image.h"
#include "tests/support/committed.h"
#include "tests/support/run_program.h"

namespace splatlas {

class BuildAtlas : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder_.file(name); }
  std::string write(const std::string& name, const Image& image) const {
    const Result<void> written = committed(write_image(image, file(name)));
    EXPECT_TRUE(written) << written.error().message;
    return file(name);
  }
  BuildOptions options() const {
    BuildOptions options;
    options.output = file("a.atlas");
    options.level = 1;
    options.threads = 2;
    return options;
  }
  /// The same, of images in these files.
  BuildOptions options(const Image& labels, const Image& volume, const std::string& ending = ".nrrd") const {
    BuildOptions options = this->options();
    options.sources.labels = write("labels" + ending, labels);
    options.sources.volume = write("volume" + ending, volume);
    return options;
  }
  AtlasContent build(const BuildOptions& options) const {
    const Result<BuildReport> report = build_atlas(options);
    EXPECT_TRUE(report) << report.error().message;
    if (!report) return {};
    return *(*Atlas::open(options.output))->read_all();
  }
  std::string error_of(const BuildOptions& options) const {
    const Result<BuildReport> report = build_atlas(options);
    EXPECT_FALSE(report);
    EXPECT_FALSE(std::filesystem::exists(options.output));
    return report ? "" : report.error().message;
  }
  void export_all(const std::string& labels, const std::string& volume) const {
    ExportOptions back;
    back.atlas = file("a.atlas");
    back.labels = labels.empty() ? "" : file(labels);
    if (!volume.empty()) back.volume = file(volume);
    const auto written = value_or_throw(export_atlas(back));
  }
  TemporaryFolder folder_;
};

}  // namespace splatlas
