// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "base/algorithms.hpp"
#include "base/disjoint_sets.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "simulation/tetrahedra_repair.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::simulation {

namespace {

constexpr double kSamePatch = 0.64;       ///< cosine between normals within a patch: 50 degrees
constexpr double kOnPatch = 1e-9;         ///< of the largest coordinate: what rounding may do
constexpr double kLeastRoundness = 0.01;  ///< roundness that elements keep, if they had it
constexpr std::size_t kMostPlaces = 64;
constexpr int kSortings = 8;
constexpr int kCoverings = 3;

Vec3 nearest_on_segment(const Vec3& a, const Vec3& b, const Vec3& p) {
    const Vec3 way = minus(b, a);
    const double square = dot(way, way);
    return square > 0 ? moved(a, std::clamp(dot(minus(p, a), way) / square, 0.0, 1.0), way) : a;
}
Vec3 nearest_on_triangle(const std::array<Vec3, 3>& t, const Vec3& p) {
    // its foot, or that of an edge
    const Vec3 n = triangle_normal(t[0], t[1], t[2]);
    const Vec3 foot = moved(p, dot(minus(t[0], p), n) / dot(n, n), n);
    bool is_within = true;
    Vec3 best = t[0];
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 &a = t[i], &b = t[(i + 1) % 3];
        is_within = is_within && dot(cross(minus(b, a), minus(foot, a)), n) >= 0;
        const Vec3 at = nearest_on_segment(a, b, p);
        const double far = length(minus(at, p));
        if (far < least) {
            least = far;
            best = at;
        }
    }
    return is_within ? foot : best;
}

/// A patch of the outside that a corner is near.
struct NearPatch {
    std::int32_t patch;
    double distance;
};

/// The outside of a model: patches, of one surface and without sharp edges, and the edges between.
class Outside {
public:
    Outside(const ComplexView& model, std::span<const BoundaryTriangle> triangles, double reach)
        : reach_(reach) {
        for (const BoundaryTriangle& t : triangles) {
            if (t.behind != 0 && t.in_front != 0) continue;
            OutsideTriangle face{{}, {}, t.surface};
            for (std::size_t i = 0; i < 3; ++i) {
                face.at[i] = model.vertex(t.corners[i]);
                for (const double x : face.at[i])
                    rounding_ = std::max(rounding_, kOnPatch * std::abs(x));
            }
            face.normal = times(t.behind == 0 ? -1 : 1,
                                unit(triangle_normal(face.at[0], face.at[1], face.at[2])));
            triangles_.push_back(face);
            corners_.push_back(t.corners);
        }
        find_patches();
        std::vector<spatial::Box> boxes;
        for (const OutsideTriangle& t : triangles_)
            boxes.push_back(spatial::bounding_box(t.at));
        tree_ = spatial::BoxTree(std::move(boxes));
        boxes.clear();
        for (const Crease& crease : creases_)
            boxes.push_back(spatial::bounding_box(crease.ends));
        crease_tree_ = spatial::BoxTree(std::move(boxes));
    }

    double rounding() const { return rounding_; }
    std::int32_t surface(std::int32_t patch) const { return triangles_[index(patch)].surface; }

    /// The patches within reach of a point, by number.
    std::vector<NearPatch> patches_near(const Vec3& p) const {
        std::vector<NearPatch> patches;
        tree_.find(around(p), [&](std::int32_t t) {
            const double far = length(minus(nearest_on_triangle(triangles_[index(t)].at, p), p));
            if (far <= reach_) patches.push_back({patch_[index(t)], far});
        });
        std::ranges::sort(patches, {},
                          [](const NearPatch& n) { return std::pair(n.patch, n.distance); });
        const auto is_same = [](const NearPatch& a, const NearPatch& b) {
            return a.patch == b.patch;
        };
        patches.erase(std::unique(patches.begin(), patches.end(), is_same), patches.end());
        return patches;
    }

