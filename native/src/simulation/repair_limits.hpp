// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "simulation/post_levels.hpp"

namespace realmodel::simulation {

/// What repairs may take of each block. Where the end of a layer is given up because of its shape,
/// the next one may be no better: in a layer of even thickness a hole of a few nodes would grow
/// ring by ring until nothing is left. Where layers taper, fewer places follow from ring to ring.
class RepairLimits {
public:
    /// @param volumes  of each block, before the first repair
    RepairLimits(const ColumnInput& input, std::span<const double> volumes);

    /// Leaves out removals that would change a block where it stays as it is.
    void limit(const PostLevels& levels, std::vector<PostLevels::Removal>& removals) const;

    /// Notes what removals that are about to be made change.
    void note(const PostLevels& levels, std::span<const PostLevels::Removal> removals);

    /// Whether a block has changed by more than repairs may cost: a share of itself, and a little
    /// of all volumes.
    bool changes_much(std::size_t block, std::span<const double> volumes, double most) const;

    /// Judges what was noted and notes anew. @return whether blocks stay as they are at more places
    /// from now on, because there a front grew, or their repair cost too much: then the step that
    /// made the removals has to begin again
    bool take_back(std::span<const double> volumes, double most);

    /// The blocks that stay as they are somewhere.
    std::vector<std::int32_t> kept_blocks() const;

private:
    /// A block at a node.
    struct Place {
        std::int32_t block, node;
        auto operator<=>(const Place&) const = default;
    };
    /// Where a block was given up, and in which ring: 1 if it was so nowhere beside it before.
    struct Taken {
        Place place;
        std::int32_t ring;
        auto operator<=>(const Taken&) const = default;
    };

    template <class Visit>
    void for_blocks(const PostLevels& levels, const PostLevels::Removal& removal,
                    const Visit& visit) const;
    std::size_t found(const Place& place) const;
    template <class Visit>
    void for_taken_around(const Place& place, const Visit& visit) const;
    std::vector<std::vector<std::size_t>> fronts() const;

    const ColumnInput& input_;
    std::vector<double> volumes_;
    double least_ = 0;                    ///< what every block may lose or gain
    Buckets<std::size_t> posts_;          ///< of each node
    Buckets<std::size_t> triangles_;      ///< around each node
    std::vector<Taken> taken_;            ///< sorted
    std::vector<Place> kept_;             ///< sorted
    std::vector<std::uint8_t> is_whole_;  ///< of each block: it is kept everywhere
};

}  // namespace realmodel::simulation
