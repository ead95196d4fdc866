// SPDX-License-Identifier: GPL-3.0-or-later
// From an image's channels, alpha and colour space to texels.
#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "scene/color_space.h"
#include "shade/textures/texel.h"

namespace granita {

class TexelConverter {
  public:
    /// What the numbers are.
    struct From {
        std::shared_ptr<const ColorSpace> space = plain_color_space("sRGB");
        TexelType type = TexelType::Byte;
        int channels = 4;            ///< grey, grey and alpha, rgb, rgba
        bool opaque = false;         ///< alpha is to be ignored
        bool is_associated = false;  ///< colours are products with alpha
    };
    TexelConverter() = default;
    explicit TexelConverter(const From& from);

    TexelType type() const { return m_type; }
    /// As sRGB, and interpolated as they are.
    bool encoded() const { return m_encoded; }
    /// @param from  [count][channels]
    /// @param out   [count] texels of `type`.
    void convert(const void* from, std::size_t count, std::byte* out) const;

  private:
    void convert_bytes(const std::uint8_t* from, std::size_t count, std::byte* out) const;
    Vec4f converted_byte(const std::uint8_t* rgba) const;
    Vec4f converted(const Vec4f& color) const;

    From m_from;
    TexelType m_type = TexelType::Byte;  ///< bytes have no room for what is made linear
    bool m_encoded = true;
    bool m_as_it_is = true;            ///< numbers are stored as they are
    std::array<float, 256> m_curve{};  ///< of bytes that are converted by a curve and a matrix
};

}  // namespace granita
