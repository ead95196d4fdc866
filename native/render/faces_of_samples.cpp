// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/faces_of_samples.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

#include "base/object_pool.h"
#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "dice/open_instance.h"
#include "dice/raster_bound.h"
#include "math/largest_stretch.h"
#include "render/camera_rays.h"
#include "render/tile_cache.h"

namespace granita {
namespace {

/// Faces that are opened in the time of a ray and of what it meets: .4 to 3 take the same within
/// noise.
constexpr double kFacesARay = 1.0;
/// Times as much for a ray that goes on behind what it meets, and as often again as it does.
constexpr double kThrough = 4.0;
/// Faces that are opened in the time that rays' tree takes for one (1.6 us and .33, measured).
constexpr double kFacesOfTree = 5.0;
/// Share of faces beside which some may be missed, from which on all are opened.
constexpr double kUnsure = 1.0 / 64;

/// Of what single precision rounds, four times its last bit's half: as coordinates go through a few
/// steps.
constexpr double kRounding = 0x1p-22;

/// Pixels of the frame, and those around it whose samples count, in a bound.
Rect pixels_in(const RasterBounds& bounds, const View& view) {
    const auto from = [](float at, float least) {
        return static_cast<int>(std::floor(std::max(at, least)));
    };
    const auto to = [](float at, float most) {
        return static_cast<int>(std::ceil(std::min(at, most)));
    };
    if (!bounds.visible) return {};
    return {from(bounds.x0, view.raster_x0), from(bounds.y0, view.raster_y0),
            to(bounds.x1, view.raster_x1), to(bounds.y1, view.raster_y1)};
}

Rect tiles_of(const Rect& pixels) {
    const auto tile = [](int pixel) {
        return static_cast<int>(std::floor(static_cast<double>(pixel) / kTileSize));
    };
    return {tile(pixels.x0), tile(pixels.y0), tile(pixels.x1 - 1) + 1, tile(pixels.y1 - 1) + 1};
}

/// Whether rays can be turned by it and back.
bool is_usable(const Mat4d& camera_from_object) {
    constexpr double kMost = 1e15;
    const Mat3d turn = glm::inverse(Mat3d(camera_from_object));
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            if (!(std::abs(turn[column][row]) < kMost &&
                  std::abs(camera_from_object[column][row]) < kMost))
                return false;
    return true;
}

double largest(const Vec3f& lo, const Vec3f& hi, int axis) {
    return std::max(std::abs(static_cast<double>(lo[axis])),
                    std::abs(static_cast<double>(hi[axis])));
}

/// How far apart a mesh's points are seen by hiders, who round them in camera space and in pixels,
/// and by rays, which are rounded in its own; metres of camera space.
double rounding_of(const View& view, const Knots& knots, const SharedGeometry& shared,
                   const Bounds3f& box, const Rect& pixels) {
    const Projection& projection = view.projection;
    const double to = box.hi.z, from = std::max(projection.near_clip, double{box.lo.z});
    const double aside = std::max(largest(box.lo, box.hi, 0), largest(box.lo, box.hi, 1)) +
                         std::max(projection.lens_reach(from), projection.lens_reach(to));
    double stretch = 0.0, own = 0.0;
    for (const Mat4d& m : knots.camera_from_object) stretch = std::max(stretch, largest_stretch(m));
    const Bounds3f& object = shared.frame_box();
    for (int axis = 0; axis < 3; ++axis) own = std::max(own, largest(object.lo, object.hi, axis));
    const double across = std::max(pixels.width(), pixels.height()) + kTileSize;
    const double pixel = (projection.perspective ? to : 1.0) /
                         std::min(std::abs(projection.scale.x), std::abs(projection.scale.y));
    return kRounding * (aside + stretch * own + (to - from) + across * pixel);
}

/// From camera to object space.
struct Into {
    explicit Into(const Mat4d& camera_from_object)
        : origin(camera_from_object[3]), turn(glm::inverse(Mat3d(camera_from_object))) {}
    Vec3d origin;
    Mat3d turn;
};

}  // namespace

/// One that is looked for.
struct FacesOfSamples::Mesh {
    const MeshRays& rays;
    const Knots& knots;
    Into still;      ///< of what stands still
    double nearest;  ///< no depth of it is less
    float rounding;  ///< metres
};

FacesOfSamples::FacesOfSamples(const View& view, std::shared_ptr<const SampleLevels> levels,
                               const ShadingSystem& shading, std::shared_ptr<PersistentRays> rays,
                               const Progress& progress)
    : m_view(view),
      m_levels(std::move(levels)),
      m_shading(shading),
      m_progress(progress),
      m_rays(*view.scene, std::move(rays), progress) {
    static std::atomic<std::uint64_t> count{0};
    m_number = ++count;
    m_instances.resize(view.scene->geometries.size());
    for (const Instance& instance : view.scene->instances)
        if (instance.visible_camera) ++m_instances[static_cast<std::size_t>(instance.geometry)];
}

bool FacesOfSamples::lets_through(const Instance& instance) const {
    if (instance.materials.empty()) return m_shading.opacity_varies(-1);
    return std::ranges::any_of(instance.materials, [&](std::int32_t material) {
        return m_shading.opacity_varies(material);
    });
}

bool FacesOfSamples::pays(double rays, const SharedGeometry& shared, const Instance& instance,
                          bool goes_on) const {
    const auto geometry = static_cast<std::size_t>(instance.geometry);
    const auto faces = static_cast<double>(shared.patches().size());
    double cost = rays * kFacesARay;
    if (!m_rays.was_there(geometry, goes_on)) cost += kFacesOfTree * faces / m_instances[geometry];
    if (goes_on && cost <= faces)
        cost += rays * kFacesARay * (kThrough - 1.0 + m_rays.layers(geometry, shared));
    return cost <= faces;
}

std::optional<std::vector<std::uint32_t>> FacesOfSamples::of(
    std::size_t index, const std::shared_ptr<const SharedGeometry>& shared,
    const Knots& knots) const {
    const Instance& instance = m_view.scene->instances[index];
    const std::vector<Bounds3f> boxes = instance_boxes(m_view, index);
    const Rect pixels = pixels_in(raster_bound_of(m_view.projection, boxes), m_view);
    if (pixels.empty()) return std::nullopt;
    double rays = 0.0;
    for (int level = 0; level < m_levels->count(); ++level)
        rays += static_cast<double>(pixels.width()) * pixels.height() *
                m_levels->table(level).samples();
    const bool goes_on = lets_through(instance);
    if (!pays(rays, *shared, instance, goes_on)) return std::nullopt;
    if (!std::ranges::all_of(knots.camera_from_object, is_usable)) return std::nullopt;

    Bounds3f box;
    for (const Bounds3f& b : boxes) box.add(b);
    const auto material_of = [&](std::uint32_t face) {
        return instance.material(shared->data().slot(face));
    };
    std::function<bool(std::uint32_t)> passes;
    if (goes_on)
        passes = [&](std::uint32_t face) { return m_shading.opacity_varies(material_of(face)); };
    const MeshRays mesh_rays(
        m_rays.mesh(static_cast<std::size_t>(instance.geometry), shared, goes_on), *shared, passes);
    const Mesh mesh{mesh_rays, knots, Into(knots.camera_from_object[0]),
                    std::max(m_view.projection.near_clip, static_cast<double>(box.lo.z)),
                    static_cast<float>(rounding_of(m_view, knots, *shared, box, pixels))};
    auto patches = met(mesh, pixels);
    m_view.statistics->add(Counter::RaysOpening, static_cast<std::uint64_t>(rays));
    return patches;
}

std::optional<std::vector<std::uint32_t>> FacesOfSamples::met(const Mesh& mesh,
                                                              const Rect& pixels) const {
    std::vector<std::uint32_t> patches;
    std::uint64_t all = 0, unsure = 0;
    std::mutex mutex;
    const Rect tiles = tiles_of(pixels);
    const auto tile_count = static_cast<std::size_t>(tiles.width()) * tiles.height();
    constexpr std::size_t kGrain = 4;
    parallel_for(tile_count, kGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t> found;
        MeshRays::Work work;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec2i tile(tiles.x0 + static_cast<int>(i) % tiles.width(),
                             tiles.y0 + static_cast<int>(i) / tiles.width());
            for (int level = 0; level < m_levels->count(); ++level)
                look(mesh, m_levels->table(level), tile, pixels, found, work);
        }
        const std::lock_guard lock(mutex);
        patches.insert(patches.end(), found.begin(), found.end());
        all += work.met;
        unsure += work.unsure;
    });
    if (static_cast<double>(unsure) > kUnsure * static_cast<double>(all)) return std::nullopt;
    parallel_sort(patches);
    patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
    return patches;
}

