// SPDX-License-Identifier: GPL-3.0-or-later
// Builds random stacks and judges what comes out; scripts/fuzz.sh runs it.
//
//   stack_fuzzer [--cases N] [--seconds S] [--seed K] [--first N] [--corpus FOLDER] [--into FOLDER]
//                [--threads N,N...] [--polygons N] [--patience S] [--most N]
//   stack_fuzzer FILE...         judges files of the corpus and makes those smaller that fail
//
// The cases of a seed are the same everywhere. They are judged in a process of their own; a crash
// and a hang are findings too. Each finding is made small and written to a file in FOLDER; the exit
// status is 1 where there is one.
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <new>

#include "case_file.hpp"
#include "examination.hpp"
#include "minimize.hpp"
#include "mutate.hpp"

namespace {

using namespace realmodel::fuzz;
using Clock = std::chrono::steady_clock;

struct Options {
    std::uint64_t cases = UINT64_MAX, seed = 1, first = 0;
    double seconds = 1e9, patience = 120;  // of one case, seconds of processors
    std::filesystem::path corpus, into = ".";
    int most = 20;  // findings
    JudgeOptions judge;
    std::vector<std::filesystem::path> files;
};

/// What the process that judges tells the one that watches it.
struct Shared {
    std::atomic<std::uint64_t> number{0};   // of the case in work
    std::atomic<std::uint64_t> started{0};  // how many were begun
    std::atomic<std::uint64_t> built{0};
    std::atomic<std::uint64_t> triangles{0};
    std::atomic<bool> finding{false};  // it stopped at this case
};

volatile std::sig_atomic_t interrupted = 0;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

class Hunt {
public:
    explicit Hunt(const Options& options) : options_(options) {
        for (const auto& file : case_files(options.corpus))
            corpus_.push_back(read_case(file));
        void* memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE,
                            MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        if (memory == MAP_FAILED) throw std::runtime_error("no shared memory");
        shared_ = new (memory) Shared;
    }

    int run() {
        const auto start = Clock::now();
        std::uint64_t next = options_.first;
        int findings = 0;
        while (next < options_.first + options_.cases && findings < options_.most) {
            const std::string ended = judge_from(next, start);
            if (ended.empty()) break;
            next = shared_->number + 1;
            findings += report(shared_->number, ended) ? 1 : 0;
            if (seconds_since(start) > options_.seconds) break;
        }
        std::printf(
            "seed %llu: %llu cases, %llu built (%.1f triangles each), %.1f s, %d findings\n",
            static_cast<unsigned long long>(options_.seed),
            static_cast<unsigned long long>(shared_->started),
            static_cast<unsigned long long>(shared_->built),
            shared_->built > 0
                ? static_cast<double>(shared_->triangles) / static_cast<double>(shared_->built)
                : 0.0,
            seconds_since(start), findings);
        return findings > 0 ? 1 : 0;
    }

private:
    /// Judges cases in a child until one is wrong; "" where all were well, else how it ended.
    std::string judge_from(std::uint64_t next, Clock::time_point start) {
        shared_->finding = false;
        shared_->number = next;
        std::fflush(stdout);
        const pid_t child = fork();
        if (child < 0) throw std::runtime_error("no process");
        if (child == 0) judge_all(next, start);
        std::uint64_t seen = 0;
        auto changed = Clock::now();
        for (;;) {
            int status = 0;
            if (waitpid(child, &status, WNOHANG) == child) {
                if (shared_->finding) return "defect";
                if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
                return "crash";
            }
            if (shared_->started != seen) {
                seen = shared_->started;
                changed = Clock::now();
            }
            if (interrupted != 0 || seconds_since(changed) > options_.patience) {
                kill(child, SIGKILL);
                waitpid(child, &status, 0);
                return interrupted != 0 ? "" : "hang";
            }
            usleep(5000);
        }
    }

    [[noreturn]] void judge_all(std::uint64_t next, Clock::time_point start) {
        for (; next < options_.first + options_.cases; ++next) {
            if (seconds_since(start) > options_.seconds) break;
            shared_->number = next;
            ++shared_->started;
            const Examination found =
                examine(case_number(options_.seed, next, corpus_), options_.judge);
            if (found.usable) {
                ++shared_->built;
                shared_->triangles += triangle_count(found.stack);
            }
            if (!found.defects.empty()) {
                shared_->finding = true;
                break;
            }
        }
        _exit(0);
    }

