#include "preprocess/import/images/nifti/nifti_header.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

/// Numbers at byte offsets, in the byte order of the file.
class Fields {
 public:
  Fields(std::span<const std::byte> bytes, bool is_swapped) : bytes_(bytes), is_swapped_(is_swapped) {}

  template <typename T>
  [[nodiscard]] T get(std::size_t offset) const {
    std::array<std::byte, sizeof(T)> field{};
    std::ranges::copy(bytes_.subspan(offset, sizeof(T)), field.begin());
    if (is_swapped_) std::ranges::reverse(field);
    T value;
    std::memcpy(&value, field.data(), sizeof(T));
    return value;
  }
  /// `numbers.size()` numbers of type T, one after another.
  template <typename T, typename Numbers>
  void get_all(std::size_t offset, Numbers& numbers) const {
    for (std::size_t n = 0; n < numbers.size(); ++n) {
      numbers[n] = static_cast<typename Numbers::value_type>(get<T>(offset + n * sizeof(T)));
    }
  }

 private:
  std::span<const std::byte> bytes_;
  bool is_swapped_;
};

std::string_view text_at(std::span<const std::byte> bytes, std::size_t offset, std::size_t length) {
  return {reinterpret_cast<const char*>(bytes.data()) + offset, length};
}

/// NIfTI-1 and Analyze: offsets in nifti1.h.
void read_short_header(const Fields& fields, NiftiHeader& header) {
  fields.get_all<std::int16_t>(40, header.dim);
  header.intent = fields.get<std::int16_t>(68);
  header.datatype = fields.get<std::int16_t>(70);
  header.bits_per_voxel = fields.get<std::int16_t>(72);
  fields.get_all<float>(76, header.pixdim);
  header.voxel_offset = double{fields.get<float>(108)};
  if (header.kind == NiftiHeader::Kind::kAnalyze) return;
  header.slope = double{fields.get<float>(112)};
  header.intercept = double{fields.get<float>(116)};
  header.units = fields.get<std::uint8_t>(123);
  header.qform_code = fields.get<std::int16_t>(252);
  header.sform_code = fields.get<std::int16_t>(254);
  fields.get_all<float>(256, header.quaternion);
  fields.get_all<float>(268, header.qform_offset);
  fields.get_all<float>(280, header.sform);
}

/// NIfTI-2: offsets in nifti2.h.
void read_long_header(const Fields& fields, NiftiHeader& header) {
  header.datatype = fields.get<std::int16_t>(12);
  header.bits_per_voxel = fields.get<std::int16_t>(14);
  fields.get_all<std::int64_t>(16, header.dim);
  fields.get_all<double>(104, header.pixdim);
  header.voxel_offset = static_cast<double>(fields.get<std::int64_t>(168));
  header.slope = fields.get<double>(176);
  header.intercept = fields.get<double>(184);
  header.qform_code = fields.get<std::int32_t>(344);
  header.sform_code = fields.get<std::int32_t>(348);
  fields.get_all<double>(352, header.quaternion);
  fields.get_all<double>(376, header.qform_offset);
  fields.get_all<double>(400, header.sform);
  header.units = fields.get<std::int32_t>(500);
  header.intent = fields.get<std::int32_t>(504);
}

}  // namespace

double NiftiHeader::mm_per_unit() const {
  constexpr std::int64_t kMetre = 1, kMicron = 3, kSpaceBits = 7;
  switch (units & kSpaceBits) {
    case kMetre: return 1e3;
    case kMicron: return 1e-3;
    default: return 1;
  }
}

Result<NiftiHeader> parse_nifti_header(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  if (bytes.size() < NiftiHeader::kNifti1Bytes) return bad_file(path, "is not a NIfTI file (too short)");
  NiftiHeader header;
  const auto size_is = [&](std::int32_t size) {
    for (const bool is_swapped : {false, true}) {
      if (Fields(bytes, is_swapped).get<std::int32_t>(0) != size) continue;
      header.is_swapped = is_swapped;
      return true;
    }
    return false;
  };
  const std::string_view magic = text_at(bytes, 344, 4), magic2 = text_at(bytes, 4, 4);
  if (size_is(NiftiHeader::kMaxBytes) && bytes.size() >= NiftiHeader::kMaxBytes &&
      (magic2 == std::string_view("n+2\0", 4) || magic2 == std::string_view("ni2\0", 4))) {
    header.kind = NiftiHeader::Kind::kNifti2;
    header.is_pair = magic2[1] == 'i';
    read_long_header(Fields(bytes, header.is_swapped), header);
  } else if (size_is(NiftiHeader::kNifti1Bytes)) {
    const bool is_nifti = magic == std::string_view("n+1\0", 4) || magic == std::string_view("ni1\0", 4);
    header.kind = is_nifti ? NiftiHeader::Kind::kNifti1 : NiftiHeader::Kind::kAnalyze;
    header.is_pair = !is_nifti || magic[1] == 'i';
    read_short_header(Fields(bytes, header.is_swapped), header);
  } else {
    return bad_file(path, "is neither a NIfTI nor an Analyze file (its header has no such length)");
  }
  constexpr std::int64_t kFirstConnectivity = 3000, kLastConnectivity = 3099;
  if (header.intent >= kFirstConnectivity && header.intent <= kLastConnectivity) {
    return bad_file(path, "is a CIFTI file (intent {}) of values on surfaces, and holds no volume",
                    header.intent);
  }
  if (header.dim[0] < 2 || header.dim[0] > 7)
    return bad_file(path, "has {} dimensions; a volume has 2 or 3", header.dim[0]);
  return header;
}

}  // namespace splatlas
