// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/tetrahedra_repair.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>
#include <vector>

#include "base/algorithms.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "simulation/element_quality.hpp"

namespace realmodel::simulation {

namespace {

using Tetrahedron = std::array<std::int32_t, 4>;
using Triangle = std::array<std::int32_t, 3>;

constexpr int kMostRounds = 20;
// Flatter ones would be under-determined: one of their faces is outside, where checkMesh sees none.
constexpr double kLeastOfCovers = 0.003;

Triangle opposite(const Tetrahedron& corners, std::size_t corner) {
    Triangle face{};
    for (std::size_t i = 0, at = 0; i < 4; ++i)
        if (i != corner) face[at++] = corners[i];
    return face;
}

template <std::size_t N>
bool has_all(const std::array<std::int32_t, N>& corners, std::span<const std::int32_t> wanted) {
    return std::ranges::all_of(
        wanted, [&](std::int32_t v) { return std::ranges::find(corners, v) != corners.end(); });
}

template <std::size_t N>
std::array<std::int32_t, N> with(std::array<std::int32_t, N> corners, std::int32_t old,
                                 std::int32_t instead) {
    std::replace(corners.begin(), corners.end(), old, instead);
    return corners;
}

/// Divides a row at a new point between some of its corners.
template <class Rows>
void split(Rows& rows, std::vector<std::int32_t>& labels, std::size_t row,
           std::span<const std::int32_t> between, std::int32_t added) {
    const auto corners = rows[row];
    rows[row] = with(corners, between[0], added);
    for (const std::int32_t v : between.subspan(1)) {
        rows.push_back(with(corners, v, added));
        labels.push_back(labels[row]);
    }
}

/// Leaves out tetrahedra that share no face with another, and points that nothing has then.
void drop_single(FilledMesh& mesh) {
    const Buckets<std::int32_t> around = rows_at(mesh, mesh.tetrahedra);
    const auto is_outside = [&](const Triangle& face) {
        return elements_beside(mesh.tetrahedra, around[index(face[0])], face)[1] < 0;
    };
    std::vector<std::uint8_t> is_single;
    for (const Tetrahedron& corners : mesh.tetrahedra) {
        bool all = true;
        for (std::size_t i = 0; i < 4; ++i)
            all = all && is_outside(opposite(corners, i));
        is_single.push_back(all);
    }
    if (std::ranges::find(is_single, 1) == is_single.end()) return;
    std::vector<std::uint8_t> is_lost;
    for (const Triangle& face : mesh.triangles)
        is_lost.push_back(
            is_single[index(elements_beside(mesh.tetrahedra, around[index(face[0])], face)[0])]);
    std::vector<std::int32_t> number(mesh.points.size(), -1);
    std::vector<Vec3> points;
    const auto keep = [&](auto& rows, std::vector<std::int32_t>& labels, const auto& is_gone) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (is_gone[i] != 0) continue;
            for (std::int32_t& v : rows[i]) {
                std::int32_t& point = number[index(v)];
                if (point < 0) {
                    point = static_cast<std::int32_t>(points.size());
                    points.push_back(mesh.points[index(v)]);
                }
                v = point;
            }
            rows[count] = rows[i];
            labels[count++] = labels[i];
        }
        rows.resize(count);
        labels.resize(count);
    };
    keep(mesh.tetrahedra, mesh.region, is_single);
    keep(mesh.triangles, mesh.surface, is_lost);
    mesh.points = std::move(points);
}

}  // namespace

TetrahedraRound::TetrahedraRound(FilledMesh& mesh)
    : mesh_(mesh),
      tetrahedra_at_(rows_at(mesh, mesh.tetrahedra)),
      triangles_at_(rows_at(mesh, mesh.triangles)),
      tetrahedra_(mesh.tetrahedra),
      triangles_(mesh.triangles),
      is_taken_(mesh.tetrahedra.size(), 0) {}

