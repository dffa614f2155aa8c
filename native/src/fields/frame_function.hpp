// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "fields/known_data.hpp"
#include "fields/random_function.hpp"
#include "fields/spline.hpp"

namespace realmodel::fields {

/// The further coordinates of positions in the lattice, linear between its nodes, those of one
/// position together.
/// @param side  combination of sides of slits
std::vector<double> lifts_at(const KnownData& known, std::span<const Vec3> positions,
                             std::size_t side);

/// f as the solution has it, in its frame: a spline, and what is drawn beside it.
class FrameFunction {
public:
    /// @param drawn  none: f is the spline
    FrameFunction(const KnownData& known, const Spline& spline,
                  const RandomFunction* drawn = nullptr)
        : known_(known), spline_(spline), drawn_(drawn) {}

    /// f of a surface.
    double level(std::int32_t surface) const;
    std::vector<double> levels() const;
    /// f at places in the frame.
    /// @param lifts  further coordinates, those of one place together
    void values_at(std::span<const Vec3> places, std::span<const double> lifts,
                   std::span<double> values) const;
    /// f at the nodes of a lattice in the box of that of the data, on a combination of sides of
    /// slits.
    std::vector<double> at_nodes(const Lattice& lattice, std::size_t side,
                                 const Execution& execution) const;

private:
    const KnownData& known_;
    const Spline& spline_;
    const RandomFunction* drawn_;
};

}  // namespace realmodel::fields
