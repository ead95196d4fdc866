// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/geometry_data.h"

namespace granita {
namespace {

const Attribute* first_of_kind(const GeometryData& data, AttributeKind kind) {
    for (const Attribute& attribute : data.attributes)
        if (attribute.kind == kind) return &attribute;
    return nullptr;
}

}  // namespace

const Attribute* GeometryData::find_attribute(const std::string& attribute_name) const {
    for (const Attribute& attribute : attributes)
        if (attribute.name == attribute_name) return &attribute;
    return nullptr;
}

const Attribute* GeometryData::default_uv() const {
    return first_of_kind(*this, AttributeKind::Uv);
}
const Attribute* GeometryData::default_color() const {
    return first_of_kind(*this, AttributeKind::Color);
}

}  // namespace granita
