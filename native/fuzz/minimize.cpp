// SPDX-License-Identifier: GPL-3.0-or-later
#include "minimize.hpp"

#include <algorithm>
#include <cmath>

namespace realmodel::fuzz {

namespace {

class Minimizer {
public:
    Minimizer(StackCase stack, const std::function<bool(const StackCase&)>& fails,
              std::size_t steps)
        : best_(std::move(stack)), fails_(fails), steps_(steps) {}

    StackCase run() {
        while (steps_ > 0) {
            const std::size_t before = taken_;
            fewer_rocks_and_surfaces();
            plainer_rocks();
            fewer_triangles();
            rounder();
            if (taken_ == before) break;
        }
        return best_;
    }

private:
    /// Keeps a candidate that fails too.
    bool take(StackCase candidate) {
        for (RockCase& rock : candidate.rocks) {
            for (Mesh& surface : rock.surfaces)
                surface = compacted(surface);
            if (rock.region) *rock.region = compacted(*rock.region);
        }
        if (steps_ == 0 || candidate.rocks == best_.rocks) return false;
        --steps_;
        if (!fails_(candidate)) return false;
        best_ = std::move(candidate);
        ++taken_;
        return true;
    }

    template <class Change>
    bool try_change(const Change& change) {
        StackCase candidate = best_;
        change(candidate);
        return take(std::move(candidate));
    }

    void fewer_rocks_and_surfaces() {
        for (std::size_t r = best_.rocks.size(); r-- > 0 && best_.rocks.size() > 1;) {
            try_change([r](StackCase& s) {
                s.rocks.erase(s.rocks.begin() + static_cast<std::ptrdiff_t>(r));
            });
        }
        for (std::size_t r = 0; r < best_.rocks.size(); ++r) {
            for (std::size_t k = best_.rocks[r].surfaces.size();
                 k-- > 0 && best_.rocks[r].surfaces.size() > 1;) {
                try_change([r, k](StackCase& s) {
                    RockCase& rock = s.rocks[r];
                    const auto row = static_cast<std::ptrdiff_t>(k);
                    if (!rock.rules.empty()) rock.rules.erase(rock.rules.begin() + row);
                    rock.surfaces.erase(rock.surfaces.begin() + row);
                });
            }
        }
    }

    void plainer_rocks() {
        for (std::size_t r = 0; r < best_.rocks.size(); ++r) {
            try_change([r](StackCase& s) { s.rocks[r].region.reset(); });
            try_change([r](StackCase& s) { s.rocks[r].base_elevation.reset(); });
            try_change([r](StackCase& s) { s.rocks[r].rules.clear(); });
            for (std::size_t k = 0; k < best_.rocks[r].rules.size(); ++k)
                try_change(
                    [r, k](StackCase& s) { s.rocks[r].rules[k] = strata::Rule::kErosional; });
        }
    }

    /// Leaves out triangles of one mesh, halves first.
    template <class Find>
    void fewer_triangles_of(const Find& find) {
        for (std::size_t chunk = std::max<std::size_t>(find(best_).triangles.size() / 2, 1);
             chunk > 0; chunk /= 2) {
            for (std::size_t begin = 0; begin < find(best_).triangles.size();) {
                const std::size_t count = find(best_).triangles.size();
                const bool taken =
                    count > chunk && try_change([&](StackCase& s) {
                        auto& triangles = find(s).triangles;
                        const auto first = triangles.begin() + static_cast<std::ptrdiff_t>(begin);
                        triangles.erase(first, first + static_cast<std::ptrdiff_t>(
                                                           std::min(chunk, count - begin)));
                    });
                if (!taken) begin += chunk;
            }
        }
    }

    void fewer_triangles() {
        for (std::size_t r = 0; r < best_.rocks.size(); ++r) {
            for (std::size_t k = 0; k < best_.rocks[r].surfaces.size(); ++k)
                fewer_triangles_of(
                    [r, k](StackCase& s) -> Mesh& { return s.rocks[r].surfaces[k]; });
            if (best_.rocks[r].region)
                fewer_triangles_of([r](StackCase& s) -> PlanMesh& { return *s.rocks[r].region; });
        }
    }

    /// Changes every coordinate of all meshes.
    template <class Change>
    static void change_all(StackCase& stack, const Change& change) {
        for (RockCase& rock : stack.rocks) {
            for (Mesh& surface : rock.surfaces) {
                for (Point& p : surface.vertices) {
                    for (std::size_t axis = 0; axis < 3; ++axis)
                        p[axis] = change(p[axis], axis);
                }
            }
            if (rock.region) {
                for (PlanPoint& p : rock.region->vertices) {
                    for (std::size_t axis = 0; axis < 2; ++axis)
                        p[axis] = change(p[axis], axis);
                }
            }
            if (rock.base_elevation)
                rock.base_elevation = std::floor(change(*rock.base_elevation, 2));
        }
    }

    void rounder() {
        Point low{HUGE_VAL, HUGE_VAL, HUGE_VAL};
        for (const RockCase& rock : best_.rocks) {
            for (const Mesh& surface : rock.surfaces) {
                for (const Point& p : surface.vertices) {
                    for (std::size_t axis = 0; axis < 3; ++axis)
                        low[axis] = std::min(low[axis], std::floor(p[axis]));
                }
            }
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            try_change([&](StackCase& s) {
                change_all(s, [&](double v, std::size_t a) { return a == axis ? v - low[a] : v; });
            });
        }
        for (const double parts : {1.0, 2.0, 1e1, 1e3, 0x1p20, 1e6}) {
            try_change([&](StackCase& s) {
                change_all(s, [&](double v, std::size_t) { return std::round(v * parts) / parts; });
            });
        }
        for (std::size_t r = 0; r < best_.rocks.size(); ++r) {
            for (std::size_t k = 0; k < best_.rocks[r].surfaces.size(); ++k)
                rounder_vertices(
                    [ r, k ](StackCase & s) -> auto& { return s.rocks[r].surfaces[k].vertices; });
            if (best_.rocks[r].region)
                rounder_vertices([r](StackCase & s) -> auto& {
                    return s.rocks[r].region->vertices;
                });
        }
    }

    template <class Find>
    void rounder_vertices(const Find& find) {
        for (std::size_t v = 0; v < find(best_).size(); ++v) {
            for (std::size_t axis = 0; axis < find(best_)[v].size(); ++axis) {
                for (const double parts : {1.0, 2.0, 10.0, 1e3}) {
                    const double value = find(best_)[v][axis];
                    const double rounded = std::round(value * parts) / parts;
                    if (rounded == value) break;  // as round as can be
                    if (v >= find(best_).size() ||
                        try_change([&](StackCase& s) { find(s)[v][axis] = rounded; }))
                        break;
                }
            }
        }
    }

    StackCase best_;
    const std::function<bool(const StackCase&)>& fails_;
    std::size_t steps_;
    std::size_t taken_ = 0;
};

}  // namespace

StackCase minimized(StackCase stack, const std::function<bool(const StackCase&)>& fails,
                    std::size_t steps) {
    return Minimizer(std::move(stack), fails, steps).run();
}

}  // namespace realmodel::fuzz
