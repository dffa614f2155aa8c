// SPDX-License-Identifier: GPL-3.0-or-later
/// CGAL's kernel of exact predicates, to be included before what else of CGAL is.
#pragma once

// A sum of its numbers (CGAL 5.5) begins with storage that is not set: where there is no memory its
// destructor would free an address left to chance.
#pragma push_macro("noalloc")
#define noalloc() Mpzf(allocate(), 0)
#include <CGAL/Mpzf.h>
#pragma pop_macro("noalloc")

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
