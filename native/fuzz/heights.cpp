// SPDX-License-Identifier: GPL-3.0-or-later
#include "heights.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace realmodel::fuzz {

namespace {

HeightFunction plane(RandomSource& random) {
    const double a = random.between(-1, 1), b = random.between(-1, 1), c = random.between(-2, 3);
    return [=](double x, double y) { return a * x + b * y + c; };
}

HeightFunction folded(RandomSource& random) {
    const HeightFunction one = plane(random), other = plane(random);
    const bool lower = random.with(0.5);
    return [=](double x, double y) {
        return lower ? std::min(one(x, y), other(x, y)) : std::max(one(x, y), other(x, y));
    };
}

HeightFunction waves(RandomSource& random) {
    std::array<std::array<double, 4>, 3> terms;
    for (auto& [a, b, phase, size] : terms) {
        a = random.uniform(0.3, 2);
        b = random.uniform(0.3, 2);
        phase = random.uniform(0, 6);
        size = random.uniform(0.2, 2);
    }
    const double lift = random.uniform(-1, 2);
    return [=](double x, double y) {
        double z = lift;
        for (const auto& [a, b, phase, size] : terms)
            z += size * std::sin(a * x + b * y + phase);
        return z;
    };
}

HeightFunction magnitudes(RandomSource& random) {
    const std::vector<std::vector<double>> possible{
        {1e-6, 1e6}, {1e-6, 1.0}, {1.0, 1e6}, {1e-12, 1e-6, 1.0, 1e6}};
    const std::vector<double> sizes = random.one_of(possible);
    return
        [&random, sizes](double, double) { return random.between(-3, 3) * random.one_of(sizes); };
}

/// Share of vertices that an operation takes.
double share_of(RandomSource& random) {
    return random.one_of({0.2, 0.5, 1.01});
}

}  // namespace

HeightFunction make_height(RandomSource& random, Height height) {
    switch (height) {
        case Height::kPlane:
            return plane(random);
        case Height::kFolded:
            return folded(random);
        case Height::kWaves:
            return waves(random);
        case Height::kMagnitudes:
            return magnitudes(random);
        case Height::kIntegers: {
            const int highest = random.one_of({1, 2, 3, 3, 6});
            return [&random, highest](double, double) { return random.between(0, highest); };
        }
        case Height::kLevel: {
            const double z = random.between(-1, 4);
            return [z](double, double) { return z; };
        }
        case Height::kDecimals: {
            const HeightFunction wave = waves(random);
            return [wave](double x, double y) { return std::round(wave(x, y) * 1000) / 1000; };
        }
        case Height::kRandom: {
            const double lift = random.between(0, 2);
            return [&random, lift](double, double) { return lift + random.uniform(); };
        }
    }
    return {};
}

double nudged(RandomSource& random, double value, int direction) {
    if (direction == 0) direction = random.with(0.5) ? 1 : -1;
    if (value == 0 && random.with(0.9)) return direction * 0x1p-53;
    return std::nextafter(value, direction * HUGE_VAL);
}

void nudge_heights(RandomSource& random, Mesh& mesh) {
    const int direction = random.between(-1, 1);
    const double share = share_of(random);
    for (Point& p : mesh.vertices) {
        if (random.with(share)) p[2] = nudged(random, p[2], direction);
    }
}

void nudge_plan(RandomSource& random, Mesh& mesh) {
    const double share = random.one_of({0.1, 0.4, 1.01});
    const bool decimals = random.with(0.25);
    for (Point& p : mesh.vertices) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            if (!random.with(share)) continue;
            p[axis] = decimals
                          ? std::round((p[axis] + (random.with(0.5) ? 0.001 : 0)) * 1000) / 1000
                          : nudged(random, p[axis]);
        }
    }
}

void unweld(Mesh& mesh) {
    Mesh result;
    for (const Triangle& t : mesh.triangles) {
        const auto first = static_cast<std::int32_t>(result.vertices.size());
        for (const std::int32_t v : t)
            result.vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
        result.triangles.push_back({first, first + 1, first + 2});
    }
    mesh = std::move(result);
}

void add_jumps(RandomSource& random, Mesh& mesh) {
    unweld(mesh);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const double lift = random.one_of({0, 0, 0, 1, 1, -1, 2});
        for (std::size_t i = 0; i < 3; ++i)
            mesh.vertices[3 * t + i][2] += lift;
    }
    if (!random.with(0.5)) return;
    std::map<Point, std::int32_t> number;
    for (Triangle& t : mesh.triangles) {
        for (std::int32_t& v : t)
            v = number.try_emplace(mesh.vertices[static_cast<std::size_t>(v)], v).first->second;
    }
    mesh = compacted(mesh);
}

void add_flat_triangles(RandomSource& random, Mesh& mesh) {
    for (int i = random.between(1, 3); i > 0 && !mesh.triangles.empty(); --i) {
        const Triangle t = random.one_of(mesh.triangles);
        const int kind = random.between(0, 2);
        Triangle flat{t[0], t[1], t[1]};
        if (kind > 0) {
            const Point a = mesh.vertices[static_cast<std::size_t>(t[0])],
                        b = mesh.vertices[static_cast<std::size_t>(t[1])];
            Point middle = a;
            for (std::size_t axis = 0; axis < 3 && kind == 1; ++axis)
                middle[axis] = a[axis] + (b[axis] - a[axis]) / 2;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                // off the line by rounding it would stand upright
                if (middle[axis] - a[axis] != b[axis] - middle[axis]) middle = a;
            }
            flat = {t[0], static_cast<std::int32_t>(mesh.vertices.size()), t[1]};
            mesh.vertices.push_back(middle);
        }
        mesh.triangles.insert(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(
                                                           random.below(mesh.triangles.size() + 1)),
                              flat);
    }
}

void disorder(RandomSource& random, Mesh& mesh) {
    if (random.with(0.4)) unweld(mesh);
    if (random.with(0.3) && !mesh.triangles.empty()) {
        for (int i = 0; i < 3; ++i) {
            Triangle& t = mesh.triangles[random.below(mesh.triangles.size())];
            std::int32_t& corner = t[random.below(3)];
            mesh.vertices.push_back(mesh.vertices[static_cast<std::size_t>(corner)]);
            corner = static_cast<std::int32_t>(mesh.vertices.size()) - 1;
        }
    }
    std::vector<std::int32_t> order(mesh.vertices.size());
    std::iota(order.begin(), order.end(), 0);
    random.shuffle(order);
    std::vector<Point> moved(mesh.vertices.size());
    for (std::size_t v = 0; v < moved.size(); ++v)
        moved[static_cast<std::size_t>(order[v])] = mesh.vertices[v];
    mesh.vertices = std::move(moved);
    random.shuffle(mesh.triangles);
    for (Triangle& t : mesh.triangles) {
        for (std::int32_t& v : t)
            v = order[static_cast<std::size_t>(v)];
        if (random.with(0.5)) std::swap(t[0], t[2]);
        std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(random.below(3)), t.end());
    }
}

}  // namespace realmodel::fuzz
