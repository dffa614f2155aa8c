// SPDX-License-Identifier: GPL-3.0-or-later
// A peer: the questions that a stack is decided by, asked of our exact kernel and of CGAL's kernel
// with exact predicates and constructions (EPECK). Planes through random triangles; the lines in
// plan where two are equally high; where two such lines cross; on which side of a third line that
// lies; and its coordinates as doubles. The answers must be the same.
//
//   exact_kernels [SURFACES]
//
// Prints the nanoseconds that each takes for a crossing and its position, and for a side.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "exact/local_arrangement.hpp"

namespace {

using namespace realmodel::exact;
using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Triangle = std::array<std::array<double, 3>, 3>;
using Clock = std::chrono::steady_clock;

struct Answers {
    std::vector<int> sides;
    std::vector<std::array<double, 2>> positions;
    double seconds_crossing = 0, seconds_side = 0;
};

double since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Triangles over one square; with steps their coordinates lie on a lattice, where many lines meet.
std::vector<Triangle> draw(std::size_t count, int steps) {
    std::mt19937_64 random(7);
    const auto number = [&] {
        return steps > 0 ? static_cast<double>(random() % static_cast<std::uint64_t>(steps))
                         : std::uniform_real_distribution<double>(4e5, 4e5 + 1000)(random);
    };
    std::vector<Triangle> triangles;
    while (triangles.size() < count) {
        Triangle t;
        for (auto& corner : t)
            corner = {number(), number(), number()};
        const double area =
            (t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) - (t[1][1] - t[0][1]) * (t[2][0] - t[0][0]);
        if (area == 0) continue;
        if (area < 0) std::swap(t[1], t[2]);
        triangles.push_back(t);
    }
    return triangles;
}

/// Pairs of traces that cross: planes (a, b) and (a, c), and the third trace (b, d).
struct Question {
    std::size_t a, b, c, d;
};

Answers ask_cgal(const std::vector<Triangle>& triangles, std::vector<Question>& questions) {
    std::vector<Kernel::Plane_3> planes;
    for (const Triangle& t : triangles) {
        std::array<Kernel::Point_3, 3> p;
        for (std::size_t i = 0; i < 3; ++i)
            p[i] = Kernel::Point_3(t[i][0], t[i][1], t[i][2]);
        planes.emplace_back(p[0], p[1], p[2]);
    }
    // positive where the first plane is higher; c of an upward plane is positive
    const auto trace = [&](std::size_t i, std::size_t j) {
        const auto &p = planes[i], &q = planes[j];
        return Kernel::Line_2(q.a() * p.c() - p.a() * q.c(), q.b() * p.c() - p.b() * q.c(),
                              q.d() * p.c() - p.d() * q.c());
    };
    Answers answers;
    std::vector<Question> kept;
    std::vector<Kernel::Point_2> points;
    std::vector<Kernel::Line_2> others;
    auto start = Clock::now();
    for (const Question& q : questions) {
        const Kernel::Line_2 first = trace(q.a, q.b), second = trace(q.a, q.c);
        if (first.is_degenerate() || second.is_degenerate()) continue;
        const auto found = CGAL::intersection(first, second);
        const auto* point = found ? boost::get<Kernel::Point_2>(&*found) : nullptr;
        if (point == nullptr) continue;
        points.push_back(*point);
        answers.positions.push_back(
            {CGAL::to_double(CGAL::exact(point->x())), CGAL::to_double(CGAL::exact(point->y()))});
        kept.push_back(q);
    }
    answers.seconds_crossing = since(start);
    questions = kept;
    start = Clock::now();
    for (std::size_t i = 0; i < questions.size(); ++i) {
        const Question& q = questions[i];
        answers.sides.push_back(trace(q.b, q.d).oriented_side(points[i]));
    }
    answers.seconds_side = since(start);
    return answers;
}

Answers ask_ours(const std::vector<Triangle>& triangles, const std::vector<Question>& questions) {
    PlanArrangement geometry;
    std::vector<std::array<SpaceId, 3>> corners;
    for (const Triangle& t : triangles) {
        auto& space = corners.emplace_back();
        for (std::size_t i = 0; i < 3; ++i)
            space[i] = geometry.add_space_vertex(geometry.add_vertex(t[i][0], t[i][1]), t[i][2]);
    }
    geometry.freeze_vertices();
    std::vector<PlaneId> planes;
    for (const auto& corner : corners)
        planes.push_back(geometry.add_plane(corner));
    LocalArrangement local(geometry);
    Answers answers;
    std::vector<PointId> points;
    auto start = Clock::now();
    for (const Question& q : questions) {
        const PointId point = local.crossing(local.trace(planes[q.a], planes[q.b]).id(),
                                             local.trace(planes[q.a], planes[q.c]).id());
        points.push_back(point);
        answers.positions.push_back(local.rounded(point));
    }
    answers.seconds_crossing = since(start);
    start = Clock::now();
    for (std::size_t i = 0; i < questions.size(); ++i) {
        const Question& q = questions[i];
        answers.sides.push_back(local.side(local.trace(planes[q.b], planes[q.d]), points[i]));
    }
    answers.seconds_side = since(start);
    return answers;
}

void compare(const char* name, std::size_t count, int steps) {
    const std::vector<Triangle> triangles = draw(count, steps);
    std::mt19937_64 random(11);
    std::vector<Question> questions;
    while (questions.size() < 20 * count) {
        Question q{random() % count, random() % count, random() % count, random() % count};
        if (q.a != q.b && q.a != q.c && q.b != q.c && q.b != q.d && q.a != q.d && q.c != q.d)
            questions.push_back(q);
    }
    const Answers cgal = ask_cgal(triangles, questions), ours = ask_ours(triangles, questions);
    std::size_t sides = 0, positions = 0;
    for (std::size_t i = 0; i < questions.size(); ++i) {
        sides += cgal.sides[i] != ours.sides[i];
        positions += cgal.positions[i] != ours.positions[i];
    }
    const double each = 1e9 / static_cast<double>(questions.size());
    std::printf(
        "%-24s crossing and position: ours %6.0f ns, EPECK %6.0f ns; side: ours %5.0f ns, "
        "EPECK %5.0f ns; %zu sides differ, %zu positions of %zu\n",
        name, ours.seconds_crossing * each, cgal.seconds_crossing * each, ours.seconds_side * each,
        cgal.seconds_side * each, sides, positions, questions.size());
}

}  // namespace

int main(int argc, char** argv) {
    const std::size_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1000;
    compare("anywhere, UTM", count, 0);
    compare("lattice of 64 steps", count, 64);
}
