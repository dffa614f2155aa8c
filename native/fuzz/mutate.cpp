// SPDX-License-Identifier: GPL-3.0-or-later
#include "mutate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "generate.hpp"
#include "heights.hpp"
#include "placement.hpp"
#include "plans.hpp"

namespace realmodel::fuzz {

namespace {

using strata::Rule;

RockCase& some_rock(RandomSource& random, StackCase& stack) {
    return stack.rocks[random.below(stack.rocks.size())];
}

Mesh& some_surface(RandomSource& random, StackCase& stack) {
    RockCase& rock = some_rock(random, stack);
    return rock.surfaces[random.below(rock.surfaces.size())];
}

Point& some_vertex(RandomSource& random, Mesh& mesh) {
    return mesh.vertices[random.below(mesh.vertices.size())];
}

std::array<Point, 3> some_triangle(RandomSource& random, const Mesh& mesh) {
    const Triangle t = random.one_of(mesh.triangles);
    std::array<Point, 3> corners;
    for (std::size_t i = 0; i < 3; ++i)
        corners[i] = mesh.vertices[static_cast<std::size_t>(t[i])];
    return corners;
}

/// Moves all vertices of a mesh that stand at one plan position, so that triangles stay joined.
void move_together(Mesh& mesh, const Point& from, const PlanPoint& to) {
    for (Point& p : mesh.vertices) {
        if (p[0] == from[0] && p[1] == from[1]) p = {to[0], to[1], p[2]};
    }
}

Point between(const Point& a, const Point& b, double share) {
    return {a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share,
            a[2] + (b[2] - a[2]) * share};
}

// -- the ways to change a stack

void vertex_onto_another(RandomSource& random, StackCase& stack) {
    Mesh& mesh = some_surface(random, stack);
    const Point target = some_vertex(random, some_surface(random, stack));
    Point& p = some_vertex(random, mesh);
    move_together(mesh, Point(p), {target[0], target[1]});
    if (random.with(0.5)) p[2] = target[2];
}

void vertex_onto_an_edge(RandomSource& random, StackCase& stack) {
    Mesh& mesh = some_surface(random, stack);
    const auto corners = some_triangle(random, some_surface(random, stack));
    const std::size_t i = random.below(3);
    const double share = random.with(0.5) ? 0.5 : random.uniform();
    const Point target = between(corners[i], corners[(i + 1) % 3], share);
    Point& p = some_vertex(random, mesh);
    move_together(mesh, Point(p), {target[0], target[1]});
    if (random.with(0.5)) p[2] = target[2];
}

void vertex_aside_by_an_ulp(RandomSource& random, StackCase& stack) {
    Mesh& mesh = some_surface(random, stack);
    Point& p = some_vertex(random, mesh);
    const std::size_t axis = random.below(3);
    double moved = p[axis];
    for (int step = random.between(1, 3); step > 0; --step)
        moved = nudged(random, moved);
    if (axis == 2) {
        p[2] = moved;
    } else {
        PlanPoint to{p[0], p[1]};
        to[axis] = moved;
        move_together(mesh, Point(p), to);
    }
}

/// Height of the plane of three corners at a place; nothing where they have no area in plan.
std::optional<double> plane_height(const std::array<Point, 3>& corners, const Point& p) {
    const auto& [a, b, c] = corners;
    const double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (area == 0) return std::nullopt;
    const double u = ((p[0] - a[0]) * (c[1] - a[1]) - (p[1] - a[1]) * (c[0] - a[0])) / area;
    const double v = ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])) / area;
    return a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]);
}

/// Heights of some vertices become those of the plane of another surface's triangle.
void onto_a_plane(RandomSource& random, StackCase& stack) {
    const auto corners = some_triangle(random, some_surface(random, stack));
    Mesh& mesh = some_surface(random, stack);
    const double share = random.one_of({0.3, 1.01});
    const bool nudge = random.with(0.3);
    for (Point& p : mesh.vertices) {
        if (!random.with(share)) continue;
        p[2] = plane_height(corners, p).value_or(p[2]);
        if (nudge) p[2] = nudged(random, p[2]);
    }
}

