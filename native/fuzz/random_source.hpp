// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace realmodel::fuzz {

/// Where the generators' choices come from: a seed, or bytes that a coverage-guided fuzzer makes.
/// The same on every machine and with every compiler, unlike the distributions of <random>.
class RandomSource {
public:
    explicit RandomSource(std::uint64_t seed) : state_(seed) {}

    /// Every choice uses up bytes; where they are used up the first possibility is taken.
    explicit RandomSource(std::span<const std::uint8_t> bytes) : bytes_(bytes), from_bytes_(true) {}

    /// 0 ... count - 1; count > 0.
    std::size_t below(std::size_t count) {
        if (count <= 1) return 0;
        return static_cast<std::size_t>(next(count <= 0x100 ? 1 : 4) % count);
    }

    /// low ... high, both included.
    int between(int low, int high) {
        return low + static_cast<int>(below(static_cast<std::size_t>(high - low) + 1));
    }

    /// True with a probability; the bytes of zero say no.
    bool with(double probability) {
        if (probability <= 0) return false;
        return uniform() > 1.0 - probability;
    }

    /// From 0 to below 1.
    double uniform() {
        return from_bytes_ ? static_cast<double>(next(2)) * 0x1p-16
                           : static_cast<double>(next(8) >> 11) * 0x1p-53;
    }

    double uniform(double low, double high) { return low + (high - low) * uniform(); }

    template <class T, std::size_t N>
    const T& one_of(const T (&possible)[N]) {
        return possible[below(N)];
    }

    template <class T>
    const T& one_of(const std::vector<T>& possible) {
        return possible[below(possible.size())];
    }

    template <class T>
    void shuffle(std::vector<T>& items) {
        for (std::size_t i = items.size(); i > 1; --i)
            std::swap(items[i - 1], items[below(i)]);
    }

private:
    std::uint64_t next(std::size_t width) {
        if (!from_bytes_) return mixed();
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < width && !bytes_.empty(); ++i) {
            value = value << 8 | bytes_.front();
            bytes_ = bytes_.subspan(1);
        }
        return value;
    }

    /// splitmix64 (Steele, Lea, Flood 2014).
    std::uint64_t mixed() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
        return z ^ (z >> 31);
    }

    std::uint64_t state_ = 0;
    std::span<const std::uint8_t> bytes_;
    bool from_bytes_ = false;
};

}  // namespace realmodel::fuzz
