// Invalid files: FlatBuffer offsets, lengths and alignment.
#include <cstring>

#include <gtest/gtest.h>

#include "schemas/atlas_generated.h"
#include "tests/format/bad_files/bad_files.h"

namespace splatlas {
namespace {

template <typename T>
T number_at(const Bytes& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

template <typename T>
void put(Bytes& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

std::size_t table_at(const Bytes& bytes) {
  return number_at<std::uint32_t>(bytes, 0);
}

std::size_t vtable_at(const Bytes& bytes) {
  const std::size_t table = table_at(bytes);
  return table - static_cast<std::size_t>(number_at<std::int32_t>(bytes, table));
}

/// Offset of a field of the table, by its entry in the vtable.
std::size_t field_at(const Bytes& bytes, std::size_t vtable_entry) {
  return table_at(bytes) + number_at<std::uint16_t>(bytes, vtable_at(bytes) + vtable_entry);
}

/// Offset of the length of a vector.
std::size_t vector_at(const Bytes& bytes, std::size_t vtable_entry) {
  const std::size_t field = field_at(bytes, vtable_entry);
  return field + number_at<std::uint32_t>(bytes, field);
}

template <std::size_t entry, std::uint32_t length>
void set_length(Bytes& d) {
  put(d, vector_at(d, entry), length);
}

template <std::size_t entry, std::uint32_t offset>
void set_offset(Bytes& d) {
  put(d, field_at(d, entry), offset);
}

/// Copies a vector to the end of the buffer, four bytes off its alignment.
template <std::size_t entry, std::size_t row_bytes>
void misalign(Bytes& d) {
  const std::size_t from = vector_at(d, entry);
  const std::size_t bytes = 4 + number_at<std::uint32_t>(d, from) * row_bytes;
  const Bytes copy = slice(d, from, from + bytes);
  d.resize((d.size() + 7) / 8 * 8);
  const std::size_t field = field_at(d, entry);
  put(d, field, static_cast<std::uint32_t>(d.size() - field));
  d.insert(d.end(), copy.begin(), copy.end());
}

/// Sets an entry of the table of fields: 0 is its length, others are offsets of fields, 0 for none.
template <std::size_t entry, std::uint16_t offset>
void set_entry(Bytes& d) {
  put(d, vtable_at(d) + entry, offset);
}

using D = schema::Directory;
using BadBuffer = BadFile<Bytes>;

constexpr BadBuffer kNotBuffers[] = {
    {"sixteen bytes", [](auto& d) { d.resize(16); }},
    {"zeros", [](auto& d) { d.assign(d.size(), std::byte{0}); }},
    {"another identifier", [](auto& d) { d[4] = std::byte{'s'}; }},
    {"a root beyond the end", [](auto& d) { put(d, 0, static_cast<std::uint32_t>(d.size())); }},
    {"a table of fields before the beginning", [](auto& d) { put(d, table_at(d), 0x7fffffff); }},
    {"a table of fields of an odd length", set_entry<0, 5>},
    {"a field beyond the table", set_entry<D::VT_SOURCE_GRID, 0xfff0>},
    {"structures of the largest length", set_length<D::VT_STRUCTURES, 0xffffffff>},
    {"structures of a length that wraps around", set_length<D::VT_STRUCTURES, 0x10000001>},
    {"classes of a length beyond the end", set_length<D::VT_CLASSES, 1000>},
    {"structures beyond the end", set_offset<D::VT_STRUCTURES, 0x10000000>},
    {"text not aligned", set_offset<D::VT_TEXT, 5>},
};

constexpr BadBuffer kMisaligned[] = {
    {"structures", misalign<D::VT_STRUCTURES, 16>},
    {"classes", misalign<D::VT_CLASSES, 48>},
    {"scenes", misalign<D::VT_SCENES, 24>},
    {"chunks", misalign<D::VT_CHUNKS, 16>},
    {"fingerprints", misalign<D::VT_FINGERPRINTS, 8>},
};

constexpr BadBuffer kOtherBuffers[] = {
    {"no bytes", [](auto& d) { d.clear(); }, "directory of 0 bytes"},
    {"fifteen bytes", [](auto& d) { d.resize(15); }, "directory of 15 bytes"},
    {"no value_type, which is 0 then", set_entry<D::VT_VALUE_TYPE, 0>,
     "section values has 2 chunks, its streams of 0 bytes need 0"},
    {"no sources, which are 0 then", set_entry<D::VT_SOURCES, 0>, "directory has 19 strings, expected 17"},
};

constexpr BadBuffer kValidBuffers[] = {
    {"no label_type, which is 0 then", set_entry<D::VT_LABEL_TYPE, 0>},
    {"surfaces elsewhere", misalign<D::VT_SURFACES, 16>},
    {"sections elsewhere", misalign<D::VT_SECTIONS, 16>},
};

TEST(BadFiles, WithABadFlatBuffer) {
  const auto in_buffer = [](RawAtlas& a, const BadBuffer& row) { a.on_directory = row.change; };
  expect_faults(kNotBuffers, "F: invalid: directory is not a FlatBuffer of an atlas", in_buffer);
  expect_faults(kMisaligned, "F: invalid: directory tables are not aligned", in_buffer);
  expect_faults(kOtherBuffers, "F: invalid: {}", in_buffer);
  expect_faults(kValidBuffers, "", in_buffer);
}

TEST(BadFiles, WithAFieldLeftOut) {
  for (const char* field :
       {"source_grid", "source_to_storage", "display", "run_totals", "structures", "parents", "surfaces",
        "classes", "members", "scenes", "text_ends", "text", "sections", "chunks", "normals_fitted"}) {
    RawAtlas atlas = raw_atlas(good_file());
    atlas.directory.left_out = {field};
    expect_fault(atlas, "F: invalid: directory is not a FlatBuffer of an atlas", "", field);
  }
}

/// Overlapping tables are legal FlatBuffers. They must cost no more than their bytes.
TEST(BadFiles, WhoseTablesLieOverOneAnother) {
  RawAtlas atlas = raw_atlas(good_file());
  atlas.on_directory = [](Bytes& d) {
    const std::size_t members = vector_at(d, D::VT_MEMBERS), parents = field_at(d, D::VT_PARENTS);
    put(d, parents, static_cast<std::uint32_t>(members - parents));
  };
  EXPECT_EQ(fault_of_file(file_of(atlas)), "F: invalid: inconsistent offsets of directory table of parents");
}

}  // namespace
}  // namespace splatlas
