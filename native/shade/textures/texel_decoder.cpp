// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/texel_decoder.h"

#include <array>
#include <vector>

namespace granita {

namespace {

/// Light of the bytes of sRGB.
const std::array<float, 256>& decoded_bytes() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> values{};
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = linear_from_srgb(static_cast<float>(i) / 255.0f);
        return values;
    }();
    return table;
}

/// [alpha][byte]: alpha times the light of byte / alpha.
const std::vector<float>& decoded_quotients() {
    static const std::vector<float> table = [] {
        std::vector<float> values(256 * 256);
        for (std::size_t alpha = 0; alpha < 256; ++alpha) {
            const float a = static_cast<float>(alpha) / 255.0f;
            for (std::size_t i = 0; i < 256; ++i) {
                const float x = static_cast<float>(i) / 255.0f;
                values[alpha * 256 + i] =
                    alpha == 0 ? linear_from_srgb(x) : a * linear_from_srgb(x / a);
            }
        }
        return values;
    }();
    return table;
}

}  // namespace

Vec4f TexelDecoder::light(const std::byte* at, TexelType type) const {
    if (!encoded) return stored_texel(at, type);
    if (type == TexelType::Byte) {
        const auto* c = reinterpret_cast<const std::uint8_t*>(at);
        const float* table = !unassociate || c[3] == 255
                                 ? decoded_bytes().data()
                                 : decoded_quotients().data() + std::size_t{c[3]} * 256;
        return {table[c[0]], table[c[1]], table[c[2]], static_cast<float>(c[3]) * (1.0f / 255.0f)};
    }
    const Vec4f texel = stored_texel(at, type);
    Vec4f light = decoded(texel);
    if (unassociate && texel.w != 0.0f) light = {Vec3f(decoded(divided(texel))) * texel.w, texel.w};
    return glm::min(light, Vec4f(kLargestNumber));
}

}  // namespace granita
