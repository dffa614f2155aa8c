// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace realmodel::interpolation {

/// Which points make a node's system. Distances are in plan.
struct Neighborhood {
    int neighbors = 16;  ///< at most so many; 0: no limit
    int octants = 0;     ///< at most so many from each eighth of the directions; 0: no limit
    double radius = 0;   ///< none farther than this, but for the nearest; 0: no limit

    bool plain() const { return octants == 0 && radius == 0; }
};

}  // namespace realmodel::interpolation
