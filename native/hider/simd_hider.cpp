// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/hider.h"

namespace granita {

std::unique_ptr<Hider> make_simd_hider(const HiderFrame& frame, const Rect& tiles,
                                       const Rect& pixels) {
    return make_reference_hider(frame, tiles, pixels);
}

}  // namespace granita
