// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/validation/sampling.hpp"

namespace realmodel::validation {

using PlanPosition = std::array<double, 2>;

/// A plan place where the model is compared with the closed form.
struct Probe {
    PlanPosition place{};
    std::int32_t wall = -1;  ///< which of the wall samples it lies beside, -1: none
    std::int32_t side = 0;   ///< of that wall: 0 the first cell's, 1 the second's
};

/// A point in a wall, well away from its ends.
struct WallSample {
    std::int32_t face = -1;
    PlanPosition middle{};
    PlanPosition from{}, to{};  ///< the stretch of the wall between two of its places
    double height = 0;          ///< of the point; in the middle of the wall there
    double half_width = 0;      ///< from there up and down to the wall's border
    double highest = 0;         ///< largest height of its corners, without its sign
};

/// Lengths that rounding makes: steps in the last place of the largest plan coordinate. Rounding
/// and what is done to the input first move a place by fewer than ten of them.
struct PlanRounding {
    double near = 0;  ///< closer to an edge than this, a place may lie on either side of it
    double step = 0;  ///< from a wall to the probes beside it
    explicit PlanRounding(double largest)
        : near(32 * largest * 0x1p-52), step(64 * largest * 0x1p-52) {}
};

struct Probes {
    std::vector<Probe> probes;
    std::vector<WallSample> walls;
    std::int64_t narrow_walls = 0;  ///< chosen, but too short to have two sides beyond rounding
};

/// The largest plan coordinate of a model and its input.
double largest_plan_coordinate(const ComplexView& model, const ModelInput& input);

/// Chooses the places; the same for the same seed.
Probes choose_probes(const ComplexView& model, const ModelInput& input, std::int64_t places,
                     std::uint64_t seed, const PlanRounding& rounding, Progress* progress);

/// The triangles of the input above and below each probe.
class InputColumns {
public:
    InputColumns(const ModelInput& input, const Probes& probes, const PlanRounding& rounding,
                 const Execution& execution);

    std::size_t surface_count() const { return surfaces_; }
    /// The triangle of a surface (counted through all rock masses) there, -1 where it has none or
    /// the region leaves it out.
    std::int32_t triangle(std::size_t probe, std::size_t surface) const {
        return triangle_[probe * surfaces_ + surface];
    }
    /// Whether an edge of the input passes too close to be sure on which side a probe lies.
    bool near_edge(std::size_t probe) const { return near_edge_[probe] != 0; }

private:
    std::size_t surfaces_ = 0;
    std::vector<std::int32_t> triangle_;
    std::vector<std::uint8_t> near_edge_;
};

/// Where the vertical line through a probe meets a face.
struct Crossing {
    std::int32_t probe, face;
    std::int32_t below, above;  ///< cells, -1 outside
    double height;
};

/// What the model has on the vertical lines through all probes.
class ModelColumns {
public:
    ModelColumns(const ComplexView& model, const Probes& probes, const PlanRounding& rounding,
                 const Execution& execution);

    /// In the order of their faces.
    std::span<const Crossing> of_probe(std::size_t probe) const { return crossings_[probe]; }
    /// Whether an edge of the model passes too close to a probe to be sure on which side it lies.
    bool near_edge(std::size_t probe) const { return near_edge_[probe] != 0; }
    /// Whether another edge passes so close to a wall that the probes beside it may lie beyond.
    bool coincident(std::size_t wall) const { return coincident_[wall] != 0; }

private:
    Buckets<Crossing> crossings_;
    std::vector<std::uint8_t> near_edge_, coincident_;
};

}  // namespace realmodel::validation
