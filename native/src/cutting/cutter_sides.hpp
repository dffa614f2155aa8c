// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "cutting/nearest_side.hpp"
#include "cutting/surface_cells.hpp"

namespace realmodel::cutting {

/// Which parts of the cells that a surface divides are wanted.
class PartSides {
public:
    virtual ~PartSides() = default;

    /// The part of its cells that a region of a face bounds which does not lie on the surface:
    /// kAbove or kBelow, kOn where it is left out.
    virtual std::int8_t of_region(std::size_t region, std::size_t face) const = 0;
    /// The same of a face that has no regions.
    virtual std::int8_t of_face(std::size_t face) const = 0;
    /// The same of a cell at side 0 or 1 of a region of the surface.
    virtual std::int8_t of_cap(std::size_t region, std::size_t side, std::int32_t cell) const = 0;
    /// Whether a region of the surface is a face between the parts of cells on its two sides; where
    /// it is not, they are one.
    virtual bool separates(std::size_t /*region*/) const { return true; }
    /// The same of a component of undivided triangles; of these the region at the first of their
    /// borders tells the rest.
    virtual bool separates_undivided(std::size_t /*component*/) const { return true; }
    /// What stands for a model's face in pieces of a region of the surface, less than 0. Either
    /// cell may be -1.
    virtual std::int32_t cap_face(std::size_t /*region*/, std::int32_t /*low*/,
                                  std::int32_t /*high*/) const {
        return -1;
    }
    /// Whether where a cell ends at a region of the surface it ends at the outer face there, if the
    /// model has one.
    virtual bool ends_at_outer_face(std::size_t /*region*/, std::int32_t /*cell*/) const {
        return true;
    }
    /// Whether a cell reaches the surface, so that it may be divided.
    bool reaches(std::int32_t cell) const { return reaches_[index(cell)] != 0; }

protected:
    /// @param reaches  of cells (cells_near_surface)
    explicit PartSides(std::vector<std::uint8_t> reaches) : reaches_(std::move(reaches)) {}
    std::span<const std::uint8_t> cells_reaching() const { return reaches_; }

private:
    std::vector<std::uint8_t> reaches_;
};

/// On which side of a surface everything is. Going round its edges, the side changes with every
/// region of it that is crossed, and with nothing else; faces away from it have the side of those
/// beside them. Inside of a closed surface is what a ray leaves through it an odd number of times;
/// below an open one is what its regions have below them, and all must agree.
class CutterSides : public PartSides {
public:
    /// @throws InputError kinds ends_inside, two_sides
    CutterSides(SurfaceOverlay& overlay, const CutterWinding& winding, Progress* progress);

    std::int8_t of_region(std::size_t region, std::size_t) const override { return side(region); }
    std::int8_t of_face(std::size_t face) const override { return side(overlay_.size() + face); }
    std::int8_t of_cap(std::size_t region, std::size_t side, std::int32_t) const override {
        return static_cast<std::int8_t>(side == 0 ? below(region) : -below(region));
    }
    /// Of what is at side 0 of a region of the surface; at side 1 it is the other.
    std::int8_t below(std::size_t region) const { return side(region); }

private:
    std::ptrdiff_t own_uses(std::span<const EdgeUse> uses) const;
    SurfaceCells::Rules rules() const;
    void refuse_borders() const;
    void settle(std::size_t part, std::int8_t side);
    std::int8_t side_at(std::size_t item, bool of_cutter);
    std::int8_t side(std::size_t item) const {
        const std::int32_t part = parts_.of(item);
        return part < 0 ? kOn : *sides_[index(part)];
    }
    [[noreturn]] void refuse(const char* kind, const char* text,
                             const std::array<NodeId, 2>& edge) const;

    SurfaceOverlay& overlay_;
    const CutterWinding& winding_;
    SurfaceCells parts_;
    std::vector<std::optional<std::int8_t>> sides_;  ///< of parts
    std::optional<NearestSide> nearest_;             ///< once it is asked for
};

}  // namespace realmodel::cutting
