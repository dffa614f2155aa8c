// SPDX-License-Identifier: GPL-3.0-or-later
#include "plans.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "exact/orientation.hpp"

namespace realmodel::fuzz {

namespace {

using exact::orient2d;

std::int32_t add(PlanMesh& mesh, double x, double y) {
    mesh.vertices.push_back({x, y});
    return static_cast<std::int32_t>(mesh.vertices.size()) - 1;
}

PlanMesh lattice(RandomSource& random, int n) {
    enum { kRising, kFalling, kRandom, kCrossed, kZigzag };
    const int diagonals = random.between(kRising, kZigzag);
    PlanMesh mesh;
    for (int j = 0; j <= n; ++j) {
        for (int i = 0; i <= n; ++i)
            add(mesh, i, j);
    }
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            const std::int32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 2, d = a + n + 1;
            int kind = diagonals;
            if (kind == kRandom) kind = random.with(0.5) ? kRising : kFalling;
            if (kind == kZigzag) kind = (i + j) % 2 == 1 ? kRising : kFalling;
            if (kind == kRising) {
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
            } else if (kind == kFalling) {
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
            } else {
                const std::int32_t m = add(mesh, i + 0.5, j + 0.5);
                mesh.triangles.insert(mesh.triangles.end(),
                                      {{a, b, m}, {b, c, m}, {c, d, m}, {d, a, m}});
            }
        }
    }
    return mesh;
}

PlanMesh lattice_of_size(RandomSource& random, int n, double size) {
    PlanMesh mesh = lattice(random, n);
    for (PlanPoint& p : mesh.vertices)
        p = {p[0] * size / n, p[1] * size / n};
    return mesh;
}

PlanMesh giant(RandomSource& random, int n) {
    if (!random.with(0.3)) return lattice_of_size(random, 1, n);
    const double size = n;
    return {{{-size, -size}, {3 * size, -size}, {-size, 3 * size}}, {{0, 1, 2}}};
}

PlanMesh scattered(RandomSource& random, int n) {
    const int fineness = random.one_of({1, 1, 2, 4});
    const double step = 1.0 / fineness;
    std::vector<PlanPoint> points{{0, 0},
                                  {static_cast<double>(n), 0},
                                  {static_cast<double>(n), static_cast<double>(n)},
                                  {0, static_cast<double>(n)}};
    int count = random.between(0, 8);
    if (random.with(0.2)) {
        points.resize(random.below(4));
        count = std::max(count, 4);
    }
    std::set<PlanPoint> known(points.begin(), points.end());
    for (int i = 0; i < count; ++i) {
        const PlanPoint p{random.between(0, n * fineness) * step,
                          random.between(0, n * fineness) * step};
        if (known.insert(p).second) points.push_back(p);
    }
    PlanMesh mesh{points, triangulated(points)};
    if (mesh.triangles.empty()) return lattice(random, n);
    flip_edges(random, mesh, random.one_of({0, 3, 12, 30}));
    return mesh;
}

PlanMesh fan(RandomSource& random, int n) {
    std::vector<double> side;
    for (int i = 0; i < n; ++i) {
        if (i == 0 || random.with(0.6)) side.push_back(i);
    }
    PlanMesh mesh;
    const double size = n;
    for (const double i : side)
        add(mesh, i, 0);
    for (const double i : side)
        add(mesh, size, i);
    for (const double i : side)
        add(mesh, size - i, size);
    for (const double i : side)
        add(mesh, 0, size - i);
    const auto border = static_cast<std::int32_t>(mesh.vertices.size());
    PlanPoint tip{size / 2, size / 2};
    if (random.with(0.5)) tip = {random.between(0, 4 * n) / 4.0, random.between(0, 4 * n) / 4.0};
    if (random.with(0.2)) tip = mesh.vertices[0];
    const std::int32_t last = add(mesh, tip[0], tip[1]);
    for (std::int32_t i = 0; i < border; ++i) {
        const Triangle t{i, (i + 1) % border, last};
        if (!is_flat(plan_corners(mesh, t))) mesh.triangles.push_back(t);
    }
    return mesh;
}

