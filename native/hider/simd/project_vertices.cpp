// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/simd/project_vertices.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hider/simd/project_vertices.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace granita {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Arrays end in kLanePadding spare elements: whole vectors are read and written to the end.
void project(const Projection& projection, const Vec2d& origin, std::size_t count,
             const CameraPoints& from, const HomogeneousPoints& to) {
    const hn::CappedTag<double, kLanePadding> wide;
    const hn::Rebind<float, decltype(wide)> narrow;
    const auto scale_x = hn::Set(wide, projection.scale.x);
    const auto scale_y = hn::Set(wide, projection.scale.y);
    const auto shift_x = hn::Set(wide, projection.center.x - origin.x);
    const auto shift_y = hn::Set(wide, projection.center.y - origin.y);
    for (std::size_t i = 0; i < count; i += hn::Lanes(wide)) {
        const auto x = hn::PromoteTo(wide, hn::LoadU(narrow, from.x + i));
        const auto y = hn::PromoteTo(wide, hn::LoadU(narrow, from.y + i));
        const auto z = hn::PromoteTo(wide, hn::LoadU(narrow, from.z + i));
        const auto w = projection.perspective ? z : hn::Set(wide, 1.0);
        hn::StoreU(hn::DemoteTo(narrow, scale_x * x + shift_x * w), narrow, to.x + i);
        hn::StoreU(hn::DemoteTo(narrow, scale_y * y + shift_y * w), narrow, to.y + i);
        hn::StoreU(hn::DemoteTo(narrow, w), narrow, to.w + i);
    }
}

void interleave(const SimdGrid& grid, std::size_t first, std::size_t count, float* corners) {
    const hn::CappedTag<float, kLanePadding> tag;
    for (std::size_t i = first; i < first + count; i += hn::Lanes(tag))
        hn::StoreInterleaved4(hn::LoadU(tag, grid.x + i), hn::LoadU(tag, grid.y + i),
                              hn::LoadU(tag, grid.w + i), hn::LoadU(tag, grid.z + i), tag,
                              corners + 4 * i);
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(project);
HWY_EXPORT(interleave);

void project_vertices(const Projection& projection, const Vec2d& origin, std::size_t count,
                      const CameraPoints& from, const HomogeneousPoints& to) {
    HWY_DYNAMIC_DISPATCH(project)(projection, origin, count, from, to);
}

void interleave_corners(const SimdGrid& grid, std::size_t first, std::size_t count,
                        float* corners) {
    HWY_DYNAMIC_DISPATCH(interleave)(grid, first, count, corners);
}

}  // namespace granita
#endif
