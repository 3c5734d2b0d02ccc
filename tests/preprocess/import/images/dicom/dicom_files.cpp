// DICOM files of tests: images, segmentations, and identifiers in them.
#include "tests/preprocess/import/images/dicom/dicom_files.h"

#include <memory>
#include <stdexcept>

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dcrleerg.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmjpeg/djencode.h>
#include <dcmtk/dcmjpeg/djrplol.h>
#include <dcmtk/dcmjpls/djencode.h>
#include <dcmtk/dcmjpls/djrparam.h>
#include <fmt/format.h>

namespace splatlas {
namespace {

// Parts of DICOM files, by DCMTK. They throw std::runtime_error.

void must(const OFCondition& status, const char* what) {
  if (status.bad()) throw std::runtime_error(fmt::format("{}: {}", what, status.text()));
}

void put(DcmItem& item, const DcmTagKey& key, const std::string& text) {
  DcmTag tag(key);
  if (tag.isPrivate()) tag.setVR(EVR_LO);
  if (tag.getEVR() == EVR_xs) tag.setVR(EVR_US);  // as the pixels
  must(item.putAndInsertString(tag, text.c_str()), "put");
}

DcmItem& item_of(DcmItem& parent, const DcmTagKey& sequence, long number = -2) {
  DcmItem* item = nullptr;
  must(parent.findOrCreateSequenceItem(sequence, item, number), "item");
  return *item;
}

std::string joined(const auto& numbers) {
  std::string text;
  for (const auto& number : numbers) text += (text.empty() ? "" : "\\") + fmt::format("{:.10g}", number);
  return text;
}

void put_pixel_format(DcmItem& item, int columns, int rows, int allocated, int stored, int high,
                      bool is_signed) {
  put(item, DCM_SamplesPerPixel, "1");
  put(item, DCM_PhotometricInterpretation, "MONOCHROME2");
  put(item, DCM_Rows, std::to_string(rows));
  put(item, DCM_Columns, std::to_string(columns));
  put(item, DCM_BitsAllocated, std::to_string(allocated));
  put(item, DCM_BitsStored, std::to_string(stored));
  put(item, DCM_HighBit, std::to_string(high));
  put(item, DCM_PixelRepresentation, is_signed ? "1" : "0");
}

void put_series(DcmItem& item, const std::string& class_uid, const std::string& modality) {
  static int instance = 0;
  put(item, DCM_SOPClassUID, class_uid);
  put(item, DCM_SOPInstanceUID, "1.2.3.4." + std::to_string(++instance));
  put(item, DCM_Modality, modality);
  put(item, DCM_SeriesInstanceUID, "1.2.3");
  put(item, DCM_SeriesNumber, "7");
}

void save(DcmFileFormat& file, const std::filesystem::path& path, E_TransferSyntax syntax) {
  must(file.saveFile(path.c_str(), syntax), "save");
}

DcmItem& add_plane(DcmItem& groups, const Vec3& position) {
  put(item_of(groups, DCM_PlanePositionSequence), DCM_ImagePositionPatient, joined(position));
  return groups;
}

void add_shared_planes(DcmItem& shared, const std::string& spacing, double slice_spacing,
                       const std::array<double, 6>& axes = {1, 0, 0, 0, 1, 0}) {
  put(item_of(shared, DCM_PlaneOrientationSequence), DCM_ImageOrientationPatient, joined(axes));
  DcmItem& measures = item_of(shared, DCM_PixelMeasuresSequence);
  put(measures, DCM_PixelSpacing, spacing);
  if (slice_spacing > 0) put(measures, DCM_SpacingBetweenSlices, fmt::format("{}", slice_spacing));
}

E_TransferSyntax syntax_of(TestCoding coding) {
  switch (coding) {
    case TestCoding::kImplicit: return EXS_LittleEndianImplicit;
    case TestCoding::kBigEndian: return EXS_BigEndianExplicit;
    case TestCoding::kDeflated: return EXS_DeflatedLittleEndianExplicit;
    case TestCoding::kRunLengths: return EXS_RLELossless;
    case TestCoding::kJpegLossless: return EXS_JPEGProcess14SV1;
    case TestCoding::kJpegLs: return EXS_JPEGLSLossless;
    case TestCoding::kJpeg2000: return EXS_JPEG2000LosslessOnly;
    case TestCoding::kExplicit: break;
  }
  return EXS_LittleEndianExplicit;
}

void register_encoders() {
  static const bool done = [] {
    DcmRLEEncoderRegistration::registerCodecs();
    DJEncoderRegistration::registerCodecs();
    DJLSEncoderRegistration::registerCodecs();
    return true;
  }();
  static_cast<void>(done);
}

/// DCMTK has no encoder of JPEG 2000.
void put_jpeg_2000(DcmDataset& dataset, const TestSlice& slice) {
  std::vector<std::int32_t> values;
  for (const std::uint16_t stored : slice.stored)
    values.push_back(slice.is_signed ? static_cast<std::int16_t>(stored) : stored);
  std::string bytes =
      encoded_jpeg_2000(values, TestSlice::kColumns, TestSlice::kRows, slice.bits_stored, slice.is_signed);
  if (bytes.size() % 2 != 0) bytes.push_back('\0');
  auto pixels = std::make_unique<DcmPixelData>(DCM_PixelData);
  auto sequence = std::make_unique<DcmPixelSequence>(DCM_PixelSequenceTag);
  must(sequence->insert(new DcmPixelItem(DCM_PixelItemTag)), "table of frames");  // owned by the sequence
  DcmOffsetList offsets;
  must(sequence->storeCompressedFrame(offsets, reinterpret_cast<Uint8*>(bytes.data()),
                                      static_cast<Uint32>(bytes.size()), 0),
       "frame");
  pixels->putOriginalRepresentation(EXS_JPEG2000LosslessOnly, nullptr, sequence.release());
  must(dataset.insert(pixels.release(), OFTrue), "pixels");
}

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

void write_slice(const TestSlice& slice, const std::filesystem::path& path, TestCoding coding) {
  register_encoders();
  DcmFileFormat file;
  DcmDataset& dataset = *file.getDataset();
  put_series(dataset, slice.class_uid, "CT");
  put(dataset, DCM_ImagePositionPatient, joined(slice.position));
  put(dataset, DCM_ImageOrientationPatient, joined(slice.axes));
  put(dataset, DCM_PixelSpacing, joined(slice.spacing));
  put_pixel_format(dataset, TestSlice::kColumns, TestSlice::kRows, slice.bits_allocated, slice.bits_stored,
                   slice.high_bit, slice.is_signed);
  const E_TransferSyntax syntax = syntax_of(coding);
  if (coding == TestCoding::kJpeg2000) {
    put_jpeg_2000(dataset, slice);
  } else if (slice.bits_allocated == 8) {
    const std::vector<Uint8> bytes(slice.stored.begin(), slice.stored.end());
    must(dataset.putAndInsertUint8Array(DCM_PixelData, bytes.data(), bytes.size()), "pixels");
  } else {
    must(dataset.putAndInsertUint16Array(DCM_PixelData, slice.stored.data(), slice.stored.size()), "pixels");
  }
  for (const auto& [tag, text] : slice.texts) put(dataset, DcmTagKey(tag.group, tag.element), text);
  for (const DicomTag& tag : slice.erased)
    must(dataset.findAndDeleteElement(DcmTagKey(tag.group, tag.element)), "erase");
  if (coding == TestCoding::kJpegLossless) {
    const DJ_RPLossless lossless;
    must(dataset.chooseRepresentation(syntax, &lossless), "JPEG");
  } else if (coding == TestCoding::kJpegLs) {
    const DJLSRepresentationParameter lossless(0, OFTrue);
    must(dataset.chooseRepresentation(syntax, &lossless), "JPEG-LS");
  } else if (coding == TestCoding::kRunLengths) {
    must(dataset.chooseRepresentation(syntax, nullptr), "RLE");
  }
  save(file, path, syntax);
}

void write_enhanced(const std::vector<TestFrame>& frames, const std::filesystem::path& path) {
  DcmFileFormat file;
  DcmDataset& dataset = *file.getDataset();
  put_series(dataset, "1.2.840.10008.5.1.4.1.1.4.1", "MR");
  put_pixel_format(dataset, TestSlice::kColumns, TestSlice::kRows, 16, 16, 15, false);
  put(dataset, DCM_NumberOfFrames, std::to_string(frames.size()));
  add_shared_planes(item_of(dataset, DCM_SharedFunctionalGroupsSequence), "0.5\\0.5", 0);
  std::vector<Uint16> pixels;
  for (const TestFrame& frame : frames) {
    DcmItem& groups = add_plane(item_of(dataset, DCM_PerFrameFunctionalGroupsSequence), frame.position);
    DcmItem& scale = item_of(groups, DCM_PixelValueTransformationSequence);
    put(scale, DCM_RescaleSlope, fmt::format("{}", frame.slope));
    put(scale, DCM_RescaleIntercept, fmt::format("{}", frame.intercept));
    put(item_of(groups, DCM_MRImageFrameTypeSequence), DCM_FrameType, frame.type);
    pixels.insert(pixels.end(), frame.stored.begin(), frame.stored.end());
  }
  must(dataset.putAndInsertUint16Array(DCM_PixelData, pixels.data(), pixels.size()), "pixels");
  save(file, path, EXS_LittleEndianExplicit);
}

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
      put(contour, DCM_ContourGeometricType, points.size() == 1 ? "POINT" : "CLOSED_PLANAR");
      std::vector<double> numbers;
      for (const Vec3& point : points) numbers.insert(numbers.end(), point.begin(), point.end());
      put(contour, DCM_ContourData, joined(numbers));
    }
  }
  save(file, path, EXS_LittleEndianImplicit);
}