std::vector<int> some_of(RandomSource& random, int last, int least, int most) {
    std::set<int> places{0, last};
    for (int i = random.between(least, most); i > 0 && last > 1; --i)
        places.insert(random.between(1, last - 1));
    return {places.begin(), places.end()};
}

PlanMesh bricks(RandomSource& random, int n) {
    PlanMesh mesh;
    const std::vector<int> rows = some_of(random, n, 1, 3);
    for (std::size_t r = 0; r + 1 < rows.size(); ++r) {
        const std::vector<int> joints = some_of(random, 2 * n, 0, 3);
        for (std::size_t j = 0; j + 1 < joints.size(); ++j) {
            const double left = joints[j] / 2.0, right = joints[j + 1] / 2.0;
            const std::int32_t a = add(mesh, left, rows[r]), b = add(mesh, right, rows[r]),
                               c = add(mesh, right, rows[r + 1]), d = add(mesh, left, rows[r + 1]);
            if (random.with(0.5)) {
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
            } else {
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
            }
        }
    }
    return mesh;
}

PlanMesh needles(RandomSource& random, int n) {
    const double thin = random.one_of({1e-6, 1e-7, 1e-8, 1e-9, 0x1p-30}), size = n;
    std::set<PlanPoint> points{{0, 0}, {size, 0}, {size, size}, {0, size}};
    const auto beside = [&](double v) { return v < size ? v + thin : v - thin; };
    for (int i = random.between(1, 5); i > 0; --i) {
        const double x = random.between(0, 2 * n) / 2.0, y = random.between(0, 2 * n) / 2.0;
        const double kind = random.uniform();
        if (kind < 0.4) {
            points.insert({{x, y}, {x, beside(y)}});
        } else if (kind < 0.7) {
            points.insert({{0, beside(y)}, {size, y}});
        } else {
            points.insert({{beside(x), 0}, {x, size}, {x, y}});
        }
    }
    PlanMesh mesh;
    mesh.vertices.assign(points.begin(), points.end());
    random.shuffle(mesh.vertices);
    mesh.triangles = triangulated(mesh.vertices);
    flip_edges(random, mesh, random.one_of({0, 5, 20}));
    return mesh;
}

}  // namespace

PlanMesh make_plan(RandomSource& random, Plan plan, int n) {
    switch (plan) {
        case Plan::kLattice:
            return lattice(random, n);
        case Plan::kGiant:
            return giant(random, n);
        case Plan::kScattered:
            return scattered(random, n);
        case Plan::kFan:
            return fan(random, n);
        case Plan::kBricks:
            return bricks(random, n);
        case Plan::kNeedles:
            return needles(random, n);
        case Plan::kTiny:
            return lattice_of_size(random, std::min(6, 2 * n), n);
    }
    return {};
}

std::vector<Triangle> triangulated(const std::vector<PlanPoint>& points) {
    std::vector<std::int32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    const auto at = [&](std::int32_t i) { return points[static_cast<std::size_t>(i)]; };
    std::sort(order.begin(), order.end(),
              [&](std::int32_t a, std::int32_t b) { return at(a) < at(b); });
    std::size_t start = 2;
    while (start < order.size() && orient2d(at(order[0]), at(order[1]), at(order[start])) == 0)
        ++start;
    if (start >= order.size()) return {};
    std::vector<std::int32_t> hull(order.begin(),
                                   order.begin() + static_cast<std::ptrdiff_t>(start));
    const std::int32_t tip = order[start];
    if (orient2d(at(hull[0]), at(hull[1]), at(tip)) < 0) std::reverse(hull.begin(), hull.end());
    std::vector<Triangle> triangles;
    for (std::size_t i = 0; i + 1 < hull.size(); ++i)
        triangles.push_back({hull[i], hull[i + 1], tip});
    hull.push_back(tip);
    for (std::size_t o = start + 1; o < order.size(); ++o) {
        const std::int32_t p = order[o];
        const std::size_t size = hull.size();
        const auto seen = [&](std::size_t i) {
            return orient2d(at(hull[i % size]), at(hull[(i + 1) % size]), at(p)) < 0;
        };
        std::size_t first = 0;
        while (!seen(first) || seen(first + size - 1))
            ++first;
        std::size_t end = first;
        for (; seen(end); ++end)
            triangles.push_back({hull[(end + 1) % size], hull[end % size], p});
        std::vector<std::int32_t> next{hull[first % size], p};
        for (std::size_t i = end; i % size != first % size; ++i)
            next.push_back(hull[i % size]);
        hull = std::move(next);
    }
    return triangles;
}

