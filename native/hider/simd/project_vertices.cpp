// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/simd/project_vertices.h"

#include <cmath>

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

void bound(const SimdGrid& grid, int segment, bool perspective, const VertexBounds& to) {
    const hn::CappedTag<float, kLanePadding> tag;
    const auto set = [&](float x) HWY_ATTR { return hn::Set(tag, x); };
    // Bounds grow by more than the offsets of hit tests can round by.
    const auto margin = set(1.0f / 1024), relative = set(0x1p-21f), slack = set(1.0f + 1e-5f);
    const auto one = set(1.0f), zero = set(0.0f), huge = set(1e30f), never = set(INFINITY);
    const auto vertices = static_cast<std::size_t>(grid.vertices);
    for (std::size_t v = 0; v < vertices; v += hn::Lanes(tag)) {
        auto x_lo = never, y_lo = never, x_hi = hn::Neg(never), y_hi = x_hi, nearest = x_hi;
        for (int knot = segment; knot <= segment + (grid.segments > 0); ++knot) {
            const std::size_t i = static_cast<std::size_t>(knot) * vertices + v;
            const auto w = hn::LoadU(tag, grid.w + i), z = hn::LoadU(tag, grid.z + i);
            const auto inverse = one / w;
            const auto x = hn::LoadU(tag, grid.x + i) * inverse;
            const auto y = hn::LoadU(tag, grid.y + i) * inverse;
            auto shear = hn::Abs(z * set(grid.inverse_focus) - one);
            if (grid.refocuses())
                shear = hn::Max(shear, hn::Abs(z * set(grid.inverse_farthest) - one));
            shear = shear * hn::Abs(inverse) * slack;
            const auto more_x = margin + hn::Abs(x) * relative + set(grid.lens_x) * shear;
            const auto more_y = margin + hn::Abs(y) * relative + set(grid.lens_y) * shear;
            const auto seen = hn::And(hn::Gt(w, zero), hn::And(hn::Lt(hn::Abs(x) + more_x, huge),
                                                               hn::Lt(hn::Abs(y) + more_y, huge)));
            x_lo = hn::Min(x_lo, hn::IfThenElse(seen, x - more_x, hn::Neg(never)));
            x_hi = hn::Max(x_hi, hn::IfThenElse(seen, x + more_x, never));
            y_lo = hn::Min(y_lo, hn::IfThenElse(seen, y - more_y, hn::Neg(never)));
            y_hi = hn::Max(y_hi, hn::IfThenElse(seen, y + more_y, never));
            const auto key =
                perspective ? hn::IfThenElse(hn::Gt(z, zero), one / z, never) : hn::Neg(z);
            // The key of a sample may round a few ulp past the nearest corner's.
            nearest = hn::Max(nearest, key + hn::Abs(key) * set(0x1p-18f));
        }
        hn::StoreU(x_lo, tag, to.x_lo + v);
        hn::StoreU(x_hi, tag, to.x_hi + v);
        hn::StoreU(y_lo, tag, to.y_lo + v);
        hn::StoreU(y_hi, tag, to.y_hi + v);
        hn::StoreU(nearest, tag, to.nearest + v);
    }
}

PartBounds bound_part_of(const SimdGrid& grid, const Patch& part, int segment) {
    const hn::CappedTag<float, kLanePadding> tag;
    auto x_lo = hn::Set(tag, INFINITY), x_hi = hn::Neg(x_lo), y_lo = x_lo, y_hi = x_hi;
    auto nearest = x_hi;
    const auto knot = static_cast<std::size_t>(segment) * grid.vertices;
    grid.for_each_run(part, [&](int first, int count) HWY_ATTR {
        for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(tag))) {
            const std::size_t at = knot + static_cast<std::size_t>(first + i);
            const auto in = hn::FirstN(tag, static_cast<std::size_t>(count - i));
            const auto least = [&](auto so_far, const float* a) HWY_ATTR {
                return hn::Min(so_far, hn::IfThenElse(in, hn::LoadU(tag, a + at), so_far));
            };
            const auto most = [&](auto so_far, const float* a) HWY_ATTR {
                return hn::Max(so_far, hn::IfThenElse(in, hn::LoadU(tag, a + at), so_far));
            };
            x_lo = least(x_lo, grid.x_lo);
            x_hi = most(x_hi, grid.x_hi);
            y_lo = least(y_lo, grid.y_lo);
            y_hi = most(y_hi, grid.y_hi);
            nearest = most(nearest, grid.nearest);
        }
    });
    return {hn::GetLane(hn::MinOfLanes(tag, x_lo)), hn::GetLane(hn::MaxOfLanes(tag, x_hi)),
            hn::GetLane(hn::MinOfLanes(tag, y_lo)), hn::GetLane(hn::MaxOfLanes(tag, y_hi)),
            hn::GetLane(hn::MaxOfLanes(tag, nearest))};
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
HWY_EXPORT(bound);
HWY_EXPORT(bound_part_of);
HWY_EXPORT(interleave);

void project_vertices(const Projection& projection, const Vec2d& origin, std::size_t count,
                      const CameraPoints& from, const HomogeneousPoints& to) {
    HWY_DYNAMIC_DISPATCH(project)(projection, origin, count, from, to);
}

void bound_vertices(const SimdGrid& grid, int segment, bool perspective, const VertexBounds& to) {
    HWY_DYNAMIC_DISPATCH(bound)(grid, segment, perspective, to);
}

PartBounds bound_part(const SimdGrid& grid, const Patch& part, int segment) {
    return HWY_DYNAMIC_DISPATCH(bound_part_of)(grid, part, segment);
}

void interleave_corners(const SimdGrid& grid, std::size_t first, std::size_t count,
                        float* corners) {
    HWY_DYNAMIC_DISPATCH(interleave)(grid, first, count, corners);
}

}  // namespace granita
#endif
