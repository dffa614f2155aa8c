// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <tuple>

#include "conforming.hpp"
#include "distinct_positions.hpp"
#include "parallel_chunks.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {

using exact::PlanGeometry;

namespace {

/// A height that faces have at one place.
struct Height {
    double z;
    PlaneId plane;
};

/// The heights of the planes at one place, ascending, each once; `rank` gives the height of each
/// plane. Rounded heights keep the order; where they are equal, the exact test decides.
class HeightSorter {
public:
    explicit HeightSorter(const PlanGeometry& geometry) : scope_(geometry) {}

    void sort(PointId point, std::vector<PlaneId>& planes) {
        std::sort(planes.begin(), planes.end());
        planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
        all_.clear();
        for (const PlaneId plane : planes) {
            all_.push_back({scope_.rounded_height(plane, point), plane});
        }
        const auto lower = [&](const Height& a, const Height& b) {
            if (a.z != b.z) return a.z < b.z;
            if (a.plane == b.plane) return false;
            return scope_.compare_heights(b.plane, a.plane, point) > 0;
        };
        std::stable_sort(all_.begin(), all_.end(), lower);
        heights_.clear();
        rank_.assign(planes.size(), 0);
        for (std::size_t i = 0; i < all_.size(); ++i) {
            if (i == 0 || lower(all_[i - 1], all_[i])) heights_.push_back(all_[i].z);
            const auto at = std::lower_bound(planes.begin(), planes.end(), all_[i].plane);
            rank_[static_cast<std::size_t>(at - planes.begin())] =
                static_cast<std::int32_t>(heights_.size()) - 1;
        }
        planes_ = &planes;
    }
    const std::vector<double>& heights() const { return heights_; }
    std::int32_t rank(PlaneId plane) const {
        const auto at = std::lower_bound(planes_->begin(), planes_->end(), plane);
        return rank_[static_cast<std::size_t>(at - planes_->begin())];
    }

private:
    Scope scope_;
    std::vector<Height> all_;
    std::vector<double> heights_;
    std::vector<std::int32_t> rank_;
    const std::vector<PlaneId>* planes_ = nullptr;
};

}  // namespace

Loops find_loops(const PlanGeometry& geometry, const FaceList& faces, const Places& places,
                 const Tracks& tracks, int threads, const Progress* progress) {
    Loops loops;
    const auto& corners = faces.polygons.corners;
    loops.edge_offsets.resize(corners.size() + 1);
    loops.edge_offsets[0] = 0;
    for (std::size_t e = 0; e < corners.size(); ++e) {
        loops.edge_offsets[e + 1] = loops.edge_offsets[e] + tracks.high[e] - tracks.low[e];
    }
    loops.face_offsets.resize(faces.size() + 1);
    for (std::size_t f = 0; f <= faces.size(); ++f) {
        loops.face_offsets[f] =
            loops.edge_offsets[static_cast<std::size_t>(faces.polygons.offsets[f])];
    }
    const auto entries = static_cast<std::size_t>(loops.edge_offsets.back());
    std::vector<PlaceId> place(entries);
    std::vector<PlaneId> plane(entries);
    for (std::size_t f = 0; f < faces.size(); ++f) {
        poll(progress, f);
        for (auto c = faces.polygons.offsets[f]; c < faces.polygons.offsets[f + 1]; ++c) {
            const auto e = static_cast<std::size_t>(c);
            const auto track = static_cast<std::size_t>(
                tracks.of_line[static_cast<std::size_t>(exact::line_of(corners[e].line))]);
            const PlaceId* along = tracks.places.data() + tracks.place_offsets[track];
            for (std::int32_t i = 0; i < tracks.high[e] - tracks.low[e]; ++i) {
                const auto entry = static_cast<std::size_t>(loops.edge_offsets[e] + i);
                place[entry] =
                    along[tracks.forward[e] != 0 ? tracks.low[e] + i : tracks.high[e] - i];
                plane[entry] = faces.plane[f];
            }
        }
    }
    const std::size_t place_count = places.representative.size();
    std::vector<std::int64_t> offsets(place_count + 1, 0);
    for (const PlaceId p : place)
        ++offsets[static_cast<std::size_t>(p) + 1];
    for (std::size_t p = 0; p < place_count; ++p)
        offsets[p + 1] += offsets[p];
    std::vector<std::int64_t> at_place(entries);
    {
        auto free = offsets;
        for (std::size_t i = 0; i < entries; ++i) {
            poll(progress, i);
            at_place[static_cast<std::size_t>(free[static_cast<std::size_t>(place[i])]++)] =
                static_cast<std::int64_t>(i);
        }
    }
    loops.vertices.resize(entries);  // ranks for now
    std::vector<std::int32_t> count(place_count);
    constexpr std::size_t kChunk = 2048;
    const std::size_t chunks = (place_count + kChunk - 1) / kChunk;
    std::vector<std::vector<double>> heights(chunks);
    parallel_chunks(chunks, threads, progress, [&](std::size_t chunk) {
        HeightSorter sorter(geometry);
        std::vector<PlaneId> planes;
        for (std::size_t p = chunk * kChunk; p < std::min(place_count, (chunk + 1) * kChunk); ++p) {
            planes.clear();
            for (auto i = offsets[p]; i < offsets[p + 1]; ++i) {
                planes.push_back(
                    plane[static_cast<std::size_t>(at_place[static_cast<std::size_t>(i)])]);
            }
            sorter.sort(places.representative[p], planes);
            for (auto i = offsets[p]; i < offsets[p + 1]; ++i) {
                const auto entry = static_cast<std::size_t>(at_place[static_cast<std::size_t>(i)]);
                loops.vertices[entry] = sorter.rank(plane[entry]);
            }
            count[p] = static_cast<std::int32_t>(sorter.heights().size());
            heights[chunk].insert(heights[chunk].end(), sorter.heights().begin(),
                                  sorter.heights().end());
        }
    });
    std::int64_t total = 0;
    for (std::size_t p = 0; p < place_count; ++p) {
        loops.place_offsets.push_back(static_cast<std::int32_t>(total));
        total += count[p];
        if (total > INT32_MAX) {
            throw InputError("too_large",
                             "the model has more than 2147 million vertices; use coarser surfaces");
        }
    }
    loops.place_offsets.push_back(static_cast<std::int32_t>(total));
    for (std::size_t i = 0; i < entries; ++i) {
        poll(progress, i);
        loops.vertices[i] += loops.place_offsets[static_cast<std::size_t>(place[i])];
    }
    loops.positions.resize(static_cast<std::size_t>(total));
    std::size_t v = 0;
    std::size_t p = 0;
    for (const auto& of_chunk : heights) {
        for (const double z : of_chunk) {
            while (v >= static_cast<std::size_t>(loops.place_offsets[p + 1]))
                ++p;
            const auto& point = geometry.point(places.representative[p]);
            loops.positions[v++] = {point.x, point.y, z};
        }
    }
    return loops;
}

}  // namespace realmodel::strata
