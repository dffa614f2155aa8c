// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/tetrahedra_repair.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <optional>
#include <utility>
#include <vector>

#include "base/algorithms.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"

namespace realmodel::simulation {

namespace {

using Tetrahedron = std::array<std::int32_t, 4>;
using Triangle = std::array<std::int32_t, 3>;

constexpr int kMostRounds = 20;
constexpr std::int32_t kGone = INT32_MIN;  ///< the surface of a triangle that is no longer one
constexpr double kFlatCorner = 0.87;       ///< cosine between normals: 30 degrees

Triangle opposite(const Tetrahedron& corners, std::size_t corner) {
    Triangle face{};
    for (std::size_t i = 0, at = 0; i < 4; ++i)
        if (i != corner) face[at++] = corners[i];
    std::sort(face.begin(), face.end());
    return face;
}

/// Keeps the rows, and their labels, of which is_kept holds.
template <class Rows, class IsKept>
void keep(Rows& rows, std::vector<std::int32_t>& labels, const IsKept& is_kept) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!is_kept(i)) continue;
        rows[kept] = rows[i];
        labels[kept++] = labels[i];
    }
    rows.resize(kept);
    labels.resize(kept);
}

/// The unit normal, outward, of the face across from a corner.
Vec3 normal(const FilledMesh& mesh, const Tetrahedron& corners, std::size_t corner) {
    std::array<Vec3, 3> at{};
    for (std::size_t i = 0, k = 0; i < 4; ++i)
        if (i != corner) at[k++] = mesh.points[index(corners[i])];
    Vec3 n = triangle_normal(at[0], at[1], at[2]);
    const double size = length(n);
    const bool is_inward = dot(n, minus(mesh.points[index(corners[corner])], at[0])) > 0;
    for (double& x : n)
        x /= is_inward ? -size : size;
    return n;
}

/// One round: what is divided does not touch what else is divided.
class Round {
public:
    explicit Round(FilledMesh& mesh)
        : mesh_(mesh),
          tetrahedra_at_(rows_at(mesh, mesh.tetrahedra)),
          triangles_at_(rows_at(mesh, mesh.triangles)),
          tetrahedra_(mesh.tetrahedra),
          triangles_(mesh.triangles),
          is_taken_(mesh.tetrahedra.size(), 0),
          is_gone_(mesh.tetrahedra.size(), 0) {}

    /// Whether anything was divided.
    bool run(Progress* progress) {
        bool any = false;
        const std::size_t count = mesh_.tetrahedra.size();
        for (std::size_t t = 0; t < count; ++t) {
            poll(progress, t);
            if (is_taken_[t] != 0) continue;
            const Tetrahedron corners = mesh_.tetrahedra[t];
            // corners across from faces of the outside, then the others
            std::array<std::int32_t, 4> order{};
            std::size_t outer = 0, inner = 4;
            for (std::size_t i = 0; i < 4; ++i) {
                if (is_outside(corners, i, t))
                    order[outer++] = corners[i];
                else
                    order[--inner] = corners[i];
            }
            // Two outer faces share the edge of the two last corners, and the edge of the first two
            // is inside; three share the last corner, and the face of the others is inside.
            if (outer < 2 || outer > 3) continue;
            std::vector<std::int32_t> inside(order.begin(), order.begin() + 2);
            if (outer == 3) inside.push_back(order[2]);
            any |= give_up(t, inside) || divide(inside);
        }
        drop_gone();
        return any;
    }

private:
    /// Whether no other tetrahedron has the face.
    bool is_outside(const Tetrahedron& corners, std::size_t corner, std::size_t own) const {
        const Triangle face = opposite(corners, corner);
        return std::ranges::all_of(
            elements_beside(tetrahedra_, tetrahedra_at_[index(face[0])], face),
            [&](std::int32_t t) { return t < 0 || index(t) == own || is_gone_[index(t)] != 0; });
    }

