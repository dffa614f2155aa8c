// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "strata/overlay/envelope.hpp"
#include "strata/repair/site.hpp"

namespace realmodel::strata {

/// The envelope under the sky over the region of a rock mass, with the outside around it; where
/// there is a window, only what of the region lies in it. The planes of the window are made.
Envelope region_envelope(Site& site, EnteredRock& rock, int threads, const Progress* progress);

}  // namespace realmodel::strata
