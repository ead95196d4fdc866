// SPDX-License-Identifier: GPL-3.0-or-later
// Collects what the closure nodes of a graph contribute.  Weights run from the root to the leaves
// (as Cycles' svm does): each closure node receives the product of the mix factors above it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "shade/programs/node_builder.h"

namespace granita {

struct LobeSource {
    LobeKind kind = LobeKind::Diffuse;
    Distribution distribution = Distribution::Ggx;
    FresnelKind fresnel = FresnelKind::None;
    bool multiscatter = false, separable_masking = false, smooth_color = false, of_glass = false,
         burley = false, cosine_bumps = false;
    bool retro_alone = false, deepens_color = false;
    VectorSource weight, normal;
    FloatSource roughness;
    bool has_color = false;  ///< f0 is the lobe's colour though it has no Fresnel
    VectorSource f0, f90;
    FloatSource ior;
    bool is_stretched = false;  ///< by `aspect` along `tangent`
    VectorSource tangent;
    FloatSource aspect;
    std::vector<FloatSource> more;  ///< as Lobe::more
    const FilmSpectrum* film_spectrum = nullptr;
};

/// As SubsurfaceLobe.
struct SubsurfaceSource {
    bool walks = true, burley = false, after_diffuse = true;
    bool is_bent = false;  ///< `normal` is another than the surface's own
    SubsurfaceEntry entry = SubsurfaceEntry::Diffuse;
    VectorSource weight, normal, albedo, radius;
    FloatSource anisotropy, alpha, ior;
};

/// How a medium scatters light about its way.
struct PhaseSource {
    PhaseKind kind = PhaseKind::HenyeyGreenstein;
    VectorSource scattering;    ///< coefficient, 1 / metre
    FloatSource first, second;  ///< the two numbers of PhaseKind
};

/// What is inside of a thing, per metre.
struct VolumeSources {
    VectorSource absorption;  ///< coefficient; the constant 0 = none
    std::vector<PhaseSource> phases;
};

struct SurfaceSources {
    std::vector<LobeSource> lobes;
    std::vector<SubsurfaceSource> subsurface;
    VectorSource emission, transparency;  ///< the constant 0 = none
    bool additive = false;                ///< may reflect or emit where it is fully transparent

    bool reflects() const { return !lobes.empty() || !subsurface.empty(); }
};

class SurfaceBuilder {
  public:
    /// Of a material: which one leads to the closures.
    enum class Socket { Surface, Volume };
    SurfaceBuilder(std::size_t node_count, Socket socket)
        : m_socket(socket), m_weights(node_count, FloatSource{-1, 0.0f}), m_outputs(node_count) {}

    /// The weight that has reached a node; the constant 0 = none.
    const FloatSource& weight(std::size_t node) const { return m_weights[node]; }
    /// The output through which it was reached.
    const std::string& output(std::size_t node) const { return m_outputs[node]; }
    void add_weight(NodeBuilder& b, const NodeLink& link, const FloatSource& weight);
    /// Passes weight on to the closure linked to an input, if there is one.
    void pass_weight(NodeBuilder& b, const std::string& input, const FloatSource& weight);

    // Contributions of a closure node; zero ones are left out.
    void add_emission(NodeBuilder& b, const VectorSource& radiance);
    /// Of what shines in one of the sockets alone.
    void add_emission_in(Socket socket, NodeBuilder& b, const VectorSource& radiance) {
        if (socket == m_socket) add_emission(b, radiance);
    }
    void add_transparency(NodeBuilder& b, const VectorSource& weight);
    void add_lobe(const LobeSource& lobe);
    void add_subsurface(const SubsurfaceSource& lobe);
    void set_additive() { m_sources.additive = true; }
    void add_absorption(NodeBuilder& b, const VectorSource& coefficient);
    void add_phase(const PhaseSource& phase);

    const SurfaceSources& sources() const { return m_sources; }
    /// Beside their emission.
    const VolumeSources& volume() const { return m_volume; }

  private:
    Socket m_socket;
    std::vector<FloatSource> m_weights;
    std::vector<std::string> m_outputs;
    SurfaceSources m_sources;
    VolumeSources m_volume;
};

/// weight times colour.
VectorSource scaled(NodeBuilder& b, const VectorSource& color, const FloatSource& weight);
FloatSource product(NodeBuilder& b, const FloatSource& x, const FloatSource& y);
VectorSource product(NodeBuilder& b, const VectorSource& x, const VectorSource& y);

}  // namespace granita