    /// Leaves out a tetrahedron whose faces outside are nearly one plane: they are on one surface,
    /// and the others, inside until now, take their place.
    bool give_up(std::size_t t, const std::vector<std::int32_t>& inside) {
        const Tetrahedron corners = mesh_.tetrahedra[t];
        std::vector<Vec3> normals;
        std::vector<Triangle> old_faces, new_faces;
        for (std::size_t i = 0; i < 4; ++i) {
            const bool is_outer =
                std::find(inside.begin(), inside.end(), corners[i]) != inside.end();
            (is_outer ? old_faces : new_faces).push_back(opposite(corners, i));
            if (is_outer) normals.push_back(normal(mesh_, corners, i));
        }
        for (std::size_t i = 0; i < normals.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                if (!(dot(normals[i], normals[j]) > kFlatCorner)) return false;
        std::vector<std::size_t> rows;
        for (const std::int32_t f : triangles_at_[index(inside[0])]) {
            const Triangle& face = triangles_[index(f)];
            // what is inside must not be on the outside, or a boundary, elsewhere
            const bool is_own =
                has(corners, face[0]) && has(corners, face[1]) && has(corners, face[2]);
            if (!is_own && has(face, inside[1])) return false;
        }
        for (const Triangle& face : new_faces)
            if (row_of(face)) return false;
        for (const Triangle& face : old_faces) {
            const auto row = row_of(face);
            if (!row || mesh_.surface[*row] != mesh_.surface[*row_of(old_faces[0])]) return false;
            rows.push_back(*row);
        }
        for (const std::int32_t v : corners)
            for (const std::int32_t other : tetrahedra_at_[index(v)])
                is_taken_[index(other)] = 1;
        is_gone_[t] = 1;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (i >= new_faces.size()) {
                mesh_.surface[rows[i]] = kGone;
                continue;
            }
            // seen from outside: the other way round than from the tetrahedron that is left out
            Triangle face = new_faces[i];
            std::int32_t fourth = corners[0];
            for (const std::int32_t v : corners)
                if (!has(face, v)) fourth = v;
            if (six_volumes(mesh_, {face[0], face[1], face[2], fourth}) < 0)
                std::swap(face[0], face[1]);
            mesh_.triangles[rows[i]] = face;
        }
        return true;
    }

    /// The row of a face with sorted corners among the triangles.
    std::optional<std::size_t> row_of(const Triangle& sorted) const {
        for (const std::int32_t f : triangles_at_[index(sorted[0])]) {
            const Triangle& face = mesh_.triangles[index(f)];
            if (mesh_.surface[index(f)] != kGone && has(face, sorted[0]) && has(face, sorted[1]) &&
                has(face, sorted[2]))
                return index(f);
        }
        return std::nullopt;
    }

    void drop_gone() {
        is_gone_.resize(mesh_.tetrahedra.size(), 0);
        keep(mesh_.tetrahedra, mesh_.region, [&](std::size_t t) { return is_gone_[t] == 0; });
        keep(mesh_.triangles, mesh_.surface,
             [&](std::size_t f) { return mesh_.surface[f] != kGone; });
    }

    /// A new point in the middle of an edge or a face; everything that has it is divided.
    bool divide(const std::vector<std::int32_t>& middle_of) {
        const auto has_all = [&](const auto& corners) {
            return std::all_of(middle_of.begin(), middle_of.end(),
                               [&](std::int32_t v) { return has(corners, v); });
        };
        std::vector<std::int32_t> around;
        for (const std::int32_t t : tetrahedra_at_[index(middle_of[0])]) {
            if (!has_all(tetrahedra_[index(t)])) continue;
            if (is_taken_[index(t)] != 0) return false;
            around.push_back(t);
        }
        Vec3 middle{};
        for (const std::int32_t v : middle_of)
            for (std::size_t axis = 0; axis < 3; ++axis)
                middle[axis] +=
                    mesh_.points[index(v)][axis] / static_cast<double>(middle_of.size());
        const std::int32_t added = checked_number(mesh_.points.size(), "points");
        mesh_.points.push_back(middle);
        for (const std::int32_t t : around) {
            for (const std::int32_t v : middle_of) {
                if (!(six_volumes(mesh_, with(mesh_.tetrahedra[index(t)], v, added)) > 0)) {
                    mesh_.points.pop_back();
                    return false;
                }
            }
        }
        for (const std::int32_t t : around) {
            is_taken_[index(t)] = 1;
            split(mesh_.tetrahedra, mesh_.region, index(t), middle_of, added);
        }
        for (const std::int32_t f : triangles_at_[index(middle_of[0])])
            if (has_all(mesh_.triangles[index(f)]))
                split(mesh_.triangles, mesh_.surface, index(f), middle_of, added);
        return true;
    }

