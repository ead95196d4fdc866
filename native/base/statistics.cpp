// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/statistics.h"

namespace granita {
namespace {

constexpr std::array kCounterNames = {
    "primitives_opened",   "primitives_split",
    "primitives_culled",   "primitives_culled_in_time",
    "grids_diced",         "grids_culled",
    "grids_swept",         "grids_shaded",
    "grids_shaded_before", "grids_opacity_shaded",
    "points_diced",        "points_spared",
    "points_shaded",       "points_refined",
    "micropolygons",       "micropolygons_dropped",
    "samples_total",       "tiles_resampled",
    "sample_tests_static", "sample_tests_moving",
    "sample_hits",         "fragments_stored",
    "buckets_moving",      "buckets_transparent",
    "buckets_seen_before", "gl_primitives",
    "gl_passes",           "gl_dispatches",
    "rays_opening",        "rays_shadow",
    "rays_occlusion",      "rays_bounce",
    "hits_shaded",         "lamps_chosen",
    "light_nodes",         "texture_lookups",
    "loop_pieces_shared",
};
static_assert(kCounterNames.size() == static_cast<std::size_t>(Counter::kCount));

constexpr std::array kStageNames = {"open",  "split",   "dice", "hide",
                                    "shade", "resolve", "film", "ray_build"};
static_assert(kStageNames.size() == static_cast<std::size_t>(Stage::kCount));

void raise(std::atomic<std::uint64_t>& peak, std::uint64_t value) {
    auto last = peak.load(std::memory_order_relaxed);
    while (value > last && !peak.compare_exchange_weak(last, value)) {
    }
}

}  // namespace

void Statistics::add_seconds(Stage stage, double seconds) {
    m_nanoseconds[static_cast<int>(stage)].fetch_add(static_cast<std::uint64_t>(seconds * 1e9),
                                                     std::memory_order_relaxed);
}

double Statistics::seconds(Stage stage) const {
    return 1e-9 * static_cast<double>(m_nanoseconds[static_cast<int>(stage)].load());
}

void Statistics::add_grid_bytes(std::uint64_t added) {
    raise(m_peak_grid_bytes, m_grid_bytes.fetch_add(added) + added);
}

void Statistics::note_list_bytes(std::uint64_t bytes) {
    raise(m_peak_list_bytes, bytes);
}

std::vector<std::pair<std::string, double>> Statistics::list() const {
    std::vector<std::pair<std::string, double>> list;
    list.reserve(kCounterNames.size() + kStageNames.size() + 3);
    for (int i = 0; i < static_cast<int>(Counter::kCount); ++i)
        list.emplace_back(kCounterNames[i], static_cast<double>(m_counters[i].load()));
    for (int i = 0; i < static_cast<int>(Stage::kCount); ++i)
        list.emplace_back(std::string("seconds_") + kStageNames[i],
                          1e-9 * static_cast<double>(m_nanoseconds[i].load()));
    list.emplace_back("peak_grid_bytes", static_cast<double>(m_peak_grid_bytes.load()));
    list.emplace_back("peak_ray_bytes", static_cast<double>(m_peak_ray_bytes.load()));
    list.emplace_back("peak_list_bytes", static_cast<double>(m_peak_list_bytes.load()));
    return list;
}

}  // namespace granita
