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
/// bicubically. Writes the pixels of a region. Cost: linear in its pixels, plus shares at borders between
/// structures and at fragments.
void resolve_ids(const SheetShares& shares, const Shear& shear, const FragmentsInVolume& fragments,
                 const FragmentShares& of_fragments, const PixelBox& region, const Picture& picture,
                 IdImage& ids, ThreadPool& pool);
/// Gives visible pixels at rims that no sheet pixel of the shares reaches the structure of their densest
/// neighbour.
void fill_rims(const Picture& picture, IdImage& ids);

}  // namespace splatlas
