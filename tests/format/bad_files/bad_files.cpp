#include "tests/format/bad_files/bad_files.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "format/atlas_reader.h"
#include "format/system/exit_status.h"

namespace splatlas {
namespace {

/// Reads everything that a player may request.
void read_what_is_left(const Atlas& atlas) {
  (void)atlas.read_all();
  for (ClassId c = 0; c < atlas.classes().size(); ++c) {
    for (const Axis axis : kAxes) (void)atlas.read_runs(c, axis);
    (void)atlas.read_values(c);
    (void)atlas.read_normals(c);
  }
  for (StructureIndex s = 0; s < atlas.graph().size(); ++s) (void)atlas.read_surface(s);
}

}  // namespace

std::string fault_of_file(Bytes bytes) {
  const auto fault = [](const Error& error) {
    EXPECT_EQ(exit_status(error.code), 3) << error.message;
    return error.message;
  };
  const auto atlas = Atlas::open_bytes(std::move(bytes), "F");
  if (!atlas) return fault(atlas.error());
  read_what_is_left(**atlas);
  const auto verified = (*atlas)->verify();
  return verified ? "" : fault(verified.error());
}

void expect_refused(std::span<const BadFile> files) {
  const RawAtlas good = raw_atlas(good_file());
  const std::size_t good_bytes = file_of(good).size();
  for (const BadFile& file : files) {
    RawAtlas atlas = good;
    file.change(atlas);
    const Bytes bytes = file_of(atlas);
    const std::string message =
        fmt::format(fmt::runtime(file.message), good_bytes, bytes.size(), good_bytes - 1, good_bytes + 1);
    EXPECT_EQ(fault_of_file(bytes), message) << file.what;
  }
}

}  // namespace splatlas
