// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/input/lzw.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "realmodel/base/errors.hpp"

namespace realmodel::input {

namespace {

constexpr int kClear = 256, kEndOfInformation = 257, kFirstFree = 258, kTableSize = 4096;
constexpr int kLeastWidth = 9, kGreatestWidth = 12;

[[noreturn]] void refuse(const char* what) {
    throw InputError("damaged", std::string("damaged LZW data: ") + what);
}

/// The bytes of a code: those of the code before it and one more, which lie in the output where the
/// code was made.
struct CodeEntry {
    std::size_t begin, length;
};

}  // namespace

std::vector<std::uint8_t> decode_lzw(std::span<const std::uint8_t> encoded, std::size_t most) {
    std::vector<std::uint8_t> out;
    out.reserve(most);
    std::array<CodeEntry, kTableSize> table{};
    int next = kFirstFree, width = kLeastWidth;
    bool fresh = true;  // just cleared: the next code is a byte and makes no entry
    CodeEntry previous{0, 0};
    std::uint32_t bits = 0;
    int held = 0;
    for (const std::uint8_t byte : encoded) {
        bits = (bits << 8 | byte) & 0xfffff;  // 20 bits: more than are ever held
        held += 8;
        if (held < width) continue;
        held -= width;
        const int code = static_cast<int>(bits >> held & ((1u << width) - 1));
        if (code == kEndOfInformation) break;
        if (code == kClear) {
            next = kFirstFree;
            width = kLeastWidth;
            fresh = true;
            continue;
        }
        const CodeEntry here{out.size(), code < kClear ? 1
                                         : code < next ? table[code].length
                                                       : previous.length + 1};
        if (code > next || (fresh && code > kClear)) refuse("a code that was not made yet");
        if (here.length > most - out.size()) refuse("it is longer than the image");
        if (code < kClear) {
            out.push_back(static_cast<std::uint8_t>(code));
        } else {
            // The code that is being made now is the previous one and its own first byte, which
            // is why bytes are copied one by one: the source may run into what is written.
            const std::size_t from = code < next ? table[code].begin : previous.begin;
            for (std::size_t i = 0; i < here.length; ++i)
                out.push_back(out[from + i]);
        }
        if (!fresh && next < kTableSize) {  // a full table stays as it is until it is cleared
            table[next++] = {previous.begin, previous.length + 1};
            if (next + 1 >= 1 << width) width = std::min(width + 1, kGreatestWidth);
        }
        previous = here;
        fresh = false;
    }
    return out;
}

}  // namespace realmodel::input
