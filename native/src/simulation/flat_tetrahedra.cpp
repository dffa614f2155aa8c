// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/flat_tetrahedra.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "simulation/corner_tetrahedra.hpp"

namespace realmodel::simulation {

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
            const bool is_outside = elements_at(corners) < 2;
            for (const std::int32_t v : corners) {
                std::int32_t& own = surface[index(v)];
                const bool is_edge = own != INT32_MIN && own != mesh.surface[f];
                own = mesh.surface[f];
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
    enum Freedom : std::uint8_t { kInside, kOnSurface, kFixed };

    std::size_t elements_at(const std::array<std::int32_t, 3>& face) const {
        const auto own = around_[index(face[0])];
        return static_cast<std::size_t>(std::count_if(own.begin(), own.end(), [&](std::int32_t t) {
            const auto& corners = mesh_.tetrahedra[index(t)];
            return std::find(corners.begin(), corners.end(), face[1]) != corners.end() &&
                   std::find(corners.begin(), corners.end(), face[2]) != corners.end();
        }));
    }

    double least_around(std::int32_t v) const {
        double least = 1;
        for (const std::int32_t t : around_[index(v)]) {
            const auto& corners = mesh_.tetrahedra[index(t)];
            if (!(six_volumes(mesh_, corners) > 0)) return 0;
            least = std::min(least, roundness(mesh_, corners));
        }
        return least;
    }

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
        double largest = kBetter * least_around(v);
        const auto try_at = [&](Vec3 place) {
            const Vec3& start = start_[index(v)];
            const double far = length(minus(place, start));
            if (freedom_[index(v)] == kOnSurface && far > most_)
                place = moved(start, 0.999 * most_ / far, minus(place, start));
            at = place;
            const double own = least_around(v);
            if (own <= largest) return;
            largest = own;
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
    std::vector<Freedom> freedom_;
};

}  // namespace

double roundness(const FilledMesh& mesh, const std::array<std::int32_t, 4>& corners) {
    std::array<Vec3, 4> area{};
    double mean = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec3& a = mesh.points[index(corners[(i + 1) % 4])];
        area[i] = triangle_normal(a, mesh.points[index(corners[(i + 2) % 4])],
                                  mesh.points[index(corners[(i + 3) % 4])]);
        mean += length(area[i]) / 4;
    }
    if (!(mean > 0)) return 0;
    std::array<Vec3, 3> sum{};
    for (const Vec3& n : area) {
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j)
                sum[i][j] += n[i] * n[j] / (mean * mean);
        }
    }
    return dot(sum[0], cross(sum[1], sum[2])) / 8;
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
