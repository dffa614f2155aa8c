// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "strata/overlay/envelope.hpp"
#include "strata/repair/site.hpp"

namespace realmodel::strata {

/// The envelope under the sky over the region of a rock mass, with the outside around it; where
/// there is a window, only what of the region lies in it. The planes of the window are made.
Envelope region_envelope(Site& site, EnteredRock& rock, const Execution& execution);

/// Cuts off what of a surface lies beyond the window of a tile, where its polygons cross the
/// border. So what they are divided into can become one facet again there, too, and the overlay
/// does not compound along the border.
void clip_to_window(Site& site, const EnteredRock& rock, SurfaceTiling& tiling, Progress* progress);

}  // namespace realmodel::strata
