// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "shade/nodes/node_compiler.h"

namespace granita {

/// What a surface sends out, without what it reflects.
struct EmissionProgram {
    std::vector<AttributeRequest> requests;
    Program program;
    VectorSource emission;
};

/// What materials send alike to all rays that lobes send: their meshes are lamps.
class MaterialEmission {
  public:
    /// `seen`: the scene's materials as the camera has them.
    MaterialEmission(const Scene& scene, TextureStore& textures,
                     const std::vector<CompiledSurface>& seen);

    /// 0 of what is no lamp; nullopt: its program tells.  `material` -1: none.
    std::optional<Vec3f> emitted(std::int32_t material) const {
        if (program(material)) return std::nullopt;
        return material < 0 ? Vec3f(0.0f) : m_constant[static_cast<std::size_t>(material)];
    }
    /// Of a lamp that does not send the same to all sides and from everywhere; else nullptr.
    const EmissionProgram* program(std::int32_t material) const {
        if (material < 0) return nullptr;
        const auto& program = m_programs[static_cast<std::size_t>(material)];
        return program ? &*program : nullptr;
    }
    bool is_lamp(std::int32_t material) const { return emitted(material) != Vec3f(0.0f); }
    /// Most luminance that rays of lobes may see of it; infinite where it varies from place to
    /// place or by the view.
    float brightest(std::int32_t material) const {
        return material < 0 ? 0.0f : m_brightest[static_cast<std::size_t>(material)];
    }
    /// Names what shines but is no lamp: without bounces it is seen, and sheds no light; with them
    /// its shadows follow no links.
    void warn(const Scene& scene, Report& report) const;
    /// Whether it sends out any.
    bool any(std::int32_t material) const { return brightest(material) > 0.0f; }

  private:
    std::vector<Vec3f> m_constant;
    std::vector<std::optional<EmissionProgram>> m_programs;
    std::vector<float> m_brightest;
};

}  // namespace granita
