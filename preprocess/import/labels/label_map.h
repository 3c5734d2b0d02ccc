// Structures of a label map.
#pragma once

#include <string>

#include "preprocess/import/images/pixels/source_image.h"
#include "preprocess/import/labels/imported_labels.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

/// Every value above 0 is a structure: named by the file's segments, else "Label 7". `name` stands for the
/// file in messages. kFailed, with the value, for labels that are negative, fractional, or 2^32 and above;
/// for several layers; and for grey values: at least 64 values of which neighbours mostly differ. Cost: two
/// passes.
[[nodiscard]] Result<ImportedLabels> read_label_map(SourceImage image, const std::string& name);

/// Gives structures the names, codes, colours and terms of `names`: by label, or masks by name or key. Notes
/// count labels without a name and names without voxels; those are dropped, or become empty structures with
/// `keeps_empty`.
void name_labels(ImportedLabels& labels, std::vector<LabelName> names, bool keeps_empty);

}  // namespace splatlas
