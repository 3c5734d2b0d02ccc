#include "tests/format/bad_files/bad_files.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "format/atlas_reader.h"
#include "format/program/standard_output.h"

namespace splatlas {
namespace {

/// Reads everything that a player may request.
void read_what_is_left(const Atlas& atlas) {
  (void)atlas.read_all();
  for (ClassId c = 0; c < atlas.classes().size(); ++c) {
    for (const Axis axis : kAxes) (void)atlas.read_runs(c, axis);
    (void)atlas.read_values(c);
    (void)atlas.read_normals(c);
    (void)atlas.read_means(c);
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

void expect_fault(const RawAtlas& atlas, const char* message, const char* row_message, const char* what) {
  static const std::size_t good_bytes = file_of(raw_atlas(good_file())).size();
  const Bytes bytes = file_of(atlas);
  const std::string of_row =
      fmt::format(fmt::runtime(row_message), good_bytes, bytes.size(), good_bytes - 1, good_bytes + 1);
  EXPECT_EQ(fault_of_file(bytes), fmt::format(fmt::runtime(message), of_row)) << what;
}

}  // namespace splatlas
