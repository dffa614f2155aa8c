// SPDX-License-Identifier: GPL-3.0-or-later
// Intersects random pairs of surfaces and judges what comes out; scripts/fuzz.sh runs it.
//
//   boolean_fuzzer [--cases N] [--seconds S] [--seed K] [--first N] [--corpus FOLDER]
//                  [--into FOLDER] [--patience S]
//   boolean_fuzzer FILE...       judges files of the corpus and makes those smaller that fail
//
// The cases of a seed are the same everywhere. Each is judged in a process of its own; a crash and
// a hang are findings too. Each finding is made small and written to a file in FOLDER; the exit
// status is 1 where there is one.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "boolean_cases.hpp"
#include "boolean_judge.hpp"
#include "case_file.hpp"
#include "examination.hpp"
#include "minimize.hpp"

namespace {

using namespace realmodel::fuzz;
using Clock = std::chrono::steady_clock;

struct Options {
    std::uint64_t cases = UINT64_MAX, seed = 1, first = 0;
    double seconds = 1e9, patience = 60;  // of one case, seconds of processors
    std::filesystem::path corpus, into = ".";
    std::vector<std::filesystem::path> files;
};

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

std::vector<Defect> judge(const StackCase& pair, const Options& options) {
    if (pair.rocks.size() != 1 || pair.rocks[0].surfaces.size() != 2 ||
        pair.rocks[0].surfaces[0].triangles.empty() || pair.rocks[0].surfaces[1].triangles.empty())
        return {};  // no pair of surfaces: the minimizer tries that
    return in_a_process([&] { return boolean_defects(pair, options.seed); }, options.patience);
}

/// Makes a case small and writes it.
void keep(StackCase pair, const std::string& kind, const std::string& name,
          const Options& options) {
    constexpr double kSecondsToMinimize = 120;
    const auto start = Clock::now();
    const auto fails = [&](const StackCase& candidate) {
        return seconds_since(start) < kSecondsToMinimize &&
               least_kind(judge(candidate, options)) == kind;
    };
    const StackCase small = minimized(std::move(pair), fails, 1500);
    std::string why;
    for (const Defect& defect : judge(small, options))
        why += (why.empty() ? "" : "; ") + defect.kind + ": " + defect.sentence;
    const std::string file = kind + "_" + name + ".json";
    write_case(small, options.into / file, why);
    std::printf("  %s: %zu triangles: %s\n", file.c_str(), triangle_count(small), why.c_str());
    std::fflush(stdout);
}

int hunt(const Options& options) {
    std::vector<StackCase> corpus;
    for (const auto& file : case_files(options.corpus))
        corpus.push_back(read_case(file));
    const auto start = Clock::now();
    std::map<std::string, int> known;
    std::uint64_t number = options.first;
    int findings = 0;
    for (; number < options.first + options.cases && seconds_since(start) < options.seconds;
         ++number) {
        const StackCase pair = boolean_case(options.seed, number, corpus);
        const std::vector<Defect> defects = judge(pair, options);
        if (defects.empty()) continue;
        const std::string kind = least_kind(defects);
        ++findings;
        if (++known[kind] > 3) continue;
        std::printf("seed %llu, case %llu (%s): %s: %s\n",
                    static_cast<unsigned long long>(options.seed),
                    static_cast<unsigned long long>(number), pair.label.c_str(), kind.c_str(),
                    defects[0].sentence.c_str());
        std::fflush(stdout);
        keep(pair, kind, "seed" + std::to_string(options.seed) + "_case" + std::to_string(number),
             options);
    }
    std::printf("seed %llu: %llu cases, %.1f s, %d findings\n",
                static_cast<unsigned long long>(options.seed),
                static_cast<unsigned long long>(number - options.first), seconds_since(start),
                findings);
    return findings > 0 ? 1 : 0;
}

int judge_files(const Options& options) {
    int failed = 0;
    for (const auto& file : options.files) {
        const StackCase pair = read_case(file);
        const std::vector<Defect> defects = judge(pair, options);
        for (const Defect& defect : defects)
            std::printf("%s: %s: %s\n", file.c_str(), defect.kind.c_str(), defect.sentence.c_str());
        if (defects.empty()) continue;
        ++failed;
        keep(pair, least_kind(defects), file.stem(), options);
    }
    std::printf("%zu files, %d failed\n", options.files.size(), failed);
    return failed > 0 ? 1 : 0;
}

int usage() {
    std::fputs(
        "usage: boolean_fuzzer [--cases N] [--seconds S] [--seed K] [--first N]\n"
        "                      [--corpus FOLDER] [--into FOLDER] [--patience S] [FILE...]\n",
        stderr);
    return 2;
}

}  // namespace

int main(int count, char** arguments) {
    setenv("OMP_WAIT_POLICY", "passive", 0);  // small surfaces on busy processors: no spinning
    Options options;
    for (int i = 1; i < count; ++i) {
        const std::string name = arguments[i];
        if (name.rfind("--", 0) != 0) {
            options.files.emplace_back(name);
            continue;
        }
        if (i + 1 == count) return usage();
        const char* value = arguments[++i];
        const auto whole = [&] { return std::strtoull(value, nullptr, 10); };
        if (name == "--cases") {
            options.cases = whole();
        } else if (name == "--seconds") {
            options.seconds = std::strtod(value, nullptr);
        } else if (name == "--seed") {
            options.seed = whole();
        } else if (name == "--first") {
            options.first = whole();
        } else if (name == "--corpus") {
            options.corpus = value;
        } else if (name == "--into") {
            options.into = value;
        } else if (name == "--patience") {
            options.patience = std::strtod(value, nullptr);
        } else {
            return usage();
        }
    }
    try {
        std::filesystem::create_directories(options.into);
        return options.files.empty() ? hunt(options) : judge_files(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "boolean_fuzzer: %s\n", error.what());
        return 2;
    }
}
