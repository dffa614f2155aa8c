// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/progress.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "realmodel/base/errors.hpp"

namespace realmodel {
namespace {

TEST(Progress, StartsAtNothing) {
    Progress progress;
    EXPECT_EQ(progress.fraction(), 0.0);
    EXPECT_EQ(progress.text(), "");
    EXPECT_FALSE(progress.cancelled());
    EXPECT_NO_THROW(progress.check());
}

TEST(Progress, KeepsWhatWasReportedLast) {
    Progress progress;
    progress.report(0.25, "meshing");
    progress.report(0.5, "kriging");
    EXPECT_EQ(progress.fraction(), 0.5);
    EXPECT_EQ(progress.text(), "kriging");
}

TEST(Progress, NullTextKeepsTheText) {
    Progress progress;
    progress.report(0.25, "meshing");
    progress.report(0.75, nullptr);
    EXPECT_EQ(progress.fraction(), 0.75);
    EXPECT_EQ(progress.text(), "meshing");
}

TEST(Progress, FractionStaysWithinZeroAndOne) {
    Progress progress;
    progress.report(1.5, "a");
    EXPECT_EQ(progress.fraction(), 1.0);
    progress.report(-0.5, "a");
    EXPECT_EQ(progress.fraction(), 0.0);
    progress.report(0.5, "a");
    progress.report(std::numeric_limits<double>::quiet_NaN(), "b");
    EXPECT_EQ(progress.fraction(), 0.5);
    EXPECT_EQ(progress.text(), "b");
}

TEST(Progress, LongTextIsCutBetweenCharacters) {
    Progress progress;
    // 126 bytes and then "é" of two bytes: the 127 bytes that there is room for would end in its
    // middle.
    progress.report(0.0, (std::string(126, 'a') + "\xC3\xA9" + "b").c_str());
    EXPECT_EQ(progress.text(), std::string(126, 'a'));
    progress.report(0.0, (std::string(125, 'a') + "\xC3\xA9" + "b").c_str());
    EXPECT_EQ(progress.text(), std::string(125, 'a') + "\xC3\xA9");
    progress.report(0.0, std::string(127, 'c').c_str());
    EXPECT_EQ(progress.text(), std::string(127, 'c'));
}

TEST(Progress, CheckThrowsOnceCancelled) {
    Progress progress;
    progress.cancel();
    EXPECT_TRUE(progress.cancelled());
    EXPECT_THROW(progress.check(), Cancelled);
    EXPECT_THROW(progress.check(), Cancelled);
}

TEST(Progress, MayBeWatchedWhileItIsReported) {
    Progress progress;
    std::atomic<bool> stopped{false};
    std::thread worker([&] {
        try {
            for (int step = 0;; ++step) {
                progress.report((step % 100) / 100.0, step % 2 == 0 ? "even" : "odd step");
                progress.check();
            }
        } catch (const Cancelled&) {
            stopped = true;
        }
    });
    for (int look = 0; look < 1000; ++look) {
        const std::string text = progress.text();
        EXPECT_TRUE(text.empty() || text == "even" || text == "odd step") << text;
        EXPECT_GE(progress.fraction(), 0.0);
        EXPECT_LE(progress.fraction(), 1.0);
    }
    progress.cancel();
    worker.join();
    EXPECT_TRUE(stopped);
}

TEST(CountedLoop, LoopsShareAPartWithoutEverLeavingIt) {
    Progress progress;
    progress.begin(0.2, 0.6, "a part");
    EXPECT_EQ(progress.text(), "a part");
    double before = progress.fraction();
    EXPECT_EQ(before, 0.2);
    for (int loop = 0; loop < 20; ++loop) {
        CountedLoop counted(&progress, 8);
        for (int round = 0; round < 8; ++round) {
            counted.count();
            EXPECT_GT(progress.fraction(), before);
            before = progress.fraction();
        }
    }
    EXPECT_LT(before, 0.6);
    EXPECT_NEAR(before, 0.6, 1e-6);
    progress.begin(0.6, 1.0, "the rest");
    EXPECT_EQ(progress.fraction(), 0.6);
}

TEST(CountedLoop, TakesTheShareThatItIsGiven) {
    Progress progress;
    progress.begin(0.0, 1.0, "all");
    CountedLoop counted(&progress, 4, 0.8);
    for (const double expected : {0.2, 0.4, 0.6, 0.8}) {
        counted.count();
        EXPECT_DOUBLE_EQ(progress.fraction(), expected);
    }
}

TEST(CountedLoop, OutsideOfPartsAndWithoutProgressCountsNothing) {
    Progress progress;
    CountedLoop outside(&progress, 3);
    outside.count();
    EXPECT_EQ(progress.fraction(), 0.0);
    CountedLoop nobody(nullptr, 3);
    nobody.count();
    CountedLoop none(&progress, 0);
    EXPECT_EQ(progress.fraction(), 0.0);
}

TEST(CountedLoop, CountsFromAnyThread) {
    Progress progress;
    progress.begin(0.0, 1.0, "all");
    CountedLoop counted(&progress, 4000, 1.0);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&] {
            for (int round = 0; round < 1000; ++round)
                counted.count();
        });
    }
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_NEAR(progress.fraction(), 1.0, 1e-12);
}

TEST(Progress, PartsTakeTheWholeOn) {
    Progress whole;
    whole.report(0.25, "all of it");
    Progress one(&whole, 0.25), other(&whole, 0.5);
    one.report(0.5, "one part");
    EXPECT_DOUBLE_EQ(whole.fraction(), 0.375);
    other.begin(0.0, 1.0, "another part");
    CountedLoop loop(&other, 2, 1.0);
    loop.count();
    EXPECT_DOUBLE_EQ(whole.fraction(), 0.625);
    one.report(0.25, nullptr);  // the whole does not go back
    EXPECT_DOUBLE_EQ(whole.fraction(), 0.625);
    one.report(1.0, nullptr);
    loop.count();
    EXPECT_DOUBLE_EQ(whole.fraction(), 1.0);
    EXPECT_EQ(whole.text(), "all of it");
}

TEST(Progress, PartsOfPartsTakeTheWholeOn) {
    Progress whole;
    Progress part(&whole, 0.5);
    Progress inner(&part, 0.5);
    inner.report(0.5, nullptr);
    EXPECT_DOUBLE_EQ(part.fraction(), 0.25);
    EXPECT_DOUBLE_EQ(whole.fraction(), 0.125);
}

TEST(Progress, APartIsCancelledWithTheWholeOrAlone) {
    Progress whole;
    Progress one(&whole, 0.5), other(&whole, 0.5);
    one.cancel();
    EXPECT_THROW(one.check(), Cancelled);
    EXPECT_NO_THROW(other.check());
    EXPECT_NO_THROW(whole.check());
    whole.cancel();
    EXPECT_THROW(other.check(), Cancelled);
    Progress unwatched(nullptr, 0.5);
    unwatched.report(1.0, "nobody hears of it");
    EXPECT_NO_THROW(unwatched.check());
}

}  // namespace
}  // namespace realmodel
