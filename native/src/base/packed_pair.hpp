// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace realmodel {

/// Two numbers of at least 0 as one, which sorts as they do, the first one before the second, but
/// faster.
constexpr std::uint64_t packed_pair(std::int32_t first, std::int32_t second) {
    return std::uint64_t{static_cast<std::uint32_t>(first)} << 32 |
           static_cast<std::uint32_t>(second);
}

constexpr std::array<std::int32_t, 2> unpacked_pair(std::uint64_t packed) {
    return {static_cast<std::int32_t>(packed >> 32),
            static_cast<std::int32_t>(packed & UINT32_MAX)};
}

}  // namespace realmodel
