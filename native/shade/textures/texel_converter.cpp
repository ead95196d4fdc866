// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/texel_converter.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace granita {

namespace {

float finite(float x) {
    return std::isfinite(x) ? std::clamp(x, -kLargestNumber, kLargestNumber) : 0.0f;
}

/// Of a file: beyond the exponent of the largest number are infinities and what is none.
float number(std::uint16_t half) {
    return (half & 0x7c00u) == 0x7c00u ? 0.0f : float_from_half(half);
}

/// Grey, grey and alpha, rgb, rgba and more: to rgba.
template <class T>
void expand(const T* from, int channels, T one, T* to) {
    for (int k = 0; k < 3; ++k) to[k] = channels >= 3 ? from[k] : from[0];
    to[3] = channels >= 4 ? from[3] : channels == 2 ? from[1] : one;
}

}  // namespace

TexelConverter::TexelConverter(const From& from) : m_from(from) {
    const ColorSpace& space = *from.space;
    m_as_it_is = space.is_plain();
    m_encoded = m_as_it_is && space.curve == ColorSpace::Curve::Srgb;
    m_type = from.type == TexelType::Byte && !m_as_it_is ? TexelType::Half : from.type;
    if (m_as_it_is || from.type != TexelType::Byte || space.cube_size > 0) return;
    ColorSpace curve = space;
    curve.matrix = Mat3f(1.0f);
    for (std::size_t i = 0; i < m_curve.size(); ++i)
        m_curve[i] = curve.linear(Vec3f(static_cast<float>(i) / 255.0f)).x;
}

/// Curves are those of what was painted: what is associated is divided for them.
Vec4f TexelConverter::converted(const Vec4f& color) const {
    const float alpha = m_from.is_associated && color.w > 0.0f ? color.w : 1.0f;
    const Vec3f light = m_from.space->linear(Vec3f(color) / alpha) * alpha;
    // As Cycles: grey, whatever the primaries, unless there is alpha beside it.
    const bool is_grey = m_from.channels == 1;
    return Vec4f(is_grey ? Vec3f((light.x + light.y + light.z) / 3.0f) : light, color.w);
}

/// So are most images in a working space of other primaries than theirs: no powers a texel.
Vec4f TexelConverter::converted_byte(const std::uint8_t* c) const {
    const bool is_divided = m_from.is_associated && c[3] != 255;
    if (is_divided || m_from.channels == 1 || m_from.space->cube_size > 0)
        return converted(Vec4f(c[0], c[1], c[2], c[3]) / 255.0f);
    const Vec3f light = m_from.space->matrix * Vec3f(m_curve[c[0]], m_curve[c[1]], m_curve[c[2]]);
    return Vec4f(light, static_cast<float>(c[3]) / 255.0f);
}

void TexelConverter::convert_bytes(const std::uint8_t* from, std::size_t count,
                                   std::byte* out) const {
    for (std::size_t i = 0; i < count; ++i, from += m_from.channels, out += byte_size(m_type)) {
        std::uint8_t color[4];
        expand<std::uint8_t>(from, m_from.channels, 255, color);
        if (m_from.opaque) color[3] = 255;
        if (m_as_it_is)
            std::memcpy(out, color, sizeof color);
        else
            store_texel(converted_byte(color), out, m_type);
    }
}

void TexelConverter::convert(const void* from, std::size_t count, std::byte* out) const {
    if (m_from.type == TexelType::Byte) {
        convert_bytes(static_cast<const std::uint8_t*>(from), count, out);
        return;
    }
    const std::size_t texel = byte_size(m_type);
    const auto channels = static_cast<std::size_t>(m_from.channels);
    for (std::size_t i = 0; i < count; ++i, out += texel) {
        Vec4f color;
        if (m_from.type == TexelType::Half) {
            std::uint16_t c[4];
            expand<std::uint16_t>(static_cast<const std::uint16_t*>(from) + i * channels,
                                  m_from.channels, half_from_float(1.0f), c);
            color = Vec4f(number(c[0]), number(c[1]), number(c[2]), number(c[3]));
        } else {
            expand(static_cast<const float*>(from) + i * channels, m_from.channels, 1.0f, &color.x);
        }
        for (int k = 0; k < 4; ++k) color[k] = finite(color[k]);
        if (!m_as_it_is) {
            color = converted(color);
            for (int k = 0; k < 4; ++k) color[k] = finite(color[k]);
        }
        if (m_from.opaque) color.w = 1.0f;
        store_texel(color, out, m_type);
    }
}

}  // namespace granita