    template <class Rows>
    static void split(Rows& rows, std::vector<std::int32_t>& labels, std::size_t row,
                      const std::vector<std::int32_t>& middle_of, std::int32_t added) {
        const auto corners = rows[row];
        rows[row] = with(corners, middle_of[0], added);
        for (std::size_t i = 1; i < middle_of.size(); ++i) {
            rows.push_back(with(corners, middle_of[i], added));
            labels.push_back(labels[row]);
        }
    }

    FilledMesh& mesh_;
    // as they were before the round
    const Buckets<std::int32_t> tetrahedra_at_, triangles_at_;
    const std::vector<Tetrahedron> tetrahedra_;
    const std::vector<Triangle> triangles_;
    std::vector<std::uint8_t> is_taken_, is_gone_;
};

/// Leaves out tetrahedra that share no face with another.
void drop_single(FilledMesh& mesh) {
    using Side = std::pair<Triangle, std::int32_t>;
    std::vector<Side> faces;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (std::size_t i = 0; i < 4; ++i)
            faces.emplace_back(opposite(mesh.tetrahedra[t], i), static_cast<std::int32_t>(t));
    std::sort(faces.begin(), faces.end());
    std::vector<std::uint8_t> has_neighbor(mesh.tetrahedra.size(), 0);
    for (const auto equal : groups_of(faces, &Side::first)) {
        if (equal.size() == 1) continue;
        for (const auto& [face, t] : equal)
            has_neighbor[index(t)] = 1;
    }
    if (std::find(has_neighbor.begin(), has_neighbor.end(), 0) == has_neighbor.end()) return;
    std::vector<Triangle> lost;
    for (const auto& [face, t] : faces)
        if (has_neighbor[index(t)] == 0) lost.push_back(face);
    keep(mesh.triangles, mesh.surface, [&](std::size_t f) {
        Triangle face = mesh.triangles[f];
        std::sort(face.begin(), face.end());
        return !std::binary_search(lost.begin(), lost.end(), face);
    });
    keep(mesh.tetrahedra, mesh.region, [&](std::size_t t) { return has_neighbor[t] != 0; });
}

void drop_unused_points(FilledMesh& mesh) {
    std::vector<std::int32_t> number(mesh.points.size(), -1);
    for (const Tetrahedron& corners : mesh.tetrahedra)
        for (const std::int32_t v : corners)
            number[index(v)] = 0;
    std::size_t used = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] < 0) continue;
        number[v] = static_cast<std::int32_t>(used);
        mesh.points[used++] = mesh.points[v];
    }
    mesh.points.resize(used);
    for (Tetrahedron& corners : mesh.tetrahedra)
        for (std::int32_t& v : corners)
            v = number[index(v)];
    for (Triangle& corners : mesh.triangles)
        for (std::int32_t& v : corners)
            v = number[index(v)];
}

}  // namespace

double six_volumes(const FilledMesh& mesh, const std::array<std::int32_t, 4>& corners) {
    const auto at = [&](std::size_t i) { return mesh.points[index(corners[i])]; };
    return sixfold_volume(at(0), at(1), at(2), at(3));
}

std::array<std::int32_t, 2> elements_beside(std::span<const Tetrahedron> elements,
                                            std::span<const std::int32_t> at_corner,
                                            const Triangle& face) {
    std::array<std::int32_t, 2> beside{-1, -1};
    std::size_t count = 0;
    for (const std::int32_t t : at_corner) {
        const auto has_corner = [&](std::int32_t v) { return has(elements[index(t)], v); };
        if (count < 2 && std::ranges::all_of(face, has_corner)) beside[count++] = t;
    }
    assert(count > 0);
    return beside;
}

void divide_corner_tetrahedra(FilledMesh& mesh, Progress* progress) {
    for (int round = 0; round < kMostRounds && Round(mesh).run(progress); ++round) {
    }
    drop_single(mesh);
    drop_unused_points(mesh);
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
            const double own = least_roundness(mesh_, around_[index(v)]);
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
    std::vector<VertexFreedom> freedom_;
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
