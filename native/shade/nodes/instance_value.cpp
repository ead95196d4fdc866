// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/instance_value.h"

namespace granita {

InstanceValue instance_value(NodeBuilder& b, const std::string& key) {
    const auto found = b.scene().instance_values.find(key);
    if (b.is_world() || found == b.scene().instance_values.end())
        return {{-1, Vec3f(0.0f)}, {-1, 0.0f}};
    const Vec4f* values = found->second.data();
    const Instance* first = b.scene().instances.data();
    return {b.geometry<Vec3f>([=](const ShadingInput& in, std::size_t) {
                return Vec3f(values[in.instance - first]);
            }),
            b.geometry<float>([=](const ShadingInput& in, std::size_t) {
                return values[in.instance - first].w;
            })};
}

FloatSource is_of_kind(NodeBuilder& b, GeometryKind kind) {
    return b.geometry<float>([&scene = b.scene(), kind](const ShadingInput& in, std::size_t) {
        return scene.geometry_of(*in.instance).kind == kind ? 1.0f : 0.0f;
    });
}

}  // namespace granita
