// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "fields/functional.hpp"
#include "fields/known_data.hpp"
#include "fields/spline.hpp"
#include "realmodel/fields/field.hpp"

namespace realmodel::fields {

/// A random function in space, drawn by turning bands (Matheron 1973): a sum of processes on lines
/// in all directions, with a spline's kernel as generalized covariance. On a line that of r^3 is
/// an integrated Brownian motion, and that of -r a Brownian motion (Matheron 1973, "The intrinsic
/// random functions"; Chiles and Delfiner 2012, section 7.4). That of the fifth order is a sum of
/// waves, one on each line, whose frequencies have the spectral density of Matern's covariance:
/// that of the t distribution with 7 degrees of freedom (Rasmussen and Williams 2006,
/// equation 4.15).
class RandomFunction {
public:
    /// @param scale   variance per unit of the kernel
    /// @param reach   how far from the origin places are at most, in the mapped coordinates
    /// @param rough   of the kernel -r: over what distance a Brownian motion, which has no
    ///                derivatives, is averaged
    /// @param drawn   normal numbers
    RandomFunction(const Smoothness& smoothness, double scale, double reach, double rough,
                   const DrawnNumbers& drawn);

    double of(const Functional& functional) const;
    double value(const Vec3& at, const Lift& lift = {}) const;
    /// Adds the value at each position.
    /// @param lifts  further coordinates, those of one position together
    void add_values(std::span<const Vec3> positions, std::span<const double> lifts,
                    std::span<double> values) const;

private:
    struct OnLine {
        double value, rise;
    };

    void wave(double size, const double* normal, std::span<double> rises) const;
    double along(std::size_t line, const Vec3& at, const Lift& lift) const;
    double integral(std::size_t line, double t) const;
    OnLine on_line(std::size_t line, double t) const;

    Smoothness smoothness_;
    double reach_, rough_, factor_;
    std::size_t dimensions_, lines_, steps_;
    double step_;
    std::vector<double> directions_;  // of length 1
    std::vector<double> values_;      // of each line the motion at the ends of all steps
    std::vector<double> integrals_;   // of these, linear in between
};

/// The further coordinates of positions in the lattice, linear between its nodes, those of one
/// position together.
/// @param combination  combination of sides of slits
std::vector<double> lifts_at(const KnownData& known, std::span<const Vec3> positions,
                             std::size_t combination);

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
    std::vector<double> at_nodes(const Lattice& lattice, std::size_t combination,
                                 const Execution& execution) const;

private:
    const KnownData& known_;
    const Spline& spline_;
    const RandomFunction* drawn_;
};

}  // namespace realmodel::fields
