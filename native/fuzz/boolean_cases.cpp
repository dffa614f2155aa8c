// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean_cases.hpp"

#include <cmath>
#include <numbers>

namespace realmodel::fuzz {

namespace {

void append(Mesh& mesh, const Mesh& other) {
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const Triangle& t : other.triangles)
        mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

Mesh box(const Point& low, const Point& size) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back({low[0] + size[0] * (i & 1), low[1] + size[1] * (i >> 1 & 1),
                                 low[2] + size[2] * (i >> 2)});
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

Mesh tetrahedron(const std::array<Point, 4>& corners) {
    return {{corners.begin(), corners.end()}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

Point lattice_point(RandomSource& random, int size) {
    return {1.0 * random.between(0, size), 1.0 * random.between(0, size),
            1.0 * random.between(0, size)};
}

Point any_point(RandomSource& random) {
    return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}

Mesh ball(int rings, int around, const Point& middle, double radius) {
    Mesh mesh;
    mesh.vertices.push_back({middle[0], middle[1], middle[2] - radius});
    for (int i = 1; i < rings; ++i) {
        for (int j = 0; j < around; ++j) {
            const double latitude = std::numbers::pi * (static_cast<double>(i) / rings - 0.5),
                         longitude = 2 * std::numbers::pi * j / around;
            mesh.vertices.push_back({middle[0] + radius * std::cos(latitude) * std::cos(longitude),
                                     middle[1] + radius * std::cos(latitude) * std::sin(longitude),
                                     middle[2] + radius * std::sin(latitude)});
        }
    }
    mesh.vertices.push_back({middle[0], middle[1], middle[2] + radius});
    const int last = static_cast<int>(mesh.vertices.size()) - 1;
    const auto at = [&](int i, int j) {
        if (i == 0) return 0;
        return i == rings ? last : 1 + (i - 1) * around + j % around;
    };
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < around; ++j) {
            if (i > 0) mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
            if (i + 1 < rings)
                mesh.triangles.push_back({at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
        }
    }
    return mesh;
}

/// A ball with few corners, which lies anyhow.
Mesh ball(RandomSource& random, const Point& middle, double radius) {
    const int rings = random.between(2, 6), around = random.between(3, 9);
    return ball(rings, around, middle, radius);
}

/// A bumpy ball: triangles of all directions, no two in one plane.
Mesh scan(RandomSource& random) {
    const int rings = random.between(4, 8), around = random.between(6, 14);
    Mesh mesh = ball(rings, around, {0, 0, 0}, 1);
    const double height = random.uniform(0.01, 0.2), phase = random.uniform(0, 6);
    for (Point& p : mesh.vertices) {
        const double by = 1 + height * std::sin(5 * p[0] + phase) * std::cos(4 * p[1] + 3 * p[2]);
        for (double& x : p)
            x *= by;
    }
    return mesh;
}

/// A sheet over a square, level, inclined or wavy.
Mesh sheet(RandomSource& random, const Point& low, double size) {
    const int quads = random.between(1, 5);
    const double dip = random.with(0.5) ? 0 : random.uniform(-1, 1),
                 wave = random.with(0.5) ? 0 : random.uniform(0, 0.5);
    Mesh mesh;
    for (int i = 0; i <= quads; ++i) {
        for (int j = 0; j <= quads; ++j) {
            const double u = size * i / quads, v = size * j / quads;
            mesh.vertices.push_back(
                {low[0] + u, low[1] + v, low[2] + dip * u + wave * std::sin(3 * u + 2 * v)});
        }
    }
    for (int i = 0; i < quads; ++i) {
        for (int j = 0; j < quads; ++j) {
            const int a = i * (quads + 1) + j, b = a + quads + 1, c = b + 1, d = a + 1;
            mesh.triangles.push_back({a, b, c});
            if (!random.with(0.05)) mesh.triangles.push_back({a, c, d});
        }
    }
    return mesh;
}

Mesh soup(RandomSource& random, int count, int size) {
    Mesh mesh;
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k)
            mesh.vertices.push_back(lattice_point(random, size));
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return mesh;
}

template <class Change>
void change_all(Mesh& mesh, const Change& change) {
    for (Point& p : mesh.vertices) {
        for (double& x : p)
            x = change(x);
    }
}

double moved_by_one(RandomSource& random, double x) {
    const std::size_t way = random.below(3);
    return way == 0 ? x : std::nextafter(x, way == 1 ? HUGE_VAL : -HUGE_VAL);
}

void rotate(RandomSource& random, Mesh& mesh) {
    const double angle = random.one_of({0.1, 0.5, 1.0, 2.0}) * random.uniform();
    const std::size_t u = random.below(3), v = (u + 1) % 3;
    const double c = std::cos(angle), s = std::sin(angle);
    for (Point& p : mesh.vertices) {
        const double x = p[u], y = p[v];
        p[u] = c * x - s * y;
        p[v] = s * x + c * y;
    }
}

/// Moves a surface, or each of its vertices, by less than its edges are long.
void move_less_than_edges(RandomSource& random, Mesh& mesh) {
    const Triangle& t = mesh.triangles[random.below(mesh.triangles.size())];
    const Point &a = mesh.vertices[static_cast<std::size_t>(t[0])],
                &b = mesh.vertices[static_cast<std::size_t>(t[1])];
    const double edge = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]),
                 by = edge * random.one_of({1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2, 0.1, 0.5});
    switch (random.below(4)) {
        case 0: {
            const Point shift{random.uniform(-by, by), random.uniform(-by, by),
                              random.uniform(-by, by)};
            for (Point& p : mesh.vertices)
                p = {p[0] + shift[0], p[1] + shift[1], p[2] + shift[2]};
            return;
        }
        case 1:
            change_all(mesh, [&](double x) { return x + random.uniform(-by, by); });
            return;
        case 2:
            change_all(mesh, [&](double x) { return x * (1 + by); });
            return;
        default:
            for (Point& p : mesh.vertices)
                p = {p[0] - by * p[1], p[1] + by * p[0], p[2]};
    }
}

void turn_over(Mesh& mesh) {
    for (Triangle& t : mesh.triangles)
        std::swap(t[1], t[2]);
}

/// A surface of one of the families.
Mesh any_surface(RandomSource& random, std::string& label) {
    switch (random.below(9)) {
        case 0: {
            label += "boxes ";
            Mesh mesh;
            for (int i = random.between(1, 3); i > 0; --i)
                append(mesh, box(lattice_point(random, 3),
                                 {1.0 * random.between(1, 3), 1.0 * random.between(1, 3),
                                  1.0 * random.between(1, 3)}));
            return mesh;
        }
        case 1: {
            label += "lattice ";
            Mesh mesh;
            for (int i = 0; i < 8; ++i) {
                if (random.with(0.6))
                    append(mesh,
                           box({1.0 * (i & 1), 1.0 * (i >> 1 & 1), 1.0 * (i >> 2)}, {1, 1, 1}));
            }
            if (mesh.triangles.empty()) return box({0, 0, 0}, {1, 1, 1});
            return mesh;
        }
        case 2: {
            label += "tetrahedra ";
            Mesh mesh;
            for (int i = random.between(1, 3); i > 0; --i)
                append(mesh, tetrahedron({lattice_point(random, 4), lattice_point(random, 4),
                                          lattice_point(random, 4), lattice_point(random, 4)}));
            return mesh;
        }
        case 3:
            label += "ball ";
            return ball(random, any_point(random), random.uniform(0.3, 1.5));
        case 8:
            label += "scan ";
            return scan(random);
        case 4:
            label += "lattice ball ";
            return ball(random, lattice_point(random, 2), 1.0 * random.between(1, 2));
        case 5:
            label += "sheet ";
            return sheet(random, any_point(random), random.uniform(0.5, 3));
        case 6:
            label += "level sheet ";
            return sheet(random, lattice_point(random, 2), 1.0 * random.between(1, 4));
        default:
            label += "soup ";
            return soup(random, random.between(1, 6), random.between(1, 3));
    }
}

/// A surface that has to do with the first one.
Mesh second_surface(RandomSource& random, const Mesh& first, std::string& label) {
    Mesh mesh = first;
    switch (random.below(10)) {
        case 8:
        case 9:
            label += "moved less than edges ";
            move_less_than_edges(random, mesh);
            return mesh;
        case 0:
            label += "copied ";
            return mesh;
        case 1:
            label += "shifted ";
            change_all(mesh, [&](double x) { return std::nextafter(x, HUGE_VAL); });
            return mesh;
        case 2:
            label += "trembling ";
            change_all(mesh, [&](double x) { return moved_by_one(random, x); });
            return mesh;
        case 3: {
            label += "turned ";
            rotate(random, mesh);
            return mesh;
        }
        case 4: {
            label += "moved little ";
            const double by = random.one_of({1e-15, 1e-14, 1e-12, 1e-9});
            change_all(mesh, [&](double x) { return x + by * random.between(-2, 2); });
            return mesh;
        }
        default:
            return any_surface(random, label);
    }
}

void mutate_pair(RandomSource& random, StackCase& pair) {
    auto& surfaces = pair.rocks[0].surfaces;
    Mesh &mesh = surfaces[random.below(2)], &other = surfaces[random.below(2)];
    Point& p = mesh.vertices[random.below(mesh.vertices.size())];
    const Triangle& t = other.triangles[random.below(other.triangles.size())];
    const auto corner = [&](std::size_t k) {
        return other.vertices[static_cast<std::size_t>(t[k])];
    };
    switch (random.below(6)) {
        case 0:  // onto a vertex
            p = corner(0);
            break;
        case 1:  // onto an edge, up to rounding
            for (std::size_t k = 0; k < 3; ++k)
                p[k] = corner(0)[k] + 0.25 * random.between(1, 3) * (corner(1)[k] - corner(0)[k]);
            break;
        case 2: {  // into a triangle, up to rounding
            const double u = random.uniform(0, 0.5), v = random.uniform(0, 0.5);
            const Point a = corner(0), b = corner(1), c = corner(2);
            for (std::size_t k = 0; k < 3; ++k)
                p[k] = a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]);
            break;
        }
        case 3:
            for (double& x : p)
                x = moved_by_one(random, x);
            break;
        case 4:
            mesh.triangles.push_back({t});
            if (&mesh != &other) mesh.triangles.pop_back();
            break;
        default:
            p = {p[0] + random.uniform(-1, 1), p[1], p[2]};
    }
}

}  // namespace

