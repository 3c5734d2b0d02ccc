// Id image of a frame of sheets.
#pragma once

#include "format/system/thread_pool.h"
#include "player/picture.h"
#include "player/sheets/fragment_shares.h"
#include "player/sheets/resolve.h"
#include "player/sheets/sheet_shares.h"
#include "player/view/shear.h"

namespace splatlas {

/// Finds the structure with the largest share of each pixel of a resolved picture, front faces, fragments,
/// volume and back faces together. Shares are interpolated in the sheet as in resolve(), but never
/// bicubically. Cost: linear in pixels, plus shares at borders between structures and at fragments.
void resolve_ids(const SheetShares& shares, const Shear& shear, const FragmentsInVolume& fragments,
                 const FragmentShares& of_fragments, const Picture& picture, IdImage& ids, ThreadPool& pool);

}  // namespace splatlas
