// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/base/device.hpp"
#include "realmodel/base/execution.hpp"

namespace realmodel::structures {

/// Equal positions of marked vertices get one vertex, and are numbered in their order: the k-th
/// position has the k-th of the marked numbers. Other vertices stay.
/// @throws Cancelled
void merge_vertices(const VertexMerging& task, const Execution& execution);

}  // namespace realmodel::structures
