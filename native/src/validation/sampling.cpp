// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/validation/sampling.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "base/checked_indices.hpp"
#include "validation/closed_form.hpp"
#include "validation/findings.hpp"
#include "validation/probes.hpp"

namespace realmodel::validation {

namespace {

/// Rounding moves a height by this many units in its last place, or in that of the plan times the
/// slope, at most; the larger part of it is what is done to the input before it is built.
constexpr double kHeightSteps = 32;

/// How far apart two heights may be that are moved on either side of a comparison, `highest` being
/// the largest of what they come from.
double rounding_of_heights(double highest) {
    constexpr double kLeast = std::numeric_limits<double>::denorm_min();
    return 2 * kHeightSteps * std::max(highest * 0x1p-52, kLeast);
}

std::string text_of(const std::vector<BlockInterval>& column) {
    std::string text;
    for (const BlockInterval& i : column) {
        text += (text.empty() ? "block " : ", block ") + std::to_string(i.block) + " from " +
                figure(i.low) + " to " + figure(i.high);
    }
    return text.empty() ? "nothing" : text;
}

/// The model along a vertical line: upwards from the outside, from cell to cell, to the outside.
struct ModelColumn {
    std::vector<BlockInterval> intervals;
    std::string broken;  ///< why that could not be done; empty where it could
};

ModelColumn walk(const ComplexView& model, std::span<const Crossing> crossings) {
    ModelColumn column;
    std::vector<const Crossing*> left;
    for (const Crossing& c : crossings)
        left.push_back(&c);
    std::int32_t cell = -1;
    double level = 0;
    while (!left.empty()) {
        const auto next = std::find_if(left.begin(), left.end(),
                                       [&](const Crossing* c) { return c->below == cell; });
        if (next == left.end() || (cell < 0 && !column.intervals.empty())) {
            column.broken = cell < 0 ? "face " + std::to_string(left.front()->face) +
                                           " lies apart from what is below it"
                                     : "cell " + std::to_string(cell) + " has no upper side";
            return column;
        }
        const Crossing& face = **next;
        left.erase(next);
        if (cell >= 0) {
            const std::int32_t block = model.block(cell);
            if (!column.intervals.empty() && column.intervals.back().block == block) {
                column.intervals.back().high = face.height;
            } else {
                column.intervals.push_back({block, level, face.height});
            }
        }
        cell = face.above;
        level = face.height;
    }
    if (cell >= 0) column.broken = "cell " + std::to_string(cell) + " has no upper side";
    return column;
}

std::vector<BlockInterval> thicker_than(const std::vector<BlockInterval>& column, double least) {
    std::vector<BlockInterval> thick;
    for (const BlockInterval& i : column) {
        if (i.high - i.low > least) thick.push_back(i);
    }
    return thick;
}

bool agree(const std::vector<BlockInterval>& a, const std::vector<BlockInterval>& b,
           double allowed) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [allowed](const BlockInterval& one, const BlockInterval& other) {
                          return one.block == other.block &&
                                 std::abs(one.low - other.low) <= allowed &&
                                 std::abs(one.high - other.high) <= allowed;
                      });
}

struct SampleFindings {
    Findings places, surfaces, walls;
    void append(const SampleFindings& later) {
        places.append(later.places);
        surfaces.append(later.surfaces);
        walls.append(later.walls);
    }
};

/// Compares the model with the closed form probe by probe.
class ProbeComparison {
public:
    ProbeComparison(const ComplexView& model, const ModelInput& input, const Probes& probes,
                    const PlanRounding& rounding, const ModelColumns& model_columns,
                    const InputColumns& input_columns)
        : model_(model),
          input_(input),
          probes_(probes),
          rounding_(rounding),
          model_columns_(model_columns),
          input_columns_(input_columns) {}

    void look(std::size_t probe, SampleFindings& findings) const {
        const PlanPosition& place = probes_.probes[probe].place;
        std::vector<std::int32_t> triangles(input_columns_.surface_count());
        for (std::size_t s = 0; s < triangles.size(); ++s)
            triangles[s] = input_columns_.triangle(probe, s);
        const ClosedColumn closed = closed_column(input_, triangles, place);
        const auto crossings = model_columns_.of_probe(probe);
        const ModelColumn column = walk(model_, crossings);
        double highest = closed.highest;
        for (const Crossing& c : crossings)
            highest = std::max(highest, std::abs(c.height));
        const double allowed = rounding_of_heights(highest) + 2 * closed.slope * rounding_.near;
        compare(probe, column, closed, allowed, findings.places);
        on_surfaces(probe, crossings, closed, allowed, findings.surfaces);
        if (probes_.probes[probe].wall >= 0)
            beside_wall(probe, column, closed, allowed, findings.walls);
    }

private:
    bool near_edge(std::size_t probe) const {
        return model_columns_.near_edge(probe) || input_columns_.near_edge(probe);
    }

    std::string at(std::size_t probe) const {
        const PlanPosition& p = probes_.probes[probe].place;
        return "at (" + figure(p[0]) + ", " + figure(p[1]) + ") ";
    }

    void compare(std::size_t probe, const ModelColumn& column, const ClosedColumn& closed,
                 double allowed, Findings& findings) const {
        ++findings.examined;
        // what is thinner than rounding need not be there, on either side
        const auto have = thicker_than(column.intervals, allowed);
        const auto want = thicker_than(closed.intervals, allowed);
        if (column.broken.empty() &&
            (agree(have, want, allowed) ||
             agree(thicker_than(have, 2 * allowed), thicker_than(want, 2 * allowed), 2 * allowed)))
            return;
        if (near_edge(probe)) {
            ++findings.undecided;
            return;
        }
        findings.fail([&] {
            const PlanPosition& p = probes_.probes[probe].place;
            const double height = !have.empty()   ? (have[0].low + have[0].high) / 2
                                  : !want.empty() ? (want[0].low + want[0].high) / 2
                                                  : 0.0;
            return Offender{
                .text = at(probe) +
                        (column.broken.empty() ? "the model has " + text_of(have) : column.broken) +
                        "; the closed form has " + text_of(want),
                .block = !have.empty() ? have[0].block : -1,
                .place = std::array<double, 3>{p[0], p[1], height}};
        });
    }

