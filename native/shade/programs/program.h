// SPDX-License-Identifier: GPL-3.0-or-later
// A compiled node program: array operations over all points of a grid at once (Cook, Carpenter and
// Catmull 1987; Wexler et al. 2005, section 9.3.2).
//
//   slot      an array of one float or one Vec3f a point
//   source    a slot, or a constant when the value is the same everywhere
//   load      copies a grid attribute into a slot, at the point or some way along u or v
//   step      one operation: reads sources, writes slots
//
// A program is immutable; any number of threads run it, each with a Run of its own.
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/progress.h"
#include "dice/grid.h"
#include "geometry/attribute_request.h"
#include "math/normalize_or.h"
#include "scene/scene.h"
#include "shade/bsdf/lobe.h"
#include "shade/lights/light_pattern.h"
#include "shade/programs/slot_places.h"

namespace granita {

class RayScene;

/// Where a value is taken: at the point, or further along u or v, by a step of the grid or as far
/// as a bump is wide.  The differences are the derivatives that textures and bumps need; they
/// follow any node between (the chain rule by differences).
enum class Shift { None, U, V };

/// For normals and directions.
struct ObjectAxes {
    Mat3f world_from_object{1.0f}, object_from_world{1.0f};

    ObjectAxes() = default;
    explicit ObjectAxes(const Mat4d& from_object)
        : world_from_object(Mat3d(from_object)),
          object_from_world(glm::inverse(Mat3d(from_object))) {}
    Mat3f world_normal_from_object() const { return glm::transpose(object_from_world); }
    /// A world normal in object space, unit.
    Vec3f object_normal_of(const Vec3f& normal) const {
        return normalize_or(glm::transpose(world_from_object) * normal, normal);
    }
};

/// What a program runs over.
struct ShadingInput {
    const ShadingPoints* points = nullptr;
    const std::vector<GridAttribute>* attributes = nullptr;  ///< nullptr = none
    const Instance* instance = nullptr;                      ///< nullptr: the world
    ObjectAxes axes;
    std::vector<ObjectAxes> axes_at_times;   ///< [points] where these have times of their own
    float spread = 0.0f;                     ///< world: radians a direction stands for
    std::span<const Vec2f> rasters;          ///< world: as BackgroundRays's
    float ray_length = 0.0f;                 ///< of shadow rays, from where they started
    std::span<const PatternSample> of_lamp;  ///< [points] of lamps' programs
    const RayScene* rays = nullptr;          ///< nullptr: none can be asked
    GridKey key;                             ///< where they can: of what the points are on
    const Progress* progress = nullptr;      ///< asked before each step; may be absent

    const ObjectAxes& axes_at(std::size_t point) const {
        return axes_at_times.empty() ? axes : axes_at_times[point];
    }
};

template <class T>
struct Source {
    int slot = -1;  ///< -1: constant
    T constant{};
    bool is_constant() const { return slot < 0; }
    bool is(const T& value) const { return slot < 0 && constant == value; }
};
using FloatSource = Source<float>;
using VectorSource = Source<Vec3f>;

/// Read access to a source over all points: a constant has stride 0.
template <class T>
struct Column {
    const T* data;
    std::size_t stride;
    const T& operator[](std::size_t i) const { return data[i * stride]; }
};

/// One execution: memory for the slots.
class Run {
  public:
    /// `places`: of the program's slots, kept by it; `memory`: of an earlier run, to be used again.
    Run(const ShadingInput& input, std::size_t count, const SlotPlaces& places,
        std::vector<float> memory)
        : m_input(input), m_count(count), m_places(places), m_memory(std::move(memory)) {
        m_memory.resize(count * static_cast<std::size_t>(places.floats_a_point));
    }

    std::size_t count() const { return m_count; }
    const ShadingInput& input() const { return m_input; }
    /// How far along a point's own step a shifted value lies, for a Load's or a bump's width.
    float step_scale(float width, Shift shift, std::size_t point) const {
        return width > 0.0f ? scale_of(width, shift, point) : 1.0f;
    }
    template <class T>
    Column<T> read(const Source<T>& source) const {
        if (source.is_constant()) return {&source.constant, 0};
        return {reinterpret_cast<const T*>(m_memory.data() + first(source.slot)), 1};
    }
    template <class T>
    T* write(const Source<T>& source) {
        return reinterpret_cast<T*>(m_memory.data() + first(source.slot));
    }

    /// Once results have been read.
    std::vector<float> take_memory() { return std::move(m_memory); }

  private:
    float scale_of(float width, Shift shift, std::size_t point) const;
    std::size_t first(int slot) const {
        GRANITA_CHECK(slot >= 0);
        const int place = m_places.first[static_cast<std::size_t>(slot)];
        GRANITA_CHECK(place >= 0);
        return m_count * static_cast<std::size_t>(place);
    }

    const ShadingInput& m_input;
    std::size_t m_count;
    const SlotPlaces& m_places;
    std::vector<float> m_memory;
};

struct Load {
    int request = 0;
    Shift shift = Shift::None;
    int slot = 0;
    int width = 3;            ///< 1 or 3
    int first = 0;            ///< first component of the attribute
    float bump_width = 0.0f;  ///< as ProgramBuilder's, of what is shifted
    bool operator==(const Load&) const = default;
};

struct Step {
    std::function<void(Run&)> run;
    std::vector<int> reads, writes;  ///< slots
    /// What it writes depends on what it reads alone: not on where and when the points are.
    bool is_still = false;
    bool counts = false;  ///< it reads ShadingPoints::counts
};

class Program {
  public:
    /// Keeps what the slots `roots` need of `steps` and `loads`, in their order.
    /// @param widths [slots] floats of each.
    Program(const std::vector<Load>& loads, const std::vector<Step>& steps,
            const std::vector<int>& widths, const std::vector<int>& roots);
    Program() = default;

    /// What the slots `roots` need of it.
    Program part(const std::vector<int>& roots) const {
        return {m_loads, m_steps, m_widths, roots};
    }
    /// Runs everything; results are read from the Run.  Throws Cancelled.
    void execute(Run& run) const;
    Run prepare(const ShadingInput& input, std::size_t count,
                std::vector<float> memory = {}) const {
        return Run(input, count, m_places, std::move(memory));
    }
    const std::vector<Load>& loads() const { return m_loads; }
    /// request[old] -> new index, once the material's request list is final.
    void renumber_requests(const std::vector<int>& request);
    std::size_t step_count() const { return m_steps.size(); }
    /// Whether a place on a surface looks the same wherever it goes, and whoever looks.
    bool is_still() const;
    /// Whether it may differ from way to way (ShadingPoints::counts).
    bool counts() const { return std::ranges::any_of(m_steps, &Step::counts); }

  private:
    std::vector<Load> m_loads;
    std::vector<Step> m_steps;
    std::vector<int> m_widths;
    SlotPlaces m_places;
};

}  // namespace granita