StackCase boolean_case(std::uint64_t seed, std::uint64_t number,
                       const std::vector<StackCase>& corpus) {
    RandomSource random(seed * 0x9e3779b97f4a7c15ULL + number);
    StackCase pair;
    if (!corpus.empty() && random.with(0.25)) {
        pair = random.one_of(corpus);
        pair.label = "corpus";
    } else {
        pair.rocks.emplace_back();
        Mesh first = any_surface(random, pair.label);
        if (random.with(0.3)) rotate(random, first);
        Mesh second = second_surface(random, first, pair.label);
        if (random.with(0.2)) rotate(random, second);
        if (random.with(0.1)) turn_over(second);
        if (random.with(0.15)) append(first, second);
        pair.rocks[0].surfaces = {first, second};
    }
    for (int i = random.with(0.4) ? random.between(1, 4) : 0; i > 0; --i)
        mutate_pair(random, pair);
    if (random.with(0.2)) {  // elsewhere in the world
        const Point far{random.uniform(0, 1e6), random.uniform(0, 6e6), random.uniform(-1e3, 1e3)};
        const double scale = random.one_of({1.0, 0.1, 100.0});
        for (Mesh& mesh : pair.rocks[0].surfaces) {
            for (Point& p : mesh.vertices) {
                for (std::size_t k = 0; k < 3; ++k)
                    p[k] = far[k] + scale * p[k];
            }
        }
        pair.label += "far ";
    }
    return pair;
}

}  // namespace realmodel::fuzz