void flip_edges(RandomSource& random, PlanMesh& mesh, int count) {
    const auto at = [&](std::int32_t i) { return mesh.vertices[static_cast<std::size_t>(i)]; };
    for (int flip = 0; flip < count; ++flip) {
        std::map<std::array<std::int32_t, 2>, std::pair<std::size_t, std::int32_t>> owner;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Triangle& v = mesh.triangles[t];
                owner[{v[k], v[(k + 1) % 3]}] = {t, v[(k + 2) % 3]};
            }
        }
        std::vector<std::array<std::int32_t, 2>> inner;
        for (const auto& [edge, side] : owner) {
            if (edge[0] < edge[1] && owner.count({edge[1], edge[0]}) > 0) inner.push_back(edge);
        }
        if (inner.empty()) return;
        const auto [a, b] = random.one_of(inner);
        const auto [i, c] = owner[{a, b}];
        const auto [j, d] = owner[{b, a}];
        if (orient2d(at(c), at(a), at(d)) > 0 && orient2d(at(d), at(b), at(c)) > 0) {
            mesh.triangles[i] = {c, a, d};
            mesh.triangles[j] = {d, b, c};
        }
    }
}

std::vector<Triangle> some_triangles(RandomSource& random, const PlanMesh& mesh) {
    enum { kRandom, kSparse, kIsland, kHalf, kHole, kAllButOne, kOne };
    const int kind = random.between(kRandom, kOne);
    std::vector<PlanPoint> middle;
    for (const Triangle& t : mesh.triangles) {
        PlanPoint m{0, 0};
        for (const std::int32_t v : t) {
            for (std::size_t axis = 0; axis < 2; ++axis)
                m[axis] += mesh.vertices[static_cast<std::size_t>(v)][axis] / 3;
        }
        middle.push_back(m);
    }
    const std::size_t one = random.below(middle.size());
    const PlanPoint at = middle[one];
    const double reach = random.one_of({0.5, 1.0, 1.5});
    constexpr PlanPoint kDirections[] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}, {-1, 0}};
    const PlanPoint way = random.one_of(kDirections);
    std::vector<Triangle> part;
    for (std::size_t t = 0; t < middle.size(); ++t) {
        const double dx = middle[t][0] - at[0], dy = middle[t][1] - at[1];
        const bool near = std::max(std::abs(dx), std::abs(dy)) <= reach;
        bool kept = false;
        switch (kind) {
            case kRandom:
                kept = random.with(0.7);
                break;
            case kSparse:
                kept = random.with(0.3);
                break;
            case kIsland:
                kept = near;
                break;
            case kHole:
                kept = !near;
                break;
            case kHalf:
                kept = way[0] * dx + way[1] * dy <= 0;
                break;
            case kAllButOne:
                kept = t != one;
                break;
            default:
                kept = t == one;
                break;
        }
        if (kept) part.push_back(mesh.triangles[t]);
    }
    if (part.empty()) part.push_back(mesh.triangles[one]);
    return part;
}

}  // namespace realmodel::fuzz
