// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/programs/surface_builder.h"

namespace granita {

VectorSource scaled(NodeBuilder& b, const VectorSource& color, const FloatSource& weight) {
    if (weight.is(1.0f)) return color;
    if (weight.is(0.0f) || color.is(Vec3f(0.0f))) return {-1, Vec3f(0.0f)};
    return b.map<Vec3f>([](const Vec3f& c, float w) { return c * w; }, color, weight);
}

FloatSource product(NodeBuilder& b, const FloatSource& x, const FloatSource& y) {
    if (x.is(1.0f)) return y;
    if (y.is(1.0f)) return x;
    if (x.is(0.0f) || y.is(0.0f)) return {-1, 0.0f};
    return b.map<float>([](float u, float v) { return u * v; }, x, y);
}

VectorSource product(NodeBuilder& b, const VectorSource& x, const VectorSource& y) {
    const Vec3f zero(0.0f), one(1.0f);
    if (x.is(one) || y.is(zero)) return y;
    if (y.is(one) || x.is(zero)) return x;
    return b.map<Vec3f>([](const Vec3f& u, const Vec3f& v) { return u * v; }, x, y);
}

namespace {

VectorSource sum(NodeBuilder& b, const VectorSource& x, const VectorSource& y) {
    if (x.is(Vec3f(0.0f))) return y;
    if (y.is(Vec3f(0.0f))) return x;
    return b.map<Vec3f>([](const Vec3f& u, const Vec3f& v) { return u + v; }, x, y);
}

}  // namespace

void SurfaceBuilder::add_weight(NodeBuilder& b, const NodeLink& link, const FloatSource& weight) {
    m_outputs[link.node] = link.output;
    FloatSource& target = m_weights[link.node];
    if (target.is(0.0f)) {
        target = weight;
    } else if (!weight.is(0.0f)) {
        target = b.map<float>([](float u, float v) { return u + v; }, target, weight);
    }
}

void SurfaceBuilder::pass_weight(NodeBuilder& b, const std::string& input,
                                 const FloatSource& weight) {
    const auto found = b.node().inputs.find(input);
    if (found == b.node().inputs.end()) return;
    if (const auto* link = std::get_if<NodeLink>(&found->second)) add_weight(b, *link, weight);
}

void SurfaceBuilder::add_emission(NodeBuilder& b, const VectorSource& radiance) {
    m_sources.emission = sum(b, m_sources.emission, radiance);
}

void SurfaceBuilder::add_transparency(NodeBuilder& b, const VectorSource& weight) {
    m_sources.transparency = sum(b, m_sources.transparency, weight);
}

void SurfaceBuilder::add_absorption(NodeBuilder& b, const VectorSource& coefficient) {
    m_volume.absorption = sum(b, m_volume.absorption, coefficient);
}

void SurfaceBuilder::add_phase(const PhaseSource& phase) {
    if (!phase.scattering.is(Vec3f(0.0f))) m_volume.phases.push_back(phase);
}

void SurfaceBuilder::add_lobe(const LobeSource& lobe) {
    if (!lobe.weight.is(Vec3f(0.0f))) m_sources.lobes.push_back(lobe);
}

void SurfaceBuilder::add_subsurface(const SubsurfaceSource& lobe) {
    if (!lobe.weight.is(Vec3f(0.0f))) m_sources.subsurface.push_back(lobe);
}

}  // namespace granita