std::array<std::int32_t, 2> TetrahedraRound::beside(const Triangle& face) const {
    return elements_beside(tetrahedra_, tetrahedra_at_[index(face[0])], face);
}

bool TetrahedraRound::divide_corners(Progress* progress) {
    bool any = false;
    for (std::size_t t = 0; t < tetrahedra_.size(); ++t) {
        poll(progress, t);
        if (is_taken_[t] != 0) continue;
        // corners across from faces of the outside, then the others
        Tetrahedron order{};
        std::size_t outer = 0, inner = 4;
        for (std::size_t i = 0; i < 4; ++i) {
            const bool is_outside = beside(opposite(tetrahedra_[t], i))[1] < 0;
            order[is_outside ? outer++ : --inner] = tetrahedra_[t][i];
        }
        // Two outer faces share the edge of the two last corners, and the edge of the first two is
        // inside; three share the last corner, and the face of the others is inside.
        if (outer == 2 || outer == 3) any |= divide(std::span(order).first(outer));
    }
    return any;
}

bool TetrahedraRound::divide(std::span<const std::int32_t> between) {
    std::vector<std::int32_t> around;
    for (const std::int32_t t : tetrahedra_at_[index(between[0])]) {
        if (!has_all(tetrahedra_[index(t)], between)) continue;
        if (is_taken_[index(t)] != 0) return false;
        around.push_back(t);
    }
    Vec3 middle{};
    for (const std::int32_t v : between)
        middle = moved(middle, 1 / static_cast<double>(between.size()), mesh_.points[index(v)]);
    const std::int32_t added = checked_number(mesh_.points.size(), "points");
    mesh_.points.push_back(middle);
    for (const std::int32_t t : around) {
        for (const std::int32_t v : between) {
            if (!(six_volumes(mesh_, with(tetrahedra_[index(t)], v, added)) > 0)) {
                mesh_.points.pop_back();
                return false;
            }
        }
    }
    for (const std::int32_t t : around) {
        is_taken_[index(t)] = 1;
        split(mesh_.tetrahedra, mesh_.region, index(t), between, added);
    }
    for (const std::int32_t f : triangles_at_[index(between[0])])
        if (has_all(mesh_.triangles[index(f)], between))
            split(mesh_.triangles, mesh_.surface, index(f), between, added);
    return true;
}

