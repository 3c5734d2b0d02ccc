// Id image of a frame of sheets.
#pragma once

#include "format/tasks/thread_pool.h"
#include "player/picture.h"
#include "player/render/contributions/fragment_shares.h"
#include "player/render/sheets/ids/sheet_shares.h"
#include "player/render/sheets/warp/resolve.h"
#include "player/render/view/shear.h"

namespace splatlas {

/// Finds the structure with the largest share of each pixel of a resolved picture, front faces, fragments,
/// volume and back faces together. Shares are interpolated in the sheet as in resolve(), but never
/// bicubically. Cost: linear in pixels, plus shares at borders between structures and at fragments.
void resolve_ids(const SheetShares& shares, const Shear& shear, const FragmentsInVolume& fragments,
                 const FragmentShares& of_fragments, const Picture& picture, IdImage& ids, ThreadPool& pool);

}  // namespace splatlas
