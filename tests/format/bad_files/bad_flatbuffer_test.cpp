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

/// Offset of a field of the table, by its entry in the vtable.
std::size_t field_at(const Bytes& bytes, std::size_t vtable_entry) {
  const std::size_t table = table_at(bytes);
  const std::size_t vtable = table - static_cast<std::size_t>(number_at<std::int32_t>(bytes, table));
  return table + number_at<std::uint16_t>(bytes, vtable + vtable_entry);
}

/// Offset of the length of a vector.
std::size_t vector_at(const Bytes& bytes, std::size_t vtable_entry) {
  const std::size_t field = field_at(bytes, vtable_entry);
  return field + number_at<std::uint32_t>(bytes, field);
}

template <std::size_t entry, std::uint32_t length>
void set_length(RawAtlas& a) {
  a.on_directory = [](Bytes& d) { put(d, vector_at(d, entry), length); };
}

template <std::size_t entry, std::uint32_t offset>
void set_offset(RawAtlas& a) {
  a.on_directory = [](Bytes& d) { put(d, field_at(d, entry), offset); };
}

/// Copies a vector to the end of the buffer, four bytes off its alignment.
template <std::size_t entry, std::size_t row_bytes>
void misalign(RawAtlas& a) {
  a.on_directory = [](Bytes& d) {
    const std::size_t from = vector_at(d, entry);
    const std::size_t bytes = 4 + number_at<std::uint32_t>(d, from) * row_bytes;
    const Bytes copy(d.begin() + static_cast<std::ptrdiff_t>(from),
                     d.begin() + static_cast<std::ptrdiff_t>(from + bytes));
    d.resize((d.size() + 7) / 8 * 8);
    const std::size_t field = field_at(d, entry);
    put(d, field, static_cast<std::uint32_t>(d.size() - field));
    d.insert(d.end(), copy.begin(), copy.end());
  };
}

template <std::size_t entry>
constexpr auto kNoField = [](RawAtlas& a) {
  a.on_directory = [](Bytes& d) {
    const std::size_t table = table_at(d);
    const std::size_t vtable = table - static_cast<std::size_t>(number_at<std::int32_t>(d, table));
    put(d, vtable + entry, std::uint16_t{0});
  };
};

using D = schema::Directory;

