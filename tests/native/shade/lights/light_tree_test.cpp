// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/light_tree.h"

#include <gtest/gtest.h>

#include <random>

#include "shade/bsdf/bsdf_albedo.h"
#include "shade/lights/lamp_choice.h"
#include "shade/lights/light_lamp.h"
#include "shade/lights/light_scene.h"

namespace granita {
namespace {

class Randomly {
  public:
    explicit Randomly(unsigned seed) : m_generator(seed) {}
    float operator()(float from, float to) {
        return std::uniform_real_distribution<float>(from, to)(m_generator);
    }
    Vec3f place(float half) {
        return {(*this)(-half, half), (*this)(-half, half), (*this)(-half, half)};
    }
    Vec3f direction() {
        for (;;) {
            const Vec3f v = place(1.0f);
            if (glm::length(v) > 0.1f && glm::length(v) < 1.0f) return glm::normalize(v);
        }
    }

  private:
    std::mt19937 m_generator;
};

Light random_light(Randomly& random) {
    const auto kind = static_cast<int>(random(0.0f, 6.0f));
    const Mat4d m = aimed(Vec3d(random.place(4.0f)), Vec3d(random.direction()));
    const float energy = random(1.0f, 100.0f);
    if (kind < 3) {
        Light light = light_of(kind == 0 ? LightKind::Spot : LightKind::Point, energy, m);
        light.radius = kind == 1 ? 0.0f : random(0.0f, 0.5f);
        light.soft_falloff = random(0.0f, 1.0f) < 0.5f;
        light.spot_size = random(0.1f, 2.8f);
        light.spot_blend = random(0.0f, 1.0f);
        return light;
    }
    Light light = light_of(LightKind::Area, energy, m);
    light.shape = kind == 3 ? AreaShape::Rectangle : AreaShape::Ellipse;
    light.size = {random(0.05f, 1.0f), random(0.05f, 1.0f)};
    if (kind == 5) light.spread = random(0.2f, 3.0f);
    return light;
}

/// Lamps in the order of their tree.
struct Placed {
    std::vector<Lamp> lamps;
    std::unique_ptr<LightTree> tree;

    explicit Placed(const std::vector<Light>& lights) {
        std::vector<LightBound> bounds(lights.size());
        for (std::size_t i = 0; i < lights.size(); ++i)
            EXPECT_TRUE(Lamp(lights[i], 0.5f, Vec3d(0.0)).bound(bounds[i]));
        std::vector<std::uint32_t> order;
        tree = std::make_unique<LightTree>(bounds, order);
        for (const std::uint32_t i : order) lamps.emplace_back(lights[i], 0.5f, Vec3d(0.0));
    }
};

Placed random_lamps(std::size_t count, Randomly& random) {
    std::vector<Light> lights;
    for (std::size_t i = 0; i < count; ++i) lights.push_back(random_light(random));
    return Placed(lights);
}

/// A point with a diffuse and a glossy lobe.
struct Point {
    ShadingPoints points;
    SurfaceClosure closure;