std::size_t plant_identifiers(const std::filesystem::path& path) {
  DcmFileFormat file;
  must(file.loadFile(path.c_str()), "load");
  DcmDataset& dataset = *file.getDataset();
  must(dataset.loadAllDataIntoMemory(), "load");
  std::vector<DcmTagKey> keys;
  DcmDataDictionary& dictionary = dcmDataDict.wrlock();  // its iterators are not const
  for (auto entry = dictionary.normalBegin(); entry != dictionary.normalEnd(); ++entry) {
    const DcmDictEntry& attribute = **entry;
    const DcmEVR type = attribute.getEVR();
    const bool is_text = type == EVR_PN || type == EVR_LO || type == EVR_SH || type == EVR_LT ||
                         type == EVR_ST || type == EVR_UT || type == EVR_UC || type == EVR_AE ||
                         type == EVR_UI;
    const Uint16 group = attribute.getGroup();
    if (is_text && group >= 0x0008 && group < 0x7fe0 && attribute.getPrivateCreator() == nullptr)
      keys.push_back(attribute.getKey());
  }
  dcmDataDict.wrunlock();
  std::size_t planted = 0;
  for (const DcmTagKey& key : keys) {
    // UTF-8 is needed to read labels, and the class tells what the file is.
    if (key == DCM_SpecificCharacterSet || key == DCM_SOPClassUID) continue;
    if (dataset.tagExists(key) && key != DCM_SeriesInstanceUID) continue;
    const bool is_uid = DcmTag(key).getEVR() == EVR_UI;
    put(dataset, key, is_uid ? "9.8.7.6." + std::to_string(planted) : "PLANTED" + std::to_string(planted));
    ++planted;
  }
  put(dataset, DCM_SeriesInstanceUID, "9.8.7.6");
  for (unsigned n = 0; n < 20; ++n) {
    put(dataset, DcmTagKey(0x0009, static_cast<Uint16>(0x0010 + n)), "PLANTED creator");
    put(dataset, DcmTagKey(0x0009, static_cast<Uint16>(0x1000 + 0x100 * n)), "PLANTED private");
    planted += 2;
  }
  save(file, path, EXS_LittleEndianExplicit);
  return planted;
}

}  // namespace splatlas