bool TetrahedraRound::cover(std::span<const std::int32_t> corners, const Vec3& at) {
    struct OuterTriangle {
        std::int32_t row, region;
    };
    std::vector<OuterTriangle> outer;
    std::vector<std::int32_t> inner;
    for (const std::int32_t f : triangles_at_[index(corners[0])]) {
        if (!has_all(triangles_[index(f)], corners)) continue;
        const auto [first, second] = beside(triangles_[index(f)]);
        for (const std::int32_t t : {first, second})
            if (t >= 0 && is_taken_[index(t)] != 0) return false;
        if (second < 0)
            outer.push_back({f, mesh_.region[index(first)]});
        else
            inner.push_back(f);
    }
    // the edges that two of these faces share, and the triangles inside that end there
    struct SharedEdge {
        std::array<std::int32_t, 2> edge;
        std::vector<std::int32_t> regions, inside;
    };
    std::vector<SharedEdge> hinges;
    for (const OuterTriangle& face : outer) {
        const auto& triangle = triangles_[index(face.row)];
        for (std::size_t i = 0; i < 3; ++i) {
            if (std::ranges::find(corners, triangle[i]) != corners.end()) continue;
            const auto edge = unordered(triangle[(i + 1) % 3], triangle[(i + 2) % 3]);
            auto hinge = std::ranges::find(hinges, edge, &SharedEdge::edge);
            if (hinge == hinges.end()) hinge = hinges.insert(hinge, {edge, {}, {}});
            hinge->regions.push_back(face.region);
        }
    }
    const auto has_two = [](const SharedEdge& hinge) { return hinge.regions.size() == 2; };
    if (!std::ranges::all_of(hinges, has_two)) return false;
    for (const std::int32_t f : inner)
        for (SharedEdge& hinge : hinges)
            if (has_all(triangles_[index(f)], hinge.edge)) hinge.inside.push_back(f);

    const std::int32_t added = checked_number(mesh_.points.size(), "points");
    mesh_.points.push_back(at);
    const auto covered = [&](const OuterTriangle& face) {
        const auto& [a, b, c] = triangles_[index(face.row)];
        return std::array{a, b, c, added};
    };
    const auto is_good = [&](const OuterTriangle& face) {
        return six_volumes(mesh_, covered(face)) > 0 &&
               roundness(mesh_, covered(face)) >= kLeastOfCovers;
    };
    if (!std::ranges::all_of(outer, is_good)) {
        mesh_.points.pop_back();
        return false;
    }
    for (const std::int32_t v : corners)
        for (const std::int32_t t : tetrahedra_at_[index(v)])
            is_taken_[index(t)] = 1;
    for (const OuterTriangle& face : outer) {
        mesh_.tetrahedra.push_back(covered(face));
        mesh_.region.push_back(face.region);
        split(mesh_.triangles, mesh_.surface, index(face.row), corners, added);
    }
    for (const SharedEdge& hinge : hinges) {
        // A boundary, or a kept surface within a region. A region that only touches the outside
        // along the edge is not between the new elements.
        if (hinge.regions[0] == hinge.regions[1] && hinge.inside.size() != 1) continue;
        mesh_.triangles.push_back({hinge.edge[0], hinge.edge[1], added});
        mesh_.surface.push_back(mesh_.surface[index(hinge.inside[0])]);
    }
    return true;
}

double six_volumes(const FilledMesh& mesh, const std::array<std::int32_t, 4>& corners) {
    const auto at = [&](std::size_t i) { return mesh.points[index(corners[i])]; };
    return sixfold_volume(at(0), at(1), at(2), at(3));
}

std::array<std::int32_t, 2> elements_beside(std::span<const Tetrahedron> elements,
                                            std::span<const std::int32_t> at_corner,
                                            const Triangle& face) {
    std::array<std::int32_t, 2> beside{-1, -1};
    std::size_t count = 0;
    for (const std::int32_t t : at_corner)
        if (count < 2 && has_all(elements[index(t)], face)) beside[count++] = t;
    assert(count > 0);
    return beside;
}

void divide_corner_tetrahedra(FilledMesh& mesh, Progress* progress) {
    for (int round = 0; round < kMostRounds; ++round)
        if (!TetrahedraRound(mesh).divide_corners(progress)) break;
    drop_single(mesh);
}

namespace {

constexpr double kFlatTetrahedron = 0.002;  ///< twice the limit of checkMesh
constexpr double kMoved = 0.5;              ///< of the tolerance: how far corners on surfaces move
constexpr double kBetter = 1.02;
constexpr int kRounds = 20;
constexpr std::array kSteps{0.4, 0.2, 0.1, 0.05, 0.025};  ///< of an edge

class Thickening {
public:
    Thickening(FilledMesh& mesh, double most)
        : mesh_(mesh),
          most_(most),
          start_(mesh.points),
          around_(rows_at(mesh, mesh.tetrahedra)),
          freedom_(mesh.points.size(), kInside) {
        std::vector<std::int32_t> surface(mesh.points.size(), INT32_MIN);
        for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
            const auto& corners = mesh.triangles[f];
            const bool is_outside =
                elements_beside(mesh.tetrahedra, around_[index(corners[0])], corners)[1] < 0;
            for (const std::int32_t v : corners) {
                std::int32_t& last_surface = surface[index(v)];
                const bool is_edge = last_surface != INT32_MIN && last_surface != mesh.surface[f];
                last_surface = mesh.surface[f];
                freedom_[index(v)] =
                    std::max(freedom_[index(v)], is_outside || is_edge ? kFixed : kOnSurface);
            }
        }
    }

