// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace realmodel::fuzz {

/// Has allocations of this process fail while it lives: the one of a number, counted from 1, and
/// perhaps all after it. One object at a time. For programs that link
/// realmodel_failing_allocations: operator new and what the library takes by malloc() and
/// realloc(), as arrays, GMP and Eigen do.
class FailingAllocations {
public:
    FailingAllocations(std::uint64_t number, bool and_later);
    FailingAllocations(const FailingAllocations&) = delete;
    FailingAllocations& operator=(const FailingAllocations&) = delete;
    ~FailingAllocations();
    /// How many were asked for until now.
    std::uint64_t count() const;
};

}  // namespace realmodel::fuzz
