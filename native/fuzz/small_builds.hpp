// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace realmodel::fuzz {

struct SmallBuild {
    std::string name;
    /// Builds it on so many threads, from the input alone.
    std::function<std::uint64_t(int threads)> digest;
};

/// One of each kind, random ones of a seed, which take milliseconds: columns and blocks of a stack,
/// a Boolean, cuts by a plane and by a surface, faults, a field, kriging, meshes of a region and of
/// tetrahedra.
std::vector<SmallBuild> small_builds(std::uint64_t seed);

}  // namespace realmodel::fuzz