    /// Places on a patch within reach of a point: the nearest of each triangle and edge, in the
    /// order of their distances.
    std::vector<Vec3> places_on(std::int32_t patch, const Vec3& p) const {
        std::vector<std::pair<double, Vec3>> candidates;
        tree_.find(around(p), [&](std::int32_t t) {
            if (patch_[index(t)] != patch) return;
            const Vec3 place = nearest_on_triangle(triangles_[index(t)].at, p);
            const double far = length(minus(place, p));
            if (far <= reach_) candidates.emplace_back(far, place);
        });
        crease_tree_.find(around(p), [&](std::int32_t c) {
            const auto& [ends, patches] = creases_[index(c)];
            if (patches[0] != patch && patches[1] != patch) return;
            for (const Vec3& place : {nearest_on_segment(ends[0], ends[1], p), ends[0], ends[1]}) {
                const double far = length(minus(place, p));
                if (far <= reach_) candidates.emplace_back(far, place);
            }
        });
        std::ranges::sort(candidates);
        std::vector<Vec3> places = transformed(candidates, &std::pair<double, Vec3>::second);
        places.erase(std::unique(places.begin(), places.end()), places.end());
        if (places.size() > kMostPlaces) places.resize(kMostPlaces);
        return places;
    }

private:
    struct OutsideTriangle {
        std::array<Vec3, 3> at;
        Vec3 normal;  ///< outward
        std::int32_t surface;
    };
    struct Crease {
        std::array<Vec3, 2> ends;
        std::array<std::int32_t, 2> patches;
    };
    struct OutsideEdgeUse {
        std::array<std::int32_t, 2> edge;
        std::int32_t triangle;
    };

    void find_patches() {
        std::vector<OutsideEdgeUse> uses;
        for (std::size_t t = 0; t < corners_.size(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                uses.push_back({unordered(corners_[t][i], corners_[t][(i + 1) % 3]),
                                static_cast<std::int32_t>(t)});
            }
        }
        std::ranges::sort(uses, {},
                          [](const OutsideEdgeUse& u) { return std::pair(u.edge, u.triangle); });
        DisjointSets sets(triangles_.size());
        const auto for_each_pair = [&](const auto& visit) {
            for (const auto around : groups_of(uses, &OutsideEdgeUse::edge))
                for (std::size_t i = 1; i < around.size(); ++i)
                    visit(around[i - 1], around[i]);
        };
        for_each_pair([&](const OutsideEdgeUse& a, const OutsideEdgeUse& b) {
            const OutsideTriangle &s = triangles_[index(a.triangle)],
                                  &t = triangles_[index(b.triangle)];
            if (s.surface == t.surface && dot(s.normal, t.normal) >= kSamePatch)
                sets.join(a.triangle, b.triangle);
        });
        for (std::size_t t = 0; t < triangles_.size(); ++t)
            patch_.push_back(sets.find(static_cast<std::int32_t>(t)));
        for_each_pair([&](const OutsideEdgeUse& a, const OutsideEdgeUse& b) {
            const std::array patches{patch_[index(a.triangle)], patch_[index(b.triangle)]};
            if (patches[0] == patches[1]) return;
            const auto& corners = corners_[index(a.triangle)];
            const auto& at = triangles_[index(a.triangle)].at;
            std::array<Vec3, 2> ends{};
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t k = 0; k < 2; ++k)
                    if (corners[i] == a.edge[k]) ends[k] = at[i];
            creases_.push_back({ends, patches});
        });
    }
    spatial::Box around(const Vec3& p) const {
        spatial::Box box{p, p};
        box.widen(reach_);
        return box;
    }

    const double reach_;
    double rounding_ = 0;
    std::vector<OutsideTriangle> triangles_;
    std::vector<std::array<std::int32_t, 3>> corners_;
    std::vector<std::int32_t> patch_;  ///< of each triangle: the least triangle of its patch
    std::vector<Crease> creases_;
    spatial::BoxTree tree_{{}}, crease_tree_{{}};
};

class OutsideSorter {
public:
    OutsideSorter(FilledMesh& mesh, const Outside& outside)
        : mesh_(mesh),
          outside_(outside),
          around_(rows_at(mesh, mesh.tetrahedra)),
          near_(mesh.points.size()) {
        for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
            const auto& corners = mesh.triangles[f];
            if (elements_beside(mesh.tetrahedra, around_[index(corners[0])], corners)[1] >= 0)
                continue;
            faces_.push_back(f);
            for (const std::int32_t v : corners)
                if (near_[index(v)].empty()) look_around(v);
        }
    }

    /// Whether a corner was moved.
    bool run(Progress* progress) {
        bool any = false;
        for (std::size_t i = 0; i < faces_.size(); ++i) {
            poll(progress, i);
            const auto& corners = mesh_.triangles[faces_[i]];
            const auto patch = patch_of(corners);
            if (!patch) continue;
            mesh_.surface[faces_[i]] = outside_.surface(*patch);
            for (const std::int32_t v : corners)
                if (!is_on(near_[index(v)], *patch)) any |= move(v, *patch);
        }
        return any;
    }

    /// Covers what is still off its patch where no corner may move: edges from one patch to
    /// another by a point of both, corners that are on none.
    /// @return whether anything was
    bool cover(Progress* progress) {
        bool any = false;
        TetrahedraRound covers(mesh_);
        for (std::size_t i = 0; i < faces_.size(); ++i) {
            poll(progress, i);
            const auto corners = mesh_.triangles[faces_[i]];
            if (std::ranges::any_of(corners, [&](auto v) { return index(v) >= near_.size(); }))
                continue;  // new
            const auto patch = patch_of(corners);
            if (!patch) continue;
            for (const std::int32_t v : corners) {
                const auto& patches = near_[index(v)];
                if (is_on(patches, *patch)) continue;
                const auto other = std::ranges::find_if(patches, [&](const NearPatch& near) {
                    return near.distance <= outside_.rounding();
                });
                if (other == patches.end()) {
                    any |= cover(covers, v, *patch);
                    continue;
                }
                for (const std::int32_t u : corners)
                    if (is_on(near_[index(u)], *patch) && !is_on(near_[index(u)], other->patch))
                        any |= cover(covers, {v, u}, {other->patch, *patch});
            }
        }
        return any;
    }

