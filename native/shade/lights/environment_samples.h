// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "shade/bsdf/bsdf.h"

namespace granita {

/// Lookups into the world that wait for their radiance: the world is asked once for many
/// directions.
struct EnvironmentSamples {
    std::vector<Vec3f> directions;
    std::vector<Vec3f> weights;
    std::vector<BsdfValue>
        parts;  ///< of the weights, where these are asked for or see different worlds
    std::vector<std::size_t> points;
    std::vector<float> signs;  ///< as LitGrid::sign

    void add(std::size_t point, const Vec3f& direction, const Vec3f& weight, float sign) {
        signs.push_back(sign);
        directions.push_back(direction);
        weights.push_back(weight);
        points.push_back(point);
    }
    /// Mean angle between the directions of neighbouring points: what one of them stands for.
    float spread() const {
        float sum = 0.0f;
        int pairs = 0;
        for (std::size_t k = 1; k < points.size(); ++k) {
            if (points[k] != points[k - 1] + 1) continue;
            // A row's end and the next row's start are neighbours in the list alone.
            const float angle = glm::length(directions[k] - directions[k - 1]);
            if (angle > kWidestSpread) continue;
            sum += angle;
            ++pairs;
        }
        return pairs > 0 ? sum / static_cast<float>(pairs) : 0.0f;
    }
    static constexpr float kWidestSpread = 0.5f;
};

}  // namespace granita