/// A surface stays to one side of a plane of another and touches it along an edge or in a vertex.
void touch_a_plane(RandomSource& random, StackCase& stack) {
    const auto corners = some_triangle(random, some_surface(random, stack));
    Mesh& mesh = some_surface(random, stack);
    const auto edge = some_triangle(random, mesh);
    const auto is_at = [](const Point& p, const Point& q) { return p[0] == q[0] && p[1] == q[1]; };
    const bool along = random.with(0.7);
    const int side = random.with(0.7) ? -1 : 1;
    for (Point& p : mesh.vertices) {
        const bool touches = is_at(p, edge[0]) || (along && is_at(p, edge[1]));
        p[2] =
            plane_height(corners, p).value_or(p[2]) + (touches ? 0 : side * random.between(1, 2));
    }
}

/// A patch of one surface takes the place of what another has there.
void copy_a_patch(RandomSource& random, StackCase& stack) {
    const Mesh from = some_surface(random, stack);
    Mesh& into = some_surface(random, stack);
    PlanMesh plan{{}, from.triangles};
    for (const Point& p : from.vertices)
        plan.vertices.push_back({p[0], p[1]});
    const std::vector<Triangle> patch = some_triangles(random, plan);
    std::erase_if(into.triangles, [&](const Triangle& t) {
        return std::any_of(patch.begin(), patch.end(), [&](const Triangle& other) {
            return overlap(plan_corners(into, t), plan_corners(from, other));
        });
    });
    const auto first = static_cast<std::int32_t>(into.vertices.size());
    into.vertices.insert(into.vertices.end(), from.vertices.begin(), from.vertices.end());
    for (const Triangle& t : patch)
        into.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

void part_of_a_surface(RandomSource& random, StackCase& stack) {
    Mesh& mesh = some_surface(random, stack);
    PlanMesh plan{{}, mesh.triangles};
    for (const Point& p : mesh.vertices)
        plan.vertices.push_back({p[0], p[1]});
    mesh.triangles = some_triangles(random, plan);
}

/// A triangle becomes three round a point inside, or needles where the point is near an edge.
void divide_a_triangle(RandomSource& random, StackCase& stack) {
    Mesh& mesh = some_surface(random, stack);
    Triangle& t = mesh.triangles[random.below(mesh.triangles.size())];
    const auto corner = [&](std::size_t i) {
        return mesh.vertices[static_cast<std::size_t>(t[i])];
    };
    const double near = random.one_of({0.5, 0.25, 1e-3, 1e-9, 0x1p-40});
    Point p = between(between(corner(0), corner(1), random.uniform()), corner(2), near);
    if (random.with(0.5)) p[2] += random.one_of({1.0, -1.0, 0x1p-52});
    const auto m = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.push_back(p);
    const Triangle old = t;
    t = {old[0], old[1], m};
    mesh.triangles.push_back({old[1], old[2], m});
    mesh.triangles.push_back({old[2], old[0], m});
}

void lift(RandomSource& random, StackCase& stack) {
    const double by = random.one_of({1.0, -1.0, 0.5, 1e-6, 1e6, 0x1p-50});
    for (Point& p : some_surface(random, stack).vertices)
        p[2] += by;
}

void scale_heights(RandomSource& random, StackCase& stack) {
    const double by = random.one_of({1e-6, 1e6, -1.0, 1.0 / 3, 1e-3});
    RockCase& rock = some_rock(random, stack);
    const bool all = random.with(0.7);
    for (Mesh& surface : rock.surfaces) {
        if (!all && random.with(0.5)) continue;
        for (Point& p : surface.vertices)
            p[2] *= by;
    }
    if (rock.base_elevation) rock.base_elevation = -1e7;
}

void elsewhere(RandomSource& random, StackCase& stack) {
    Placement(random, random.one_of({Place::kDecimal, Place::kUtm, Place::kRotated})).apply(stack);
}

void slide_a_surface(RandomSource& random, StackCase& stack) {
    Mesh& mesh = some_surface(random, stack);
    const double dx = random.one_of({0.0, 0.5, 1.0, 0x1p-50, 1e-9, 1.0 / 3}),
                 dy = random.one_of({0.0, 0.5, -1.0, 0x1p-50, 1e-9, 0.1});
    for (Point& p : mesh.vertices)
        p = {p[0] + dx, p[1] + dy, p[2]};
}

void round_everything(RandomSource& random, StackCase& stack) {
    const double parts = random.one_of({1.0, 4.0, 10.0, 1e3});
    const auto rounded = [parts](double v) { return std::round(v * parts) / parts; };
    for (RockCase& rock : stack.rocks) {
        for (Mesh& surface : rock.surfaces) {
            for (Point& p : surface.vertices)
                p = {rounded(p[0]), rounded(p[1]), rounded(p[2])};
        }
        if (!rock.region) continue;
        for (PlanPoint& p : rock.region->vertices)
            p = {rounded(p[0]), rounded(p[1])};
    }
}

void order_of_surfaces(RandomSource& random, StackCase& stack) {
    RockCase& rock = some_rock(random, stack);
    const std::size_t k = random.below(rock.surfaces.size()),
                      i = random.below(rock.surfaces.size());
    if (random.with(0.5)) {
        std::swap(rock.surfaces[k], rock.surfaces[i]);
    } else if (rock.surfaces.size() < 8) {
        const Mesh again = rock.surfaces[k];
        rock.surfaces.insert(rock.surfaces.begin() + static_cast<std::ptrdiff_t>(i), again);
        if (!rock.rules.empty())
            rock.rules.insert(rock.rules.begin() + static_cast<std::ptrdiff_t>(i), rock.rules[k]);
    }
}

void change_a_rule(RandomSource& random, StackCase& stack) {
    RockCase& rock = some_rock(random, stack);
    rock.all_rules()[random.below(rock.surfaces.size())] =
        static_cast<Rule>(random.below(std::size(strata::kRules)));
}

/// A region over part of a surface, the border of a surface itself, or none any more.
void change_the_region(RandomSource& random, StackCase& stack) {
    RockCase& rock = some_rock(random, stack);
    if (stack.rocks.size() > 1) return;  // they must not overlap
    if (random.with(0.3)) {
        rock.region.reset();
        return;
    }
    const Mesh mesh = compacted(some_surface(random, stack));
    rock.region = PlanMesh{{}, mesh.triangles};
    for (const Point& p : mesh.vertices)
        rock.region->vertices.push_back({p[0], p[1]});
    if (random.with(0.5)) rock.region->triangles = some_triangles(random, *rock.region);
}

void change_the_base(RandomSource& random, StackCase& stack) {
    RockCase& rock = some_rock(random, stack);
    if (random.with(0.2)) {
        rock.base_elevation.reset();
        return;
    }
    // mostly refused, and then lowered
    rock.base_elevation =
        some_vertex(random, some_surface(random, stack))[2] - random.between(0, 2);
}

void step_in_a_surface(RandomSource& random, StackCase& stack) {
    add_jumps(random, some_surface(random, stack));
}

void needles_and_flips(RandomSource& random, StackCase& stack) {
    Mesh& mesh = some_surface(random, stack);
    PlanMesh plan;
    for (const Point& p : mesh.vertices)
        plan.vertices.push_back({p[0], p[1]});
    for (const Triangle& t : mesh.triangles) {
        const auto corners = plan_corners(plan, t);
        const bool turned = corners[1] != plan.vertices[static_cast<std::size_t>(t[1])];
        plan.triangles.push_back(turned ? Triangle{t[0], t[2], t[1]} : t);
    }
    flip_edges(random, plan, random.between(1, 8));
    mesh.triangles = plan.triangles;
}

void nudge_a_surface(RandomSource& random, StackCase& stack) {
    Mesh& mesh = some_surface(random, stack);
    random.with(0.5) ? nudge_heights(random, mesh) : nudge_plan(random, mesh);
}

void disorder_a_surface(RandomSource& random, StackCase& stack) {
    disorder(random, some_surface(random, stack));
}

void flat_triangles(RandomSource& random, StackCase& stack) {
    add_flat_triangles(random, some_surface(random, stack));
}

constexpr void (*kWays[])(RandomSource&, StackCase&) = {vertex_onto_another,
                                                        vertex_onto_another,
                                                        vertex_onto_an_edge,
                                                        vertex_onto_an_edge,
                                                        vertex_aside_by_an_ulp,
                                                        vertex_aside_by_an_ulp,
                                                        onto_a_plane,
                                                        touch_a_plane,
                                                        touch_a_plane,
                                                        onto_a_plane,
                                                        copy_a_patch,
                                                        copy_a_patch,
                                                        part_of_a_surface,
                                                        divide_a_triangle,
                                                        lift,
                                                        scale_heights,
                                                        elsewhere,
                                                        slide_a_surface,
                                                        round_everything,
                                                        order_of_surfaces,
                                                        change_a_rule,
                                                        change_the_region,
                                                        change_the_base,
                                                        step_in_a_surface,
                                                        needles_and_flips,
                                                        nudge_a_surface,
                                                        disorder_a_surface,
                                                        flat_triangles};

bool has_triangles(const StackCase& stack) {
    return !stack.rocks.empty() &&
           std::all_of(stack.rocks.begin(), stack.rocks.end(), [](const RockCase& rock) {
               return !rock.surfaces.empty() &&
                      std::all_of(rock.surfaces.begin(), rock.surfaces.end(),
                                  [](const Mesh& mesh) { return !mesh.triangles.empty(); });
           });
}

std::array<PlanPoint, 2> plan_box(const StackCase& stack) {
    std::array<PlanPoint, 2> box{{{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}}};
    for (const RockCase& rock : stack.rocks) {
        for (const Mesh& surface : rock.surfaces) {
            for (const Point& p : surface.vertices) {
                for (std::size_t axis = 0; axis < 2; ++axis) {
                    box[0][axis] = std::min(box[0][axis], p[axis]);
                    box[1][axis] = std::max(box[1][axis], p[axis]);
                }
            }
        }
    }
    return box;
}

/// Large enough that several threads share the work: a lattice of 12 to 28 squares a side.
StackCase large_stack(RandomSource& random) {
    const std::size_t count = families().size();
    StackCase stack = make_stack(random, random.below(count), 12, 28);
    stack.label += ", large";
    return stack;
}

StackCase some_stack(RandomSource& random, const std::vector<StackCase>& corpus) {
    if (!corpus.empty() && random.with(0.3)) return random.one_of(corpus);
    if (random.with(0.1)) return make_rock_masses(random, 3);
    return make_stack(random, random.below(families().size()), 1, 3);
}

}  // namespace