private:
    bool cover(TetrahedraRound& covers, const std::array<std::int32_t, 2>& edge,
               const std::array<std::int32_t, 2>& patches) const {
        const Vec3 middle =
            times(0.5, plus(mesh_.points[index(edge[0])], mesh_.points[index(edge[1])]));
        return std::ranges::any_of(outside_.places_on(patches[0], middle), [&](const Vec3& place) {
            return is_on(outside_.patches_near(place), patches[1]) && covers.cover(edge, place);
        });
    }
    bool cover(TetrahedraRound& covers, std::int32_t v, std::int32_t patch) const {
        return std::ranges::any_of(
            outside_.places_on(patch, mesh_.points[index(v)]),
            [&](const Vec3& place) { return covers.cover(std::array{v}, place); });
    }

    void look_around(std::int32_t v) {
        near_[index(v)] = outside_.patches_near(mesh_.points[index(v)]);
    }
    /// HUGE_VAL beyond reach.
    static double distance(const std::vector<NearPatch>& near, std::int32_t patch) {
        const auto at = std::ranges::lower_bound(near, patch, {}, &NearPatch::patch);
        return at != near.end() && at->patch == patch ? at->distance : HUGE_VAL;
    }
    bool is_on(const std::vector<NearPatch>& near, std::int32_t patch) const {
        return distance(near, patch) <= outside_.rounding();
    }

    /// The patch that all corners of a face are nearest to.
    std::optional<std::int32_t> patch_of(const std::array<std::int32_t, 3>& face) const {
        std::optional<std::int32_t> best;
        double least = HUGE_VAL;
        for (const NearPatch& near : near_[index(face[0])]) {
            double far = near.distance;
            for (const std::int32_t v : face)
                far = std::max(far, distance(near_[index(v)], near.patch));
            if (!(far < least)) continue;
            least = far;
            best = near.patch;
        }
        return best;
    }

    /// Moves a corner to the nearest place of the patch that is on all patches it is on.
    bool move(std::int32_t v, std::int32_t patch) {
        Vec3& at = mesh_.points[index(v)];
        const Vec3 from = at;
        const double before = least_roundness(mesh_, around_[index(v)]);
        for (const Vec3& place : outside_.places_on(patch, from)) {
            const auto patches = outside_.patches_near(place);
            const bool stays_on = std::ranges::all_of(near_[index(v)], [&](const NearPatch& near) {
                return near.distance > outside_.rounding() || is_on(patches, near.patch);
            });
            if (!stays_on) continue;
            at = place;
            const double after = least_roundness(mesh_, around_[index(v)]);
            if (after > 0 && after >= std::min(before, kLeastRoundness)) {
                near_[index(v)] = patches;
                return true;
            }
        }
        at = from;
        return false;
    }

    FilledMesh& mesh_;
    const Outside& outside_;
    const Buckets<std::int32_t> around_;
    std::vector<std::vector<NearPatch>> near_;  ///< of each corner outside, by patch
    std::vector<std::size_t> faces_;            ///< outside
};

}  // namespace

void sort_outside_faces(FilledMesh& mesh, const ComplexView& model,
                        std::span<const BoundaryTriangle> triangles, double reach,
                        Progress* progress) {
    const Outside outside(model, triangles, reach);
    for (int covering = 0;; ++covering) {
        OutsideSorter sorter(mesh, outside);
        for (int round = 0; round < kSortings && sorter.run(progress); ++round) {
        }
        if (covering == kCoverings || !sorter.cover(progress)) return;
    }
}

}  // namespace realmodel::simulation
