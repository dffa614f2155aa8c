// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "realmodel/base/execution.hpp"
#include "realmodel/strata/stack.hpp"

namespace realmodel::strata {

/// A mesh of a surface, three coordinates a vertex, or of a region, two.
struct JoinedMesh {
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles;
};

/// What differs in the plan coordinates and borders of rock masses by rounding alone. It is found
/// in all of them, and then joined one mesh at a time: there need not be memory for all meshes.
class Joins {
public:
    /// What build_rock_masses says where it joins the same.
    const Warning& warning() const;
    /// The vertices of a mesh of so many columns with plan coordinates joined; not the borders.
    std::vector<double> snapped(std::span<const double> vertices, std::size_t columns) const;
    /// A mesh, of so many columns, as build_rock_masses builds it. Nothing where it covers a
    /// position twice, or the border of a region crosses itself: then that takes all meshes as they
    /// are given. Triangles that are not divided keep their numbers.
    /// @throws InputError not_finite, bad_index, vertical_triangle; as above then
    /// @throws Cancelled
    std::optional<JoinedMesh> mesh(const TriangleView& mesh, std::size_t columns,
                                   const Execution& execution = {}) const;

private:
    struct State;
    explicit Joins(std::shared_ptr<const State> joining) : joining_(std::move(joining)) {}
    friend std::optional<Joins> find_joins(std::span<const StackInput> rocks, bool borders,
                                           const Execution& execution);

    std::shared_ptr<const State> joining_;
};

/// What build_rock_masses joins before it builds; nothing where that is nothing. Takes the memory
/// of some millions of coordinates, and of one mesh.
/// @param borders  whether borders are compared, too, or plan coordinates alone
/// @throws InputError too_large
/// @throws Cancelled
std::optional<Joins> find_joins(std::span<const StackInput> rocks, bool borders = true,
                                const Execution& execution = {});

}  // namespace realmodel::strata
