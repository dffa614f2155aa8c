// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace realmodel::input {

/// Bytes of a strip or tile of a TIFF file compressed by LZW (TIFF 6.0, section 13: codes of 9 to
/// 12 bits, most significant bit first, the width changing one code early).
///
/// Ends at the end-of-information code, or where the codes end.
/// @throws InputError kind "damaged" for an impossible code, or for more than `most` bytes
std::vector<std::uint8_t> decode_lzw(std::span<const std::uint8_t> encoded, std::size_t most);

}  // namespace realmodel::input