constexpr BadFile kBuffers[] = {
    {"no bytes", [](RawAtlas& a) { a.on_directory = [](Bytes& d) { d.clear(); }; },
     "F: invalid: directory of 0 bytes"},
    {"fifteen bytes", [](RawAtlas& a) { a.on_directory = [](Bytes& d) { d.resize(15); }; },
     "F: invalid: directory of 15 bytes"},
    {"sixteen bytes", [](RawAtlas& a) { a.on_directory = [](Bytes& d) { d.resize(16); }; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"half", [](RawAtlas& a) { a.on_directory = [](Bytes& d) { d.resize(d.size() / 2); }; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"all but eight bytes",
     [](RawAtlas& a) { a.on_directory = [](Bytes& d) { d.erase(d.end() - 8, d.end()); }; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"zeros", [](RawAtlas& a) { a.on_directory = [](Bytes& d) { d.assign(d.size(), std::byte{0}); }; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"ones", [](RawAtlas& a) { a.on_directory = [](Bytes& d) { d.assign(d.size(), std::byte{255}); }; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"another identifier", [](RawAtlas& a) { a.on_directory = [](Bytes& d) { d[4] = std::byte{'s'}; }; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"a root beyond the end",
     [](RawAtlas& a) { a.on_directory = [](Bytes& d) { put(d, 0, static_cast<std::uint32_t>(d.size())); }; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"a root at the largest offset",
     [](RawAtlas& a) { a.on_directory = [](Bytes& d) { put(d, 0, 0xffffffffu); }; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"a root at 0", [](RawAtlas& a) { a.on_directory = [](Bytes& d) { put(d, 0, 0u); }; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"a root not aligned",
     [](RawAtlas& a) {
       a.on_directory = [](Bytes& d) { put(d, 0, static_cast<std::uint32_t>(table_at(d) + 2)); };
     },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"a table of fields before the beginning",
     [](RawAtlas& a) { a.on_directory = [](Bytes& d) { put(d, table_at(d), 0x7fffffff); }; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"a table of fields beyond the end",
     [](RawAtlas& a) { a.on_directory = [](Bytes& d) { put(d, table_at(d), -0x7fffffff); }; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"a table of fields of an odd length",
     [](RawAtlas& a) {
       a.on_directory = [](Bytes& d) {
         const auto t = table_at(d);
         put(d, t - static_cast<std::size_t>(number_at<std::int32_t>(d, t)), std::uint16_t{5});
       };
     },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"a table of fields of the largest length",
     [](RawAtlas& a) {
       a.on_directory = [](Bytes& d) {
         const auto t = table_at(d);
         put(d, t - static_cast<std::size_t>(number_at<std::int32_t>(d, t)), std::uint16_t{0xfffe});
       };
     },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"a field beyond the table",
     [](RawAtlas& a) {
       a.on_directory = [](Bytes& d) {
         const auto t = table_at(d);
         put(d, t - static_cast<std::size_t>(number_at<std::int32_t>(d, t)) + D::VT_SOURCE_GRID,
             std::uint16_t{0xfff0});
       };
     },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
};

constexpr BadFile kLeftOut[] = {
    {"source_grid", [](RawAtlas& a) { a.directory.left_out = {"source_grid"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"source_to_storage", [](RawAtlas& a) { a.directory.left_out = {"source_to_storage"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"display", [](RawAtlas& a) { a.directory.left_out = {"display"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"run_totals", [](RawAtlas& a) { a.directory.left_out = {"run_totals"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"structures", [](RawAtlas& a) { a.directory.left_out = {"structures"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"parents", [](RawAtlas& a) { a.directory.left_out = {"parents"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"surfaces", [](RawAtlas& a) { a.directory.left_out = {"surfaces"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"classes", [](RawAtlas& a) { a.directory.left_out = {"classes"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"members", [](RawAtlas& a) { a.directory.left_out = {"members"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"scenes", [](RawAtlas& a) { a.directory.left_out = {"scenes"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"text_ends", [](RawAtlas& a) { a.directory.left_out = {"text_ends"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"text", [](RawAtlas& a) { a.directory.left_out = {"text"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"sections", [](RawAtlas& a) { a.directory.left_out = {"sections"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"chunks", [](RawAtlas& a) { a.directory.left_out = {"chunks"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"normals_fitted", [](RawAtlas& a) { a.directory.left_out = {"normals_fitted"}; },
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"value_type, which is 0 then", [](RawAtlas& a) { kNoField<D::VT_VALUE_TYPE>(a); },
     "F: invalid: section values has 2 chunks, its streams of 0 bytes need 0"},
    {"label_type, which is 0 then, as it may be", [](RawAtlas& a) { kNoField<D::VT_LABEL_TYPE>(a); }, ""},
    {"sources, which are 0 then", [](RawAtlas& a) { kNoField<D::VT_SOURCES>(a); },
     "F: invalid: directory has 19 strings, expected 17"},
};

constexpr BadFile kVectors[] = {
    {"structures of the largest length", set_length<D::VT_STRUCTURES, 0xffffffff>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"structures of a length that wraps around", set_length<D::VT_STRUCTURES, 0x10000001>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"parents of the largest length", set_length<D::VT_PARENTS, 0xffffffff>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"parents of a length that wraps around", set_length<D::VT_PARENTS, 0x40000001>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"surfaces of the largest length", set_length<D::VT_SURFACES, 0xffffffff>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"classes of the largest length", set_length<D::VT_CLASSES, 0xffffffff>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"classes of a length beyond the end", set_length<D::VT_CLASSES, 1000>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"members of the largest length", set_length<D::VT_MEMBERS, 0xffffffff>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"scenes of the largest length", set_length<D::VT_SCENES, 0xffffffff>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"ends of text of the largest length", set_length<D::VT_TEXT_ENDS, 0xffffffff>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"text of the largest length", set_length<D::VT_TEXT, 0xffffffff>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"sections of the largest length", set_length<D::VT_SECTIONS, 0xffffffff>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"chunks of the largest length", set_length<D::VT_CHUNKS, 0xffffffff>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"flags of the largest length", set_length<D::VT_NORMALS_FITTED, 0xffffffff>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"structures beyond the end", set_offset<D::VT_STRUCTURES, 0x10000000>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"parents at the largest offset", set_offset<D::VT_PARENTS, 0xfffffffc>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"classes at their own field", set_offset<D::VT_CLASSES, 0>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"text not aligned", set_offset<D::VT_TEXT, 5>, "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"chunks at the largest signed offset", set_offset<D::VT_CHUNKS, 0x7ffffffc>,
     "F: invalid: directory is not a FlatBuffer of an atlas"},
    {"structures not aligned to their rows", misalign<D::VT_STRUCTURES, 16>,
     "F: invalid: directory tables are not aligned"},
    {"classes not aligned to their rows", misalign<D::VT_CLASSES, 48>,
     "F: invalid: directory tables are not aligned"},
    {"scenes not aligned to their rows", misalign<D::VT_SCENES, 24>,
     "F: invalid: directory tables are not aligned"},
    {"chunks not aligned to their rows", misalign<D::VT_CHUNKS, 16>,
     "F: invalid: directory tables are not aligned"},
    {"surfaces elsewhere, which may be", misalign<D::VT_SURFACES, 16>, ""},
    {"sections elsewhere, which may be", misalign<D::VT_SECTIONS, 16>, ""},
};

TEST(BadFiles, WithABadFlatBuffer) {
  expect_refused(kBuffers);
}
TEST(BadFiles, WithAFieldLeftOut) {
  expect_refused(kLeftOut);
}
TEST(BadFiles, WithABadVector) {
  expect_refused(kVectors);
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
