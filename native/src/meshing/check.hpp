// SPDX-License-Identifier: GPL-3.0-or-later
// How the meshers' loops are watched and stopped.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "realmodel/base/progress.hpp"

namespace realmodel::meshing {

/// Called now and then (at least every few milliseconds) with the share of a step that is done;
/// throws to stop it.
using Check = std::function<void(double)>;

/// Asks whether the caller wants to stop; null: nobody does.
inline Check stopped_by(const Progress* progress) {
    return [progress](double) {
        if (progress != nullptr) progress->check();
    };
}

/// Passes on every so many calls to a check: for the innermost loops.
class Ticker {
public:
    explicit Ticker(const Check& check, std::size_t every = 16384) : check_(check), every_(every) {}
    void operator()(double share) {
        if (++calls_ % every_ == 0) check_(share);
    }

private:
    const Check& check_;
    std::size_t every_;
    std::size_t calls_ = 0;
};

/// A pair of point numbers.
using VertexSegment = std::array<std::int32_t, 2>;

}  // namespace realmodel::meshing
