// Identifiers in DICOM files of tests.
#include "tests/preprocess/import/images/dicom/dicom_writer.h"

namespace splatlas {

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
