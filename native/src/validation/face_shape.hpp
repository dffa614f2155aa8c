// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/validation/findings.hpp"
#include "validation/cell_faces.hpp"

namespace realmodel::validation {

/// How far rounding may have moved a coordinate: this many units in the last place of the largest
/// coordinate on its axis. Half of one comes from rounding itself; corners that fell together were
/// moved apart by a few (docs/dev/geometry.md).
inline constexpr double kRoundingSteps = 16;

/// A unit in the last place, or a little more, of numbers up to this size.
inline double last_place(double largest) {
    return largest * 0x1p-52;
}

/// A face, looked at: whether it is a simple polygon in one plane, convex where it is no wall,
/// upright where it is one, and level with the base where it names it; up to rounding.
class FaceShape {
public:
    explicit FaceShape(const ComplexView& model) : model_(model) {}

    /// Takes a face, which all questions are about from then on.
    void load(std::size_t face);
    const std::array<double, 3>& corner(std::size_t i) const { return corners_[i]; }
    /// Twice the area vector, which points out of the first cell.
    const std::array<double, 3>& doubled_area() const { return area_; }
    /// What is wrong with it, or nothing.
    std::optional<std::string> fault();

private:
    using Position = std::array<double, 3>;
    using PlanPosition = std::array<double, 2>;

    std::optional<std::string> fault_of_base() const;
    bool is_flat() const;
    bool is_flat_precisely() const;
    PlanPosition way_of_wall() const;
    bool is_upright(const PlanPosition& way) const;
    void project(std::size_t first_axis, std::size_t second_axis);
    bool is_convex() const;
    bool turns_one_way() const;
    bool rises_and_falls_once(std::size_t axis) const;
    bool crosses_itself() const;
    bool chains_cross() const;

    const ComplexView& model_;
    std::size_t face_ = 0;
    std::vector<Position> corners_;
    Position allowance_{};  ///< of the coordinates of this face, by axis
    Position area_{};
    std::vector<PlanPosition> flat_;
    PlanPosition flat_allowance_{};
};

/// What a face adds to the volumes of its two cells, each measured from a corner of that cell, so
/// that coordinates far from the origin cost no digits.
struct FaceMeasure {
    std::array<double, 2> volume{0, 0};
    /// How much a volume changes at most where every corner moves by a unit in the last place.
    double rounding = 0;
};

/// One pass over all faces, which fetches the corners of each once: whether it is a polygon as it
/// should be, and its share in volumes.
class FaceMeasures {
public:
    FaceMeasures(const ComplexView& model, const FacesByCell& sides, const Execution& execution);

    const FaceMeasure& operator[](std::size_t face) const { return measures_[face]; }
    Findings& findings() { return findings_; }

private:
    std::vector<FaceMeasure> measures_;
    Findings findings_;
};

}  // namespace realmodel::validation
