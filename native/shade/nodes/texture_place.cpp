// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/texture_place.h"

#include "math/normalize_or.h"
#include "shade/nodes/coordinates.h"

namespace granita {

VectorSource texture_place(NodeBuilder& b) {
    return mapped_place(b, b.linked("Vector") ? b.vector("Vector") : generated_at(b, b.shift()));
}

VectorSource mapped_place(NodeBuilder& b, const VectorSource& place) {
    const std::vector<float> rows = b.table("texture_mapping");
    if (rows.size() != 12) return place;
    const auto row = [&](std::size_t i) {
        return Vec4f(rows[4 * i], rows[4 * i + 1], rows[4 * i + 2], rows[4 * i + 3]);
    };
    return b.map<Vec3f>(
        [x = row(0), y = row(1), z = row(2),
         is_unit = b.flag("texture_mapping_is_unit")](const Vec3f& p) {
            const Vec4f at(p, 1.0f);
            const Vec3f moved(glm::dot(x, at), glm::dot(y, at), glm::dot(z, at));
            return is_unit ? normalize_or(moved, Vec3f(0.0f)) : moved;
        },
        place);
}

}  // namespace granita
