// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bsdf/lobe_shape.h"

namespace granita {
namespace {

HairForm hair_form(const Lobe& lobe, std::size_t point) {
    return {lobe.tangent[point], lobe.roughness[point], lobe.more[0][point], lobe.more[1][point]};
}

}  // namespace

std::unique_ptr<const LobeShape> make_shape(const Lobe& lobe, std::size_t point,
                                            const LobeView& view) {
    switch (lobe.kind) {
        case LobeKind::Translucent:
            return make_translucent(view);
        case LobeKind::ThinGlass:
            return make_thin_glass(view, lobe.roughness[point]);
        case LobeKind::Sheen:
            return make_sheen(view, lobe.roughness[point]);
        case LobeKind::GrazingSheen:
            return make_grazing_sheen(view);
        case LobeKind::Velvet:
            return make_velvet(view, lobe.roughness[point]);
        case LobeKind::DiffuseToon:
        case LobeKind::GlossyToon:
            return make_toon(view, lobe.kind == LobeKind::GlossyToon, lobe.roughness[point],
                             lobe.more[0][point]);
        case LobeKind::HairReflection:
        case LobeKind::HairTransmission:
            return make_hair(view, hair_form(lobe, point), lobe.kind == LobeKind::HairTransmission);
        case LobeKind::PrincipledHair: {
            HairForm form = hair_form(lobe, point);
            form.first_roughness = lobe.more[2][point];
            form.ior = lobe.ior[point];
            form.sigma = lobe.f0[point];
            form.cells = lobe.more[3][point];
            form.aside = lobe.more[4][point];
            form.tilts_light = lobe.more[5][point] != 0.0f;
            return make_principled_hair(view, form);
        }
        case LobeKind::Phase:
            return make_phase(view, lobe.phase, {lobe.roughness[point], lobe.more[0][point]});
        case LobeKind::Diffuse:
        case LobeKind::Glossy:
        case LobeKind::Refraction:
            break;
    }
    return nullptr;
}

}  // namespace granita