    Point(const Vec3f& p, const Vec3f& normal, const Vec3f& view, float roughness,
          Distribution distribution = Distribution::Ggx) {
        points = points_facing_up({p});
        points.normal = points.geometric_normal = {normal};
        points.view = {view};
        closure.lobes = {lambert(points, 0.6f), glossy(points, roughness)};
        closure.lobes[1].distribution = distribution;
    }
    PointBsdf bsdf() const { return {closure, points, 0, GgxAlbedo::shared()}; }
};

Point random_point(Randomly& random) {
    const Vec3f normal = random.direction();
    Vec3f view = random.direction();
    if (glm::dot(view, normal) < 0.0f) view = -view;
    const auto distribution = random(0.0f, 1.0f) < 0.7f ? Distribution::Ggx : Distribution::Gtr1;
    return {random.place(5.0f), normal, view, random(0.1f, 1.0f), distribution};
}

/// Light that the point reflects of a lamp, mean of the channels, over samples of a net.
float reflected(const Lamp& lamp, const Vec3f& p, const PointBsdf& bsdf, float time = 0.5f) {
    constexpr std::uint32_t kSamples = 256;
    const SobolPoints sequence(7);
    float sum = 0.0f;
    for (std::uint32_t s = 0; s < kSamples; ++s) {
        LightSample sample;
        if (!lamp.sample(time, p, sequence(s), sample)) continue;
        const Vec3f value = total(bsdf.evaluate(sample.direction)) * sample.radiance / sample.pdf;
        sum += (value.x + value.y + value.z) / 3.0f;
    }
    return sum / static_cast<float>(kSamples);
}

LightReceiver receiver_of(const std::vector<Point>& points) {
    LightReceiver receiver(~0ULL);
    for (const Point& point : points) {
        Bounds3f box;
        box.add(point.points.p[0]);
        receiver.add(box, point.bsdf());
    }
    return receiver;
}

float importance(const LightTree& tree, const LightReceiver& receiver, LightTree::Slot slot) {
    float of_child[LightTree::kWidth];
    tree.importances(slot / LightTree::kWidth, receiver.view(), ~0ULL, of_child);
    return of_child[slot % LightTree::kWidth];
}

/// Samples of a lamp's place are not its integral: a highlight of .01 sr seen by 256 of them.
constexpr float kSampled = 1.1f;

TEST(LightTree, importance_bounds_what_a_lamp_gives) {
    Randomly random(1);
    int lit = 0;
    for (int round = 0; round < 40; ++round) {
        const Placed placed = random_lamps(60, random);
        const Point point = random_point(random);
        const LightReceiver receiver = receiver_of({point});
        const PointBsdf bsdf = point.bsdf();
        for (std::uint32_t l = 0; l < placed.lamps.size(); ++l) {
            const float given = reflected(placed.lamps[l], point.points.p[0], bsdf);
            lit += given > 0.0f;
            const LightTree::Slot slot = placed.tree->slot_of_lamp(l);
            EXPECT_LE(given, kSampled * importance(*placed.tree, receiver, slot)) << l;
        }
    }
    EXPECT_GT(lit, 400);
}

TEST(LightTree, a_bound_of_neighbours_bounds_each) {
    Randomly random(2);
    for (int round = 0; round < 20; ++round) {
        const Placed placed = random_lamps(40, random);
        const Point first = random_point(random);
        std::vector<Point> points;
        for (int k = 0; k < 8; ++k) {
            const Vec3f normal = glm::normalize(first.points.normal[0] + 0.3f * random.direction());
            points.emplace_back(first.points.p[0] + random.place(0.2f), normal,
                                glm::normalize(normal + 0.9f * random.direction()), 0.5f);
        }
        const LightReceiver receiver = receiver_of(points);
        for (const Point& point : points) {
            const PointBsdf bsdf = point.bsdf();
            for (std::uint32_t l = 0; l < placed.lamps.size(); ++l) {
                const float given = reflected(placed.lamps[l], point.points.p[0], bsdf);
                const LightTree::Slot slot = placed.tree->slot_of_lamp(l);
                EXPECT_LE(given, kSampled * importance(*placed.tree, receiver, slot)) << l;
            }
        }
    }
}

TEST(LightTree, nodes_bound_what_is_below_from_afar_and_are_nowhere_nought_where_light_is) {
    Randomly random(3);
    for (int round = 0; round < 20; ++round) {
        const Placed placed = random_lamps(200, random);
        Point point = random_point(random);
        point.points.p[0] *= round < 10 ? 1.0f : 4.0f;
        const LightReceiver receiver = receiver_of({point});
        const PointBsdf bsdf = point.bsdf();
        std::vector<float> below(placed.tree->node_count(), 0.0f);
        for (std::uint32_t l = 0; l < placed.lamps.size(); ++l) {
            const float given = reflected(placed.lamps[l], point.points.p[0], bsdf);
            LightTree::Slot slot = placed.tree->slot_of_lamp(l);
            while (slot != LightTree::kNoSlot) {
                if (given > 0.0f) {
                    EXPECT_GT(importance(*placed.tree, receiver, slot), 0.0f);
                }
                below[slot / LightTree::kWidth] += given;
                slot = placed.tree->slot_of_node(slot / LightTree::kWidth);
            }
        }
        if (round < 10) continue;
        for (std::uint32_t node = 1; node < below.size(); ++node) {
            const LightTree::Slot slot = placed.tree->slot_of_node(node);
            EXPECT_LE(below[node], kSampled * importance(*placed.tree, receiver, slot));
        }
    }
}

TEST(LightTree, a_lamp_that_moves_and_dims_is_bound_at_all_times) {
    Randomly random(4);
    for (int round = 0; round < 40; ++round) {
        std::vector<Light> lights;
        for (int l = 0; l < 12; ++l) {
            Light light = random_light(random);
            Mat4d later = light.world_from_light[0];
            later[3] = glm::dvec4(Vec3d(random.place(4.0f)), 1.0);
            // In between, matrices that turn are skewed, and lamps that are do not add up.
            if (round % 2) later = aimed(Vec3d(later[3]), Vec3d(random.direction()));
            light.world_from_light = {light.world_from_light[0], later};
            light.energy_knots = {random(0.0f, 50.0f), random(0.0f, 50.0f)};
            lights.push_back(light);
        }
        const Placed placed(lights);
        const Point point = random_point(random);
        const LightReceiver receiver = receiver_of({point});
        const PointBsdf bsdf = point.bsdf();
        for (std::uint32_t l = 0; l < placed.lamps.size(); ++l)
            for (const float time : {0.0f, 0.3f, 0.9f}) {
                const float given = reflected(placed.lamps[l], point.points.p[0], bsdf, time);
                const float most = importance(*placed.tree, receiver, placed.tree->slot_of_lamp(l));
                if (given > 0.0f) {
                    EXPECT_GT(most, 0.0f);
                }
                // Within its own way a lamp counts as no nearer than a tenth of it.
                LightBound bound;
                placed.lamps[l].bound(bound);
                const Vec3f outside =
                    glm::max(bound.box.lo - point.points.p[0], point.points.p[0] - bound.box.hi);
                if (round % 2 == 0 && std::max({outside.x, outside.y, outside.z}) > 1.0f) {
                    EXPECT_LE(given, kSampled * (1.0f + 0.01f * 60.0f) * most);
                }
            }
    }
}

TEST(LightTree, lamps_that_light_others_have_no_part) {
    Randomly random(5);
    std::vector<Light> lights;
    for (int l = 0; l < 100; ++l) {
        lights.push_back(light_of(LightKind::Point, 10.0f, at(Vec3d(random.place(3.0f)))));
        lights.back().receiver_set = l % 3;
    }
    const Placed placed(lights);
    const Point point({0, 0, -5}, {0, 0, 1}, {0, 0, 1}, 0.5f);
    LightReceiver receiver(0b010);
    Bounds3f box;
    box.add(point.points.p[0]);
    receiver.add(box, point.bsdf());
    LampChoice choice(*placed.tree);
    choice.aim(receiver, 16, 10.0f, 10.0f);
    for (std::uint32_t l = 0; l < 100; ++l)
        EXPECT_EQ(choice.rate_of(l).mean > 0.0f, placed.lamps[l].lights(0b010)) << l;
}

TEST(LightTree, a_ray_meets_all_lamps_on_its_way) {
    Randomly random(6);
    const Placed placed = random_lamps(300, random);
    int hits = 0;
    for (int ray = 0; ray < 2000; ++ray) {
        const Vec3f p = random.place(6.0f), direction = random.direction();
        std::vector<std::uint32_t> found;
        placed.tree->meet(p, direction, [&](std::uint32_t lamp) { found.push_back(lamp); });
        EXPECT_TRUE(std::ranges::is_sorted(found));
        for (std::uint32_t l = 0; l < placed.lamps.size(); ++l) {
            LightSample sample;
            if (!placed.lamps[l].meets(0.5f, p, direction, sample)) continue;
            ++hits;
            EXPECT_TRUE(std::ranges::binary_search(found, l));
        }
    }
    EXPECT_GT(hits, 100);
}

TEST(LightTree, a_ray_along_an_axis_meets_what_its_face_touches) {
    Light light = light_of(LightKind::Area, 1.0f, aimed({0, 0, 2}, {0, 0, -1}));
    std::vector<Light> lights(20, light);
    const Placed placed(lights);
    int found = 0;
    placed.tree->meet({0, 0, 0}, {0, 0, 1}, [&](std::uint32_t) { ++found; });
    EXPECT_EQ(found, 20);
}

/// Over evenly spread choices each lamp comes up as often as its rate says.
void expect_rates(const LampChoice& choice, std::size_t lamps, int most_asked) {
    constexpr int kChoices = 1 << 16;
    std::vector<double> times(lamps, 0.0);
    std::vector<ChosenLamp> chosen;
    std::size_t asked = 0;
    for (int k = 0; k < kChoices; ++k) {
        chosen.clear();
        choice.choose((static_cast<float>(k) + 0.5f) / kChoices, chosen);
        asked += chosen.size();
        for (const ChosenLamp& one : chosen) {
            times[one.lamp] += 1.0 / kChoices;
            const LampRate rate = choice.rate_of(one.lamp);
            EXPECT_NEAR(one.rate.mean, rate.mean, 1e-5f * rate.mean);
            EXPECT_EQ(one.rate.samples, rate.samples);
        }
    }
    double sum = 0.0;
    for (std::uint32_t l = 0; l < lamps; ++l) {
        EXPECT_NEAR(times[l], choice.rate_of(l).mean, 4.0 / kChoices) << l;
        sum += times[l];
    }
    EXPECT_NEAR(sum, static_cast<double>(asked) / kChoices, 1e-6);
    EXPECT_LE(sum, most_asked);
}

TEST(LampChoice, comes_up_as_often_as_it_says) {
    Randomly random(8);
    for (int round = 0; round < 4; ++round) {
        const Placed placed = random_lamps(300, random);
        const LightReceiver receiver = receiver_of({random_point(random)});
        LampChoice choice(*placed.tree);
        choice.aim(receiver, 16, 16.0f, round < 2 ? 16.0f : 64.0f);
        expect_rates(choice, placed.lamps.size(), 40);
    }
}

TEST(LampChoice, lamps_that_give_most_are_always_asked_and_the_rest_still_is) {
    Randomly random(9);
    std::vector<Light> lights;
    for (int l = 0; l < 500; ++l)
        lights.push_back(light_of(LightKind::Point, l == 77 ? 1e6f : 10.0f,
                                  at({random(-1.0f, 1.0f), random(-1.0f, 1.0f), 5.0})));
    const Placed placed(lights);
    const Point point({0, 0, 0}, {0, 0, 1}, {0, 0, 1}, 1.0f);
    LampChoice choice(*placed.tree);
    const LightReceiver receiver = receiver_of({point});
    choice.aim(receiver, 1, 32.0f, 128.0f);
    int always = 0;
    float by_chance = 0.0f;
    for (std::uint32_t l = 0; l < 500; ++l) {
        const float rate = choice.rate_of(l).mean;
        if (rate == 1.0f)
            ++always;
        else
            by_chance += rate;
    }
    EXPECT_EQ(always, 1);
    // A quarter of 32: the bright one may be shadowed.
    EXPECT_NEAR(by_chance, 8.0f, 0.5f);
}

TEST(LampChoice, one_point_compares_few_nodes_of_many) {
    Randomly random(10);
    std::uint64_t seen[2];
    const std::size_t counts[] = {500, 20000};
    for (int k = 0; k < 2; ++k) {
        std::vector<Light> lights;
        for (std::size_t l = 0; l < counts[k]; ++l)
            lights.push_back(light_of(LightKind::Point, 1.0f, at(Vec3d(random.place(10.0f)))));
        const Placed placed(lights);
        const LightReceiver receiver = receiver_of({Point({0, 0, -3}, {0, 0, 1}, {0, 0, 1}, 1.0f)});
        LampChoice choice(*placed.tree);
        choice.aim(receiver, 1, 16.0f, 16.0f);
        std::vector<ChosenLamp> chosen;
        choice.choose(0.5f, chosen);
        seen[k] = choice.nodes_seen();
    }
    EXPECT_LE(seen[1], 3 * seen[0]);  // of 40 times as many lamps
}

TEST(LightTree, is_not_made_after_a_cancel) {
    Progress progress;
    std::vector<std::uint32_t> order;
    const std::vector<LightBound> lamps(3);
    EXPECT_NO_THROW(LightTree(lamps, order, &progress));
    progress.cancel();
    EXPECT_THROW(LightTree(lamps, order, &progress), Cancelled);
}

}  // namespace
}  // namespace granita
