// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace realmodel {

/// Bytes that this process may still take without swapping or being ended: the least of what the
/// machine has free (MemAvailable), what its control groups leave it (versions 1 and 2, page cache
/// not counted), and what its own limit of address space leaves (ulimit -v). Linux; where nothing
/// is known, the largest number.
std::uint64_t available_memory();

/// Gives memory that was freed but is kept by the allocator for later back to the system, as after
/// a large computation (glibc; elsewhere allocators do so on their own, and this does nothing).
void give_back_memory() noexcept;

}  // namespace realmodel
