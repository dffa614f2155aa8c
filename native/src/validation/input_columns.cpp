// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/input_columns.hpp"

#include <algorithm>
#include <atomic>

#include "base/index.hpp"
#include "base/parallel_counts.hpp"
#include "exact/orient2d.hpp"
#include "spatial/point_bins.hpp"
#include "validation/plan_tests.hpp"

namespace realmodel::validation {

namespace {

bool contains(const std::array<PlanPosition, 3>& p, const PlanPosition& place) {
    const int turn = exact::orient2d(p[0], p[1], p[2]);
    if (turn == 0) return false;
    for (std::size_t i = 0; i < 3; ++i) {
        if (exact::orient2d(p[i], p[(i + 1) % 3], place) == -turn) return false;
    }
    return true;
}

/// Of several threads the lowest number stays, whichever comes first.
void keep_lowest(std::int32_t& kept, std::int32_t number) {
    std::atomic_ref<std::int32_t> entry(kept);
    std::int32_t known = entry.load(std::memory_order_relaxed);
    while ((known < 0 || number < known) &&
           !entry.compare_exchange_weak(known, number, std::memory_order_relaxed)) {
    }
}

}  // namespace

InputColumns::InputColumns(const ModelInput& input, const Probes& probes,
                           const PlanRounding& rounding, const Execution& execution)
    : near_edge_(probes.probes.size(), 0) {
    std::vector<PlanPosition> places;
    for (const Probe& probe : probes.probes)
        places.push_back(probe.place);
    const spatial::PointBins bins(places);
    for (const strata::StackInput& rock : input.rocks)
        surfaces_ += rock.surfaces.size();
    triangle_.assign(places.size() * surfaces_, -1);

    /// Calls visit(probe, triangle) for all triangles of a mesh that contain a probe.
    const auto look = [&](std::span<const double> vertices, std::size_t columns,
                          std::span<const std::int32_t> triangles, const auto& visit) {
        parallel_each(triangles.size() / 3, execution, [&](std::size_t t) {
            std::array<PlanPosition, 3> p;
            for (std::size_t i = 0; i < 3; ++i) {
                const double* row = &vertices[index(triangles[3 * t + i]) * columns];
                p[i] = {row[0], row[1]};
            }
            const spatial::PlanBox box = spatial::box_around(p).widened(rounding.near);
            bins.within(box, [&](std::size_t i, const PlanPosition&) {
                for (std::size_t e = 0; e < 3; ++e) {
                    if (passes(p[e], p[(e + 1) % 3], places[i], rounding.near)) mark(near_edge_[i]);
                }
                if (contains(p, places[i])) visit(i, static_cast<std::int32_t>(t));
            });
        });
    };
    std::size_t first = 0;
    for (const strata::StackInput& rock : input.rocks) {
        for (std::size_t k = 0; k < rock.surfaces.size(); ++k) {
            const TriangleView& s = rock.surfaces[k];
            look(s.vertices, 3, s.triangles, [&](std::size_t probe, std::int32_t t) {
                keep_lowest(triangle_[probe * surfaces_ + first + k], t);
            });
        }
        if (rock.region) {
            std::vector<std::uint8_t> inside(places.size(), 0);
            look(rock.region->vertices, 2, rock.region->triangles,
                 [&](std::size_t probe, std::int32_t) { mark(inside[probe]); });
            for (std::size_t i = 0; i < places.size(); ++i) {
                if (inside[i] != 0) continue;
                std::fill_n(triangle_.begin() + static_cast<std::ptrdiff_t>(i * surfaces_ + first),
                            rock.surfaces.size(), -1);
            }
        }
        first += rock.surfaces.size();
    }
}

}  // namespace realmodel::validation
