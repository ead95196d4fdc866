// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

namespace granita {

/// The cosine lobe that sheen is transformed to: wo -> (a x + b z, a y, z) in the frame whose x
/// leans to the view; and what is reflected of white light from all sides.
struct SheenFit {
    float a, b, albedo;
};

constexpr int kSheenTableSide = 32;
/// [a, b, albedo][roughness][cosine of the view], both evenly from 0 to 1: what Zeltner, Burley and
/// Chiang (2022) fitted to fibres on a surface, as Cycles has it since Blender 4.
extern const std::array<float, 3 * kSheenTableSide * kSheenTableSide> kSheenTable;

/// Linear between the table's places.  Seen from below, by smooth normals, it is as where it is
/// grazed (Cycles).
SheenFit sheen_fit(float cosine, float roughness);

}  // namespace granita