void FacesOfSamples::look(const Mesh& mesh, const SampleTable& table, Vec2i tile,
                          const Rect& pixels, std::vector<std::uint32_t>& patches,
                          MeshRays::Work& work) const {
    auto cache = ObjectPool<TileCache>::take();
    const TileSamples& samples = cache.samples(m_number, table, tile);
    const Rect here = pixels.intersect({tile.x * kTileSize, tile.y * kTileSize,
                                        (tile.x + 1) * kTileSize, (tile.y + 1) * kTileSize});
    const Vec2d corner(tile * kTileSize);
    const auto count = static_cast<std::size_t>(samples.samples);
    const Projection& projection = m_view.projection;
    const bool moves = !is_static(mesh.knots.camera_from_object);
    Rounding rounding{Mat3f(mesh.knots.camera_from_object[0]), mesh.rounding};
    for (int y = here.y0; y < here.y1; ++y) {
        m_progress.check();
        for (int x = here.x0; x < here.x1; ++x) {
            const auto pixel = static_cast<std::size_t>((y - tile.y * kTileSize) * kTileSize + x -
                                                        tile.x * kTileSize);
            for (std::size_t i = pixel * count; i < (pixel + 1) * count; ++i) {
                const CameraSample at = camera_sample_of(samples, i, projection);
                const CameraLine line =
                    camera_line(projection, corner + Vec2d(samples.x[i], samples.y[i]), at);
                Into into = mesh.still;
                if (moves) {
                    const Mat4d m = matrix_at(mesh.knots.camera_from_object, at.t);
                    into = Into(m);
                    rounding.to_measured = Mat3f(m);
                }
                // From close by: what is far away would be rounded more than faces are large.
                mesh.rays.meet({Vec3f(into.turn * (line.at(mesh.nearest) - into.origin)),
                                Vec3f(into.turn * line.way), std::numeric_limits<float>::infinity(),
                                static_cast<float>(at.t)},
                               rounding, patches, work);
            }
        }
    }
    ObjectPool<TileCache>::give(std::move(cache));
}

}  // namespace granita
