#include "tests/format/second_reader/flat_directory.h"

namespace splatlas::second {
namespace {

/// The root table; fields by their index in the schema.
class Table {
 public:
  explicit Table(const std::vector<std::byte>& bytes)
      : bytes_(bytes), at_(number_at<std::uint32_t>(bytes, 0)) {}

  /// Offset of a field; 0 if it is omitted.
  [[nodiscard]] std::size_t field(std::size_t place) const {
    const std::size_t fields = at_ - static_cast<std::size_t>(number_at<std::int32_t>(bytes_, at_));
    if (4 + 2 * place >= number_at<std::uint16_t>(bytes_, fields)) return 0;
    const std::uint16_t offset = number_at<std::uint16_t>(bytes_, fields + 4 + 2 * place);
    return offset == 0 ? 0 : at_ + offset;
  }
  /// Calls row(offset) for each row of a vector.
  template <typename Row>
  void for_each(std::size_t place, std::size_t row_bytes, const Row& row) const {
    const std::size_t at = field(place) + number_at<std::uint32_t>(bytes_, field(place));
    const auto rows = number_at<std::uint32_t>(bytes_, at);
    for (std::size_t n = 0; n < rows; ++n) row(at + 4 + n * row_bytes);
  }

 private:
  const std::vector<std::byte>& bytes_;
  std::size_t at_;
};

enum Field : std::size_t {
  kSourceGrid = 0,
  kSourceToStorage = 1,
  kValueType = 2,
  kClasses = 9,
  kMembers = 10,
  kSections = 15,
  kChunks = 16,
  kNormalsFitted = 17,
  kFingerprints = 18,
  kMeanBlocks = 24
};

ClassRow read_class(const std::vector<std::byte>& bytes, std::size_t at) {
  ClassRow row;
  row.voxels = number_at<std::uint64_t>(bytes, at);
  for (std::size_t a = 0; a < 3; ++a) {
    row.box_first[a] = number_at<std::int32_t>(bytes, at + 8 + 4 * a);
    row.box_last[a] = number_at<std::int32_t>(bytes, at + 20 + 4 * a);
    row.run_bytes[a] = number_at<std::uint32_t>(bytes, at + 32 + 4 * a);
  }
  return row;
}

}  // namespace

FlatDirectory read_directory(const std::vector<std::byte>& bytes) {
  const Table table(bytes);
  FlatDirectory directory;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto from = number_at<std::uint8_t>(bytes, table.field(kSourceToStorage) + a);
    directory.size[a] =
        number_at<std::int64_t>(bytes, table.field(kSourceGrid) + 120 + 8 * std::size_t{from});
  }
  if (const std::size_t at = table.field(kValueType); at != 0)
    directory.value_type = number_at<std::uint8_t>(bytes, at);
  std::vector<std::uint32_t> members;
  table.for_each(kMembers, 4,
                 [&](std::size_t at) { members.push_back(number_at<std::uint32_t>(bytes, at)); });
  std::ptrdiff_t begin = 0;
  table.for_each(kClasses, 48, [&](std::size_t at) {
    ClassRow row = read_class(bytes, at);
    const auto end = static_cast<std::ptrdiff_t>(number_at<std::uint32_t>(bytes, at + 44));
    row.members.assign(members.begin() + begin, members.begin() + end);
    begin = end;
    directory.classes.push_back(std::move(row));
  });
  std::size_t c = 0;
  table.for_each(kNormalsFitted, 1, [&](std::size_t at) {
    directory.classes.at(c++).normals_fitted = number_at<std::uint8_t>(bytes, at) == 1;
  });
  table.for_each(kFingerprints, 8, [&](std::size_t at) {
    directory.fingerprints.push_back(number_at<std::uint64_t>(bytes, at));
  });
  if (table.field(kMeanBlocks) != 0) {
    table.for_each(kMeanBlocks, 4, [&](std::size_t at) {
      directory.mean_blocks.push_back(number_at<std::uint32_t>(bytes, at));
    });
  }
  table.for_each(kSections, 16, [&](std::size_t at) {
    directory.sections.push_back(
        {number_at<std::uint32_t>(bytes, at), number_at<std::uint32_t>(bytes, at + 4),
         number_at<std::uint32_t>(bytes, at + 8), number_at<std::uint32_t>(bytes, at + 12)});
  });
  table.for_each(kChunks, 16, [&](std::size_t at) {
    directory.chunks.push_back({number_at<std::uint64_t>(bytes, at), number_at<std::uint32_t>(bytes, at + 8),
                                number_at<std::uint8_t>(bytes, at + 12),
                                number_at<std::uint8_t>(bytes, at + 13)});
  });
  return directory;
}

}  // namespace splatlas::second
