// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <mutex>
#include <string>

namespace realmodel {

/// Where a long computation stands, and the wish of its caller to stop it.
///
/// The computation reports and checks from any of its threads while another thread watches and
/// cancels; every member may be called at any time.
class Progress {
public:
    /// Says how far the work is.
    /// @param fraction  share of the work done; kept within 0 .. 1, NaN is left out
    /// @param text      what is being done, UTF-8, copied (what is longer than 127 bytes is cut);
    ///                  null keeps the text that was there
    void report(double fraction, const char* text) noexcept;

    /// Asks the computation to stop; it does so at its next check().
    void cancel() noexcept;
    bool cancelled() const noexcept;

    /// @throws Cancelled once cancel() was called. Not to be called inside an OpenMP region, which
    ///         no exception may leave: there ask cancelled() and check() after it.
    void check() const;

    double fraction() const noexcept;
    std::string text() const;

private:
    std::atomic<double> fraction_{0.0};
    std::atomic<bool> cancelled_{false};
    mutable std::mutex text_mutex_;
    std::array<char, 128> text_{};  // fixed, so that report() cannot fail for want of memory
};

}  // namespace realmodel
