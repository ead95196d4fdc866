// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/edge_rate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "dice/raster_bound.h"
#include "math/least_circle.h"

namespace granita {
namespace {

/// A tenth of a pixel would do for outlines, but a ball of two pixels then loses an eighth of its
/// area, and with it of its light where the lens makes a disc of it.
constexpr double kSag = 0.03;
/// The least dicing rate, pixels: below it nothing more can be seen, and 0 would never end.
constexpr double kFinest = 0.01;
/// Sag over length of what is bent too much however small it is: a sixth of a right angle.
constexpr double kBend = 0.04;
constexpr double kShortest = 0.15;
/// Pixels outside the frame for one more pixel of target length.
constexpr double kOutside = 8.0;
/// Halves this equal are taken for equal all the way down: lengths may then leave their range by as
/// much.
constexpr double kEqual = 0.05;
/// Of blur to one of distance between vertices, with factors of 1.
constexpr double kBlurSteps = 16.0;
/// Of a length in single precision, the part by which it may be off, blur included.
constexpr float kSlack = 2e-3f;
constexpr double kLeastSure = 0.1;             ///< dicing rate, pixels
constexpr float kMostRounding = 1.0f / 50.0f;  ///< pixels
/// Of vertices for each that blur leaves, below which something is sharp.
constexpr double kMostSpared = 2.0;
/// Largest length over distance of what is not shown.
constexpr double kNearby = 0.5;

/// What is rough is shaded sample by sample (shade/left_to_samples.h): the more of these, the less
/// finer micropolygons cost beside them.  Samples that a noise threshold ends may be the fewest.
int rough_levels(const Options& options) {
    if (!options.refine_samples) return 0;
    const int samples = options.noise_threshold > 0.0f
                            ? std::min(options.min_samples, options.samples)
                            : options.samples;
    return samples >= 192 ? 2 : samples >= 16 ? 1 : 0;
}

double distance_to_segment(const Vec3d& a, const Vec3d& b) {
    const Vec3d d = b - a;
    const double squared = glm::dot(d, d);
    const double t = squared > 0.0 ? glm::clamp(-glm::dot(a, d) / squared, 0.0, 1.0) : 0.0;
    return glm::length(a + d * t);
}

}  // namespace

/// The raster box of an edge over all knots and lens points.
struct EdgeRate::Swept {
    double x0 = std::numeric_limits<double>::infinity(), x1 = -x0, y0 = x0, y1 = -x0;
    bool clipped = false;
    bool seen = false;
};

EdgeRate::EdgeRate(const View& view, double longer, bool displaced)
    : m_projection(view.projection),
      m_rate(std::max<double>(view.scene->options.dicing_rate, kFinest) * longer),
      m_shading_rate(std::max<double>(m_rate, view.scene->options.shading_rate)),
      m_width(view.scene->options.width),
      m_height(view.scene->options.height),
      m_motion_factor(view.scene->options.motion_factor * view.scene->options.row_exposure()),
      m_focus_factor(view.scene->options.focus_factor),
      m_displaced(displaced),
      m_most_rough(displaced && view.has_light ? rough_levels(view.scene->options) : 0),
      m_near(view.projection.perspective ? std::max(view.projection.near_clip, 1e-9)
                                         : view.projection.near_clip),
      m_rounding(static_cast<float>(std::ldexp(
          m_width + m_height + std::abs(m_projection.center.x) + std::abs(m_projection.center.y),
          -21))),
      m_seen(m_projection, m_width, m_height) {}

Vec2d EdgeRate::add(Swept& swept, const Vec3f& a, const Vec3f& b) const {
    Vec3d p(a), q(b);
    if (m_projection.perspective && (p.z < m_near || q.z < m_near)) {
        swept.clipped = true;
        if (p.z < m_near && q.z < m_near) return Vec2d(0.0);
        (p.z < m_near ? p : q) = p + (q - p) * ((m_near - p.z) / (q.z - p.z));
    }
    const Vec2d from = add_place(swept, p), to = add_place(swept, q);
    return to - from;
}

Vec2d EdgeRate::add_place(Swept& swept, const Vec3d& p) const {
    const double w = m_projection.perspective ? 1.0 / p.z : 1.0;
    const double x = m_projection.center.x + m_projection.scale.x * p.x * w;
    const double y = m_projection.center.y + m_projection.scale.y * p.y * w;
    const double reach = m_projection.lens_reach(p.z) * w;
    swept.x0 = std::min(swept.x0, x - m_projection.scale.x * reach);
    swept.x1 = std::max(swept.x1, x + m_projection.scale.x * reach);
    swept.y0 = std::min(swept.y0, y - m_projection.scale.y * reach);
    swept.y1 = std::max(swept.y1, y + m_projection.scale.y * reach);
    swept.seen = true;
    return {x, y};
}

bool EdgeRate::add_motion(Blur& blur, const Vec3f& first, const Vec3f& last) const {
    if (!(m_motion_factor > 0.0)) return true;
    Vec2d place[2];
    for (int i = 0; i < 2; ++i) {
        const Vec3d p(i == 0 ? first : last);
        if (m_projection.perspective && !(p.z >= m_near)) return false;
        place[i] = Vec2d(m_projection.scale) * Vec2d(p) / (m_projection.perspective ? p.z : 1.0);
    }
    const double way = glm::distance(place[0], place[1]);
    if (way * m_motion_factor > kBlurSteps) {
        blur.direction = (place[1] - place[0]) / way;
        blur.along = way * m_motion_factor / kBlurSteps;
    }
    return true;
}

template <class Depths>
void EdgeRate::add_lens(Blur& blur, int knots, Depths depths) const {
    if (!m_projection.has_lens() || !(m_focus_factor > 0.0)) return;
    LeastCircle circle(m_projection);
    for (int k = 0; k < knots; ++k)
        for (const float z : depths(k)) circle.add(z);
    blur.all = std::max(1.0, circle.diameter() * m_focus_factor / kBlurSteps);
}

EdgeRate::Blur EdgeRate::blur(const Vec3f* start, const Vec3f* middle, const Vec3f* end,
                              int knots) const {
    Blur blur;
    if (knots > 1 && !add_motion(blur, middle[0], middle[knots - 1])) return blur;
    add_lens(blur, knots, [&](int k) { return std::array{start[k].z, middle[k].z, end[k].z}; });
    return blur;
}

double EdgeRate::spared(const Vec3f* p, int knots) const {
    const Blur there = blur(p, p, p, knots);
    return there.along * there.all * there.all;
}

bool EdgeRate::shows_sharp(const Vec3f* p, int knots, int frame) const {
    const Vec3f& at = p[frame];
    if (m_projection.perspective && !(at.z >= m_near)) return false;
    const Vec2d place = m_projection.center + Vec2d(m_projection.scale) * Vec2d(at) /
                                                  (m_projection.perspective ? at.z : 1.0);
    return place.x >= 0.0 && place.y >= 0.0 && place.x <= m_width && place.y <= m_height &&
           spared(p, knots) < kMostSpared;
}

double EdgeRate::outside(const Swept& swept) const {
    const double dx = std::max({0.0, -swept.x1, swept.x0 - m_width});
    const double dy = std::max({0.0, -swept.y1, swept.y0 - m_height});
    return std::max(dx, dy);
}

double EdgeRate::outside(const RasterBounds& bounds) const {
    return outside(Swept{bounds.x0, bounds.x1, bounds.y0, bounds.y1});
}

bool EdgeRate::inside(const RasterBounds& bounds) const {
    return bounds.x0 >= 0.0f && bounds.y0 >= 0.0f && bounds.x1 <= m_width && bounds.y1 <= m_height;
}

double EdgeRate::angle(const Vec3f* start, const Vec3f* middle, const Vec3f* end, int knots) const {
    double largest = 0.0;
    for (int k = 0; k < knots; ++k) {
        const Vec3d a(start[k]), m(middle[k]), b(end[k]);
        const double distance = std::min(distance_to_segment(a, m), distance_to_segment(m, b));
        const double length = glm::distance(a, m) + glm::distance(m, b);
        largest = std::max(largest, length / std::max(distance, m_near));
    }
    return largest;
}

bool EdgeRate::stays_whole(const Vec3f* start, const Vec3f* end, int knots) const {
    Swept swept;
    double longest = 0.0;
    for (int k = 0; k < knots; ++k) {
        const Vec2d there = add(swept, start[k], end[k]);
        longest = std::max(longest, length(glm::length(there), there, start[k], end[k]));
    }
    return !swept.clipped && outside(swept) == 0.0 && longest <= M_SQRT2 * m_rate;
}

bool EdgeRate::in_frame(std::span<const Bounds3f> boxes) const {
    if (!inside(raster_bound_of(m_projection, boxes))) return false;
    const auto ahead = [&](const Bounds3f& box) { return box.lo.z > 1.001 * m_near; };
    return !m_projection.perspective || std::ranges::all_of(boxes, ahead);
}

int EdgeRate::sure_levels(const Vec3f* start, const Vec3f* end, int knots) const {
    // Otherwise the rounding of its middle may bend a piece by what counts.
    if (m_rate < kLeastSure || m_rounding > kMostRounding) return kUnsure;
    const auto exceeds = [&](float length, double limit) {
        const float slack = kSlack * length + m_rounding;
        return length - slack > limit ? 1 : length + slack <= limit ? 0 : kUnsure;
    };
    float longest2 = 0.0f;
    bool equal = true;  // are its halves
    for (int k = 0; k < knots; ++k) {
        const Vec2f there = piece(start[k], end[k]);
        const float counts2 = length2(there, start[k], end[k]);
        if (!std::isfinite(counts2)) return kUnsure;
        longest2 = std::max(longest2, counts2);
        if (m_projection.perspective)
            equal &= std::abs(start[k].z - end[k].z) <=
                     0.8f * static_cast<float>(kEqual) * std::min(start[k].z, end[k].z);
    }
    if (exceeds(std::sqrt(longest2), M_SQRT2 * m_rate) == 0) return 0;
    if (!equal) return kUnsure;
    Blur blurred;
    const int last = knots - 1;
    if (last > 0) add_motion(blurred, 0.5f * (start[0] + end[0]), 0.5f * (start[last] + end[last]));
    // A circle is smallest at an end, or both ends lie on either side of the sharp plane.
    add_lens(blurred, knots, [&](int k) { return std::array{start[k].z, end[k].z}; });
    double counted = 0.0;
    for (int k = 0; k < knots; ++k) {
        const Vec2d there(piece(start[k], end[k]));
        counted = std::max(counted, length(blurred.length(there), there, start[k], end[k]));
    }
    int levels = 0;
    double limit = M_SQRT2 * m_rate * blurred.all;
    while (exceeds(static_cast<float>(counted), limit) == 1) ++levels, limit *= 2.0;
    return exceeds(static_cast<float>(counted), limit) == 0 ? levels : kUnsure;
}

int EdgeRate::levels(const Vec3f* start, const Vec3f* middle, const Vec3f* end, int knots,
                     int budget, double most_outside) const {
    if (budget <= 0) return 0;
    const Blur blurred = blur(start, middle, end, knots);
    Swept swept;
    double longest = 0.0, counted = 0.0, sag = 0.0;
    bool equal = true;
    const auto measure = [&](const Vec3f& a, const Vec3f& m, const Vec3f& b) {
        Vec2d pieces[2], whole;
        if (!m_projection.perspective || std::min({a.z, m.z, b.z}) >= m_near) {
            // As below, each place once.
            const Vec2d from = add_place(swept, Vec3d(a)), by = add_place(swept, Vec3d(m)),
                        to = add_place(swept, Vec3d(b));
            pieces[0] = by - from, pieces[1] = to - by, whole = to - from;
        } else {
            pieces[0] = add(swept, a, m), pieces[1] = add(swept, m, b), whole = add(swept, a, b);
        }
        const double first = glm::length(pieces[0]), second = glm::length(pieces[1]);
        const double chord = glm::length(whole);
        const double both = first + second;
        longest = std::max(longest, both);
        const double count_first = length(blurred.length(pieces[0]), pieces[0], a, m);
        const double count_second = length(blurred.length(pieces[1]), pieces[1], m, b);
        counted = std::max(counted, count_first + count_second);
        const auto differ = [](double x, double y) {
            return std::abs(x - y) > kEqual * std::max(x, y);
        };
        // Of what is displaced a piece may be seen end-on and count all the same.
        if (differ(first, second) || (m_displaced && differ(count_first, count_second)))
            equal = false;
        // The height of the triangle start, middle, end over its chord, by Heron's formula.
        const double s = 0.5 * (both + chord);
        const double area2 = s * (s - first) * (s - second) * (s - chord);
        const double height =
            chord > 0.25 * both ? 2.0 * std::sqrt(std::max(area2, 0.0)) / chord : 0.5 * both;
        sag = std::max(sag, height);
    };
    if (m_projection.perspective && knots > 1) {
        // All knots are in the bound, those at which it is seen are measured.
        const auto bound = [&](const Vec3f& a, const Vec3f& m, const Vec3f& b) {
            add(swept, m, a);
            add(swept, m, b);
        };
        m_seen.for_each(start, middle, end, knots, measure, bound);
    } else {
        for (int k = 0; k < knots; ++k) measure(start[k], middle[k], end[k]);
    }
    const double off = swept.seen ? std::min(outside(swept), most_outside) : 0.0;
    const double target = (m_rate + off / kOutside) * blurred.all, coarser = target / m_rate;
    if (m_projection.perspective && (swept.clipped || off > 0.0)) {
        const double seen_angle = angle(start, middle, end, knots);
        if (seen_angle > kNearby) return kAdaptive;
        if (off > 0.0) {
            const double most = seen_angle * std::max(m_projection.scale.x, m_projection.scale.y);
            longest = std::min(longest, most);
            counted = std::min(counted, most);
        }
    }
    if (!swept.seen) return 0;
    // Sag falls to a quarter and length to half with each level.
    const auto bent = [&](int level) {
        const double h = std::ldexp(sag, -2 * level), l = std::ldexp(longest, -level);
        return (h > kSag * coarser || h > kBend * l) && l > kShortest * coarser;
    };
    if (!(counted > M_SQRT2 * target) && !bent(0)) return 0;
    const bool inside = swept.x0 > -m_width && swept.x1 < 2.0 * m_width && swept.y0 > -m_height &&
                        swept.y1 < 2.0 * m_height;
    // A bent piece's halves are looked at anew until they are nearly straight.
    if (!equal || swept.clipped || off > 0.0 || !inside || sag > 0.05 * longest) return kAdaptive;
    int levels = 1;
    while (levels < budget && std::ldexp(counted, -levels) > M_SQRT2 * target) ++levels;
    while (levels < budget && bent(levels)) ++levels;
    return levels;
}

}  // namespace granita
