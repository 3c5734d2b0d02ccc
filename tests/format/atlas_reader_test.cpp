#include "format/atlas_reader.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_writer.h"
#include "tests/format/random_content.h"

namespace splatlas {
namespace {

WriteOptions quick(bool compact = false) {
  WriteOptions options;
  options.level = 1;
  options.threads = 1;
  options.compact = compact;
  return options;
}

std::shared_ptr<const Atlas> open_content(const AtlasContent& content, const WriteOptions& options) {
  auto bytes = encode_atlas(content, options);
  if (!bytes) throw std::runtime_error(bytes.error().message);
  auto atlas = Atlas::open_bytes(*std::move(bytes));
  if (!atlas) throw std::runtime_error(atlas.error().message);
  return *atlas;
}

RC_GTEST_PROP(Atlas, ReadsWhatWasWritten, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random);
  for (const bool compact : {false, true}) {
    const auto atlas = open_content(content, quick(compact));
    const auto read = atlas->read_all();
    RC_ASSERT(read.has_value());
    RC_ASSERT(difference(content, *read) == "");
    const auto verified = atlas->verify();
    if (!verified) RC_FAIL(verified.error().message);
    for (const Axis axis : kAxes) {
      const RunModel model =
          encode_runs(content.class_volume, atlas->grid().size, axis, content.classes.size());
      RC_ASSERT(atlas->runs(axis) == model.runs());
      for (ClassId c = 0; c < content.classes.size(); ++c)
        RC_ASSERT(*atlas->read_runs(c, axis) == model.classes[c]);
    }
  }
}

}  // namespace
}  // namespace splatlas