    /// Whether any corner of the tetrahedron was moved.
    bool thicken(std::size_t t) {
        bool any = false;
        for (const std::int32_t v : mesh_.tetrahedra[t]) {
            if (freedom_[index(v)] != kFixed && move(v, t)) any = true;
        }
        return any;
    }

private:
    enum VertexFreedom : std::uint8_t { kInside, kOnSurface, kFixed };

    /// Moves a corner across the plane of the others and across those of the faces it is of, to
    /// where the flattest element around is the roundest.
    bool move(std::int32_t v, std::size_t t) {
        std::array<Vec3, 3> others{};
        std::size_t count = 0;
        for (const std::int32_t n : mesh_.tetrahedra[t]) {
            if (n != v) others[count++] = mesh_.points[index(n)];
        }
        Vec3& at = mesh_.points[index(v)];
        const Vec3 from = at;
        double edge = 0;
        for (const Vec3& other : others)
            edge += length(minus(other, from)) / 3;
        Vec3 best = from;
        double largest = kBetter * least_roundness(mesh_, around_[index(v)]);
        const auto try_at = [&](Vec3 place) {
            const Vec3& start = start_[index(v)];
            const double far = length(minus(place, start));
            if (freedom_[index(v)] == kOnSurface && far > most_)
                place = moved(start, 0.999 * most_ / far, minus(place, start));
            at = place;
            const double roundness = least_roundness(mesh_, around_[index(v)]);
            if (roundness <= largest) return;
            largest = roundness;
            best = place;
        };
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3& a = k == 1 ? from : others[0];
            const Vec3& b = k == 2 ? from : others[1];
            const Vec3& c = k == 3 ? from : others[2];
            const Vec3 normal = triangle_normal(a, b, c);
            const double area = length(normal);
            if (!(area > 0)) continue;
            const Vec3 across = times(edge / area, normal);
            for (const double step : kSteps) {
                for (const double way : {-step, step})
                    try_at(moved(from, way, across));
            }
        }
        at = best;
        return best != from;
    }

    FilledMesh& mesh_;
    const double most_;
    const std::vector<Vec3> start_;
    const Buckets<std::int32_t> around_;
    std::vector<VertexFreedom> freedom_;
};

}  // namespace

double roundness(const FilledMesh& mesh, const std::array<std::int32_t, 4>& corners) {
    std::array<Vec3, 4> areas{};
    for (std::size_t i = 0; i < 4; ++i) {
        const auto [a, b, c] = opposite(corners, i);
        areas[i] =
            triangle_normal(mesh.points[index(a)], mesh.points[index(b)], mesh.points[index(c)]);
    }
    return determinant_of(areas);
}

double least_roundness(const FilledMesh& mesh, std::span<const std::int32_t> elements) {
    double least = 1;
    for (const std::int32_t t : elements) {
        const auto& corners = mesh.tetrahedra[index(t)];
        if (!(six_volumes(mesh, corners) > 0)) return 0;
        least = std::min(least, roundness(mesh, corners));
    }
    return least;
}

std::size_t thicken_flat_tetrahedra(FilledMesh& mesh, double tolerance, Progress* progress) {
    std::vector<std::size_t> flat;
    const auto find = [&] {
        flat.clear();
        for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
            poll(progress, t);
            if (roundness(mesh, mesh.tetrahedra[t]) < kFlatTetrahedron) flat.push_back(t);
        }
        return !flat.empty();
    };
    if (!find()) return 0;
    Thickening thickening(mesh, kMoved * tolerance);
    for (int round = 0; round < kRounds; ++round) {
        bool any = false;
        for (const std::size_t t : flat)
            any = thickening.thicken(t) || any;
        if (!any || !find()) break;
    }
    return flat.size();
}

}  // namespace realmodel::simulation
