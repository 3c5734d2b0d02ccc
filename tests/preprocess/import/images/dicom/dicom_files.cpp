#include "tests/preprocess/import/images/dicom/dicom_files.h"

#include <memory>

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dcrleerg.h>
#include <dcmtk/dcmjpeg/djencode.h>
#include <dcmtk/dcmjpeg/djrplol.h>
#include <dcmtk/dcmjpls/djencode.h>
#include <dcmtk/dcmjpls/djrparam.h>

#include "tests/preprocess/import/images/dicom/dicom_writer.h"

namespace splatlas {
namespace {

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

}  // namespace splatlas