void mutate(RandomSource& random, StackCase& stack) {
    kWays[random.below(std::size(kWays))](random, stack);
}

void cross_over(RandomSource& random, StackCase& stack, const StackCase& other) {
    const auto [low, high] = plan_box(stack);
    const auto [other_low, other_high] = plan_box(other);
    PlanPoint scale{1, 1}, shift{0, 0};
    if (random.with(0.7)) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const double size = other_high[axis] - other_low[axis];
            scale[axis] = size > 0 ? (high[axis] - low[axis]) / size : 1.0;
            shift[axis] = low[axis] - other_low[axis] * scale[axis];
        }
    }
    RockCase& into = some_rock(random, stack);
    const RockCase& from = other.rocks[random.below(other.rocks.size())];
    into.all_rules();
    for (std::size_t k = 0; k < from.surfaces.size() && into.surfaces.size() < 8; ++k) {
        if (!random.with(0.6)) continue;
        Mesh mesh = from.surfaces[k];
        for (Point& p : mesh.vertices)
            p = {p[0] * scale[0] + shift[0], p[1] * scale[1] + shift[1], p[2]};
        const auto at = static_cast<std::ptrdiff_t>(random.below(into.surfaces.size() + 1));
        into.surfaces.insert(into.surfaces.begin() + at, std::move(mesh));
        into.rules.insert(into.rules.begin() + at, from.rule(k));
    }
}

StackCase make_case(RandomSource& random, const std::vector<StackCase>& corpus) {
    if (random.with(0.02)) return large_stack(random);
    StackCase stack = some_stack(random, corpus);
    if (random.with(0.35)) return stack;
    if (random.with(0.2)) {
        const StackCase other = some_stack(random, corpus);
        if (has_triangles(stack) && has_triangles(other)) cross_over(random, stack, other);
        stack.label += ", crossed";
    }
    for (int i = random.between(1, 6); i > 0 && has_triangles(stack); --i)
        mutate(random, stack);
    stack.label += ", changed";
    return stack;
}

StackCase case_number(std::uint64_t seed, std::uint64_t number,
                      const std::vector<StackCase>& corpus) {
    RandomSource random(seed * 0x9e3779b97f4a7c15U + number * 0xd1342543de82ef95U);
    return make_case(random, corpus);
}

}  // namespace realmodel::fuzz