    void on_surfaces(std::size_t probe, std::span<const Crossing> crossings,
                     const ClosedColumn& closed, double allowed, Findings& findings) const {
        for (const Crossing& c : crossings) {
            const std::int32_t surface = model_.face_surface[static_cast<std::size_t>(c.face)];
            if (surface < 0) continue;  // a base is level: all of them were looked at
            ++findings.examined;
            const auto height = closed.surface_height[static_cast<std::size_t>(surface)];
            if (height && std::abs(*height - c.height) <= allowed) continue;
            if (near_edge(probe)) {
                ++findings.undecided;
                continue;
            }
            findings.fail([&] {
                const PlanPosition& p = probes_.probes[probe].place;
                return Offender{.text = at(probe) + "face " + std::to_string(c.face) +
                                        " lies at height " + figure(c.height) + ", the surface " +
                                        std::to_string(surface) + " that it names " +
                                        (height ? "at " + figure(*height) : "nowhere"),
                                .face = c.face,
                                .place = std::array<double, 3>{p[0], p[1], c.height}};
            });
        }
    }

    void beside_wall(std::size_t probe, const ModelColumn& column, const ClosedColumn& closed,
                     double allowed, Findings& findings) const {
        const Probe& p = probes_.probes[probe];
        const auto w = static_cast<std::size_t>(p.wall);
        const WallSample& wall = probes_.walls[w];
        ++findings.examined;
        // so far may the borders rise or fall on the way from the wall to here
        const double margin = std::max(allowed, rounding_of_heights(wall.highest)) +
                              closed.slope * (rounding_.step + rounding_.near);
        bool at_border = wall.half_width <= margin || !column.broken.empty();
        std::int32_t have = -1;
        for (const BlockInterval& i : column.intervals) {
            if (i.low < wall.height && wall.height < i.high) have = i.block;
            at_border |=
                std::abs(i.low - wall.height) <= margin || std::abs(i.high - wall.height) <= margin;
        }
        const std::int32_t cell =
            model_.cell(static_cast<std::size_t>(wall.face), static_cast<std::size_t>(p.side));
        const std::int32_t named = model_.block(cell);
        if (have == named) return;
        if (at_border || model_columns_.coincident(w) || near_edge(probe)) {
            ++findings.undecided;
            return;
        }
        findings.fail([&] {
            const auto name = [](std::int32_t block) {
                return block < 0 ? std::string("the outside") : "block " + std::to_string(block);
            };
            return Offender{.text = "wall " + std::to_string(wall.face) + " has " + name(named) +
                                    " on its " + (p.side == 0 ? "first" : "second") +
                                    " side, but " + name(have) + " lies there",
                            .cell = cell,
                            .face = wall.face,
                            .place = std::array<double, 3>{p.place[0], p.place[1], wall.height}};
        });
    }

    const ComplexView& model_;
    const ModelInput& input_;
    const Probes& probes_;
    const PlanRounding& rounding_;
    const ModelColumns& model_columns_;
    const InputColumns& input_columns_;
};

void require_vertices(const ModelInput& input) {
    int surface = 0;
    for (const strata::StackInput& rock : input.rocks) {
        for (const TriangleView& s : rock.surfaces)
            require_triangles(s.triangles, s.vertices.size() / 3, surface++);
        if (rock.region)
            require_triangles(rock.region->triangles, rock.region->vertices.size() / 2);
    }
}

}  // namespace

std::vector<TestResult> check_samples(const ComplexView& model, const ModelInput& input,
                                      std::int64_t places, std::uint64_t seed,
                                      const Execution& execution) {
    const auto start = std::chrono::steady_clock::now();
    const auto report = [&](double fraction, const char* text) {
        if (execution.progress == nullptr) return;
        execution.progress->check();
        execution.progress->report(fraction, text);
    };
    report(0.0, "choosing test points");
    require_vertices(input);
    const PlanRounding rounding(largest_plan_coordinate(model, input));
    const Probes probes = choose_probes(model, input, places, seed, rounding, execution.progress);
    report(0.1, "finding the faces at the test points");
    const ModelColumns model_columns(model, probes, rounding, execution);
    report(0.5, "finding the surfaces at the test points");
    const InputColumns input_columns(input, probes, rounding, execution);
    report(0.7, "comparing with the closed form");
    const ProbeComparison comparison(model, input, probes, rounding, model_columns, input_columns);
    constexpr std::size_t kProbesOfChunk = 64;
    const auto look = [&](std::size_t begin, std::size_t end, SampleFindings& findings) {
        for (std::size_t i = begin; i < end; ++i)
            comparison.look(i, findings);
    };
    auto all = in_chunks<SampleFindings>(probes.probes.size(), execution, look, kProbesOfChunk);
    all.walls.examined += 2 * probes.narrow_walls;
    all.walls.undecided += 2 * probes.narrow_walls;
    report(1.0, "comparing with the closed form");
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    // all three are tested in one pass: its time stands with the first
    return {{"places", "places", std::move(all.places), seconds.count()},
            {"surfaces", "faces met", std::move(all.surfaces), 0.0},
            {"walls", "wall sides", std::move(all.walls), 0.0}};
}

}  // namespace realmodel::validation
