// DICOM segmentations of tests.
#include "tests/preprocess/import/images/dicom/dicom_writer.h"

namespace splatlas {
namespace {

void put_code(DcmItem& item, const std::string& scheme, const std::string& value) {
  put(item, DCM_CodingSchemeDesignator, scheme);
  put(item, DCM_CodeValue, value);
  put(item, DCM_CodeMeaning, "PLANTED meaning");
}

void add_segment(DcmItem& item, const TestSegment& segment) {
  put(item, DCM_SegmentNumber, std::to_string(segment.number));
  put(item, DCM_SegmentLabel, segment.label);
  put(item, DCM_SegmentDescription, "PLANTED description");
  if (segment.lab[0] != 0)
    must(item.putAndInsertUint16Array(DCM_RecommendedDisplayCIELabValue, segment.lab.data(), 3), "colour");
  if (segment.code.empty()) return;
  DcmItem& type = item_of(item, DCM_SegmentedPropertyTypeCodeSequence);
  put_code(type, segment.scheme, segment.code);
  if (!segment.modifier.empty())
    put_code(item_of(type, DCM_SegmentedPropertyTypeModifierCodeSequence), segment.scheme, segment.modifier);
}

std::vector<Uint8> packed(const TestSegmentation& segmentation) {
  std::vector<Uint8> bytes;
  std::size_t bit = 0;
  for (const TestSegmentFrame& frame : segmentation.frames) {
    for (const std::uint16_t value : frame.values) {
      if (segmentation.bits == 1) {
        if (bit % 8 == 0) bytes.push_back(0);
        bytes.back() = static_cast<Uint8>(bytes.back() | (value << (bit % 8)));
        ++bit;
      } else {
        bytes.push_back(static_cast<Uint8>(value & 0xff));
        if (segmentation.bits == 16) bytes.push_back(static_cast<Uint8>(value >> 8));
      }
    }
  }
  if (bytes.size() % 2 != 0) bytes.push_back(0);
  return bytes;
}

}  // namespace

void write_segmentation(const TestSegmentation& segmentation, const std::filesystem::path& path) {
  DcmFileFormat file;
  DcmDataset& dataset = *file.getDataset();
  const bool is_label_map = segmentation.type == "LABELMAP";
  put_series(dataset, is_label_map ? "1.2.840.10008.5.1.4.1.1.66.7" : UID_SegmentationStorage, "SEG");
  put(dataset, DCM_SegmentationType, segmentation.type);
  if (segmentation.type == "FRACTIONAL") put(dataset, DCM_MaximumFractionalValue, "200");
  put_pixel_format(dataset, TestSegmentation::kColumns, TestSegmentation::kRows, segmentation.bits,
                   segmentation.bits, segmentation.bits - 1, false);
  put(dataset, DCM_NumberOfFrames, std::to_string(segmentation.frames.size()));
  for (const TestSegment& segment : segmentation.segments)
    add_segment(item_of(dataset, DCM_SegmentSequence), segment);
  add_shared_planes(item_of(dataset, DCM_SharedFunctionalGroupsSequence), "1\\1", segmentation.slice_spacing,
                    segmentation.axes);
  for (const TestSegmentFrame& frame : segmentation.frames) {
    Vec3 position = segmentation.origin;
    for (std::size_t a = 0; a < 3; ++a) position[a] += frame.z * segmentation.normal[a];
    DcmItem& groups = add_plane(item_of(dataset, DCM_PerFrameFunctionalGroupsSequence), position);
    if (!is_label_map)
      put(item_of(groups, DCM_SegmentIdentificationSequence), DCM_ReferencedSegmentNumber,
          std::to_string(frame.segment));
  }
  for (const auto& [tag, text] : segmentation.texts) put(dataset, DcmTagKey(tag.group, tag.element), text);
  const std::vector<Uint8> bytes = packed(segmentation);
  if (segmentation.bits == 16) {
    must(dataset.putAndInsertUint16Array(DCM_PixelData, reinterpret_cast<const Uint16*>(bytes.data()),
                                         bytes.size() / 2),
         "pixels");
  } else {
    must(dataset.putAndInsertUint8Array(DCM_PixelData, bytes.data(), bytes.size()), "pixels");
  }
  save(file, path, EXS_LittleEndianExplicit);
}

void write_contours(const std::vector<TestRegion>& regions, const std::filesystem::path& path,
                    const std::string& frame_of_reference) {
  DcmFileFormat file;
  DcmDataset& dataset = *file.getDataset();
  put_series(dataset, UID_RTStructureSetStorage, "RTSTRUCT");
  for (std::size_t n = 0; n < regions.size(); ++n) {
    DcmItem &structure = item_of(dataset, DCM_StructureSetROISequence),
            &contours = item_of(dataset, DCM_ROIContourSequence);
    put(structure, DCM_ROINumber, std::to_string(n + 3));
    put(structure, DCM_ROIName, regions[n].name);
    put(structure, DCM_ReferencedFrameOfReferenceUID, frame_of_reference);
    put(contours, DCM_ReferencedROINumber, std::to_string(n + 3));
    put(contours, DCM_ROIDisplayColor, "10\\20\\30");
    for (const std::vector<Vec3>& points : regions[n].contours) {
      DcmItem& contour = item_of(contours, DCM_ContourSequence);
      put(contour, DCM_ContourGeometricType, regions[n].type);
      std::vector<double> numbers;
      for (const Vec3& point : points) numbers.insert(numbers.end(), point.begin(), point.end());
      put(contour, DCM_ContourData, joined(numbers));
    }
  }
  save(file, path, EXS_LittleEndianImplicit);
}

}  // namespace splatlas