    /// Makes a finding small and writes it; false where one of its kind and family is known.
    bool report(std::uint64_t number, const std::string& ended) {
        StackCase stack = case_number(options_.seed, number, corpus_);
        const std::vector<Defect> defects = examine_apart(stack, options_.judge, options_.patience);
        const std::string kind = defects.empty() ? ended + " once" : least_kind(defects);
        int& seen = known_[kind + ", " + stack.label];
        if (++seen > 1) return false;
        std::printf("seed %llu, case %llu (%s): %s: %s\n",
                    static_cast<unsigned long long>(options_.seed),
                    static_cast<unsigned long long>(number), stack.label.c_str(), kind.c_str(),
                    defects.empty() ? "" : defects[0].sentence.c_str());
        std::fflush(stdout);
        keep(std::move(stack), kind,
             "seed" + std::to_string(options_.seed) + "_case" + std::to_string(number));
        return true;
    }

    void keep(StackCase stack, const std::string& kind, const std::string& name) {
        constexpr double kSecondsToMinimize = 300;
        const auto start = Clock::now();
        const auto fails = [&](const StackCase& candidate) {
            return interrupted == 0 && seconds_since(start) < kSecondsToMinimize &&
                   least_kind(examine_apart(candidate, options_.judge, options_.patience)) == kind;
        };
        const StackCase small = minimized(std::move(stack), fails, 1500);
        std::string why;
        for (const Defect& defect : examine_apart(small, options_.judge, options_.patience))
            why += (why.empty() ? "" : "; ") + defect.kind + ": " + defect.sentence;
        std::string file = kind + "_" + name + ".json";
        for (char& c : file) {
            if (c == ' ' || c == '/' || c == ',') c = '_';
        }
        write_case(small, options_.into / file, why);
        std::printf("  %s: %zu rock masses, %zu surfaces, %zu triangles: %s\n", file.c_str(),
                    small.rocks.size(), surface_count(small), triangle_count(small), why.c_str());
        std::fflush(stdout);
    }

    friend int judge_files(const Options& options);

    const Options& options_;
    std::vector<StackCase> corpus_;
    Shared* shared_;
    std::map<std::string, int> known_;
};

int judge_files(const Options& options) {
    Hunt hunt(options);
    int failed = 0;
    for (const auto& file : options.files) {
        const StackCase stack = read_case(file);
        const std::vector<Defect> defects = examine_apart(stack, options.judge, options.patience);
        for (const Defect& defect : defects)
            std::printf("%s: %s: %s\n", file.c_str(), defect.kind.c_str(), defect.sentence.c_str());
        if (defects.empty()) continue;
        ++failed;
        hunt.keep(stack, least_kind(defects), file.stem());
    }
    std::printf("%zu files, %d failed\n", options.files.size(), failed);
    return failed > 0 ? 1 : 0;
}

/// Of "2,4".
std::vector<int> numbers_of(const char* list) {
    std::vector<int> numbers;
    for (char* end = nullptr; *list != '\0'; list = *end == ',' ? end + 1 : end) {
        numbers.push_back(static_cast<int>(std::strtol(list, &end, 10)));
        if (end == list) return {};
    }
    return numbers;
}

int usage() {
    std::fputs(
        "usage: stack_fuzzer [--cases N] [--seconds S] [--seed K] [--first N] [--corpus FOLDER]\n"
        "                    [--into FOLDER] [--threads N,N...] [--polygons N] [--patience S] "
        "[--most N]\n"
        "                    [FILE...]\n",
        stderr);
    return 2;
}

}  // namespace

int main(int count, char** arguments) {
    for (const int signal : {SIGINT, SIGTERM})  // the sum so far is told
        std::signal(signal, [](int) { interrupted = 1; });
    setenv("OMP_WAIT_POLICY", "passive", 0);  // small stacks on busy processors: no spinning
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
        } else if (name == "--threads") {
            options.judge.threads = numbers_of(value);
        } else if (name == "--polygons") {
            options.judge.most_polygons = whole();
        } else if (name == "--patience") {
            options.patience = std::strtod(value, nullptr);
        } else if (name == "--most") {
            options.most = static_cast<int>(whole());
        } else {
            return usage();
        }
    }
    try {
        std::filesystem::create_directories(options.into);
        return options.files.empty() ? Hunt(options).run() : judge_files(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "stack_fuzzer: %s\n", error.what());
        return 2;
    }
}
