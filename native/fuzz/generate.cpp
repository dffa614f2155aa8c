// SPDX-License-Identifier: GPL-3.0-or-later
#include "generate.hpp"

#include <algorithm>
#include <cmath>

#include "heights.hpp"
#include "placement.hpp"
#include "plans.hpp"

namespace realmodel::fuzz {

namespace {

using strata::Rule;

/// What a family leans on; numbers are probabilities.
struct Family {
    const char* name = "";
    std::vector<Plan> plans{Plan::kLattice, Plan::kScattered, Plan::kFan};  // of each surface
    double shared = 0.3;                                                    // all on one plan mesh
    std::vector<Height> heights{Height::kIntegers, Height::kPlane, Height::kFolded};
    std::vector<Place> places{Place::kLattice};
    int fewest = 2, most = 5;  // surfaces
    double partial = 0;        // a surface covers a part only
    double jumps = 0;
    double repeated = 0;  // takes over its predecessor's mesh, perhaps changed a little
    double ulp_heights = 0, ulp_plan = 0;
    double flat = 0;  // triangles without area
    double disorder = 0.3;
    double region = 0, base = 0.25;
    double apart = 0;  // moved aside by whole steps
    double rules = 0;
};

constexpr auto L = Plan::kLattice, S = Plan::kScattered, N = Plan::kNeedles, B = Plan::kBricks,
               G = Plan::kGiant, T = Plan::kTiny, F = Plan::kFan;
constexpr auto kAnywhere = {Place::kLattice, Place::kDecimal, Place::kUtm, Place::kRotated};

const std::vector<Family>& all_families() {
    using H = Height;
    static const std::vector<Family> families{
        {.name = "shared lattice", .plans = {L}, .shared = 1, .heights = {H::kIntegers}},
        {.name = "own lattices",
         .shared = 0,
         .heights = {H::kIntegers, H::kPlane, H::kFolded, H::kLevel}},
        {.name = "partial", .partial = 0.8},
        {.name = "jumps", .partial = 0.2, .jumps = 0.7},
        {.name = "coinciding",
         .heights = {H::kPlane, H::kLevel, H::kFolded},
         .partial = 0.3,
         .repeated = 0.5},
        {.name = "ulp apart",
         .heights = {H::kPlane, H::kDecimals, H::kRandom, H::kIntegers},
         .repeated = 0.7,
         .ulp_heights = 0.7},
        {.name = "ulp borders",
         .places = kAnywhere,
         .partial = 0.6,
         .repeated = 0.4,
         .ulp_plan = 0.7,
         .region = 0.4},
        {.name = "needles", .plans = {N, N, L}, .shared = 0.2, .partial = 0.2, .region = 0.2},
        {.name = "utm",
         .heights = {H::kDecimals, H::kIntegers, H::kPlane, H::kWaves},
         .places = {Place::kUtm, Place::kRotated},
         .partial = 0.2,
         .region = 0.2},
        {.name = "magnitudes",
         .heights = {H::kMagnitudes, H::kMagnitudes, H::kIntegers, H::kRandom},
         .partial = 0.2},
        {.name = "giant over tiny", .plans = {G, T, G, S}, .shared = 0, .partial = 0.1},
        {.name = "level over rough",
         .plans = {G, T, T},
         .shared = 0,
         .heights = {H::kLevel, H::kIntegers, H::kIntegers},
         .fewest = 2,
         .most = 4},
        {.name = "T-junctions", .plans = {B, B, L}, .partial = 0.2, .jumps = 0.2},
        {.name = "disorder", .partial = 0.3, .jumps = 0.3, .flat = 0.6, .disorder = 1},
        {.name = "regions", .partial = 0.2, .region = 1, .base = 0.5},
        {.name = "apart", .fewest = 1, .most = 4, .partial = 0.3, .base = 0.5, .apart = 0.8},
        {.name = "general",
         .heights = {H::kWaves, H::kRandom, H::kDecimals},
         .places = {Place::kDecimal, Place::kLattice},
         .region = 0.2},
        {.name = "rules", .most = 6, .partial = 0.3, .repeated = 0.2, .base = 0.5, .rules = 1},
        {.name = "rules in general",
         .heights = {H::kWaves, H::kRandom, H::kDecimals},
         .places = kAnywhere,
         .partial = 0.3,
         .jumps = 0.2,
         .region = 0.3,
         .base = 0.5,
         .rules = 1},
        {.name = "mixture",
         .plans = {L, G, S, F, B, N, T},
         .heights = {H::kPlane, H::kIntegers, H::kLevel, H::kFolded, H::kWaves, H::kDecimals,
                     H::kRandom, H::kMagnitudes},
         .places = kAnywhere,
         .fewest = 1,
         .most = 6,
         .partial = 0.3,
         .jumps = 0.2,
         .repeated = 0.3,
         .ulp_heights = 0.2,
         .ulp_plan = 0.2,
         .flat = 0.1,
         .region = 0.3,
         .apart = 0.1,
         .rules = 0.3}};
    return families;
}

/// Makes the surfaces of one rock mass.
class Maker {
public:
    Maker(RandomSource& random, const Family& family, int size, Place place)
        : random_(random), family_(family), size_(size), placement_(random, place) {
        heights_ = family.heights;
        if (place == Place::kUtm || place == Place::kRotated) {
            // slopes of 1e6 there: no double can say where such a plane lies
            std::erase(heights_, Height::kMagnitudes);
        }
        if (random.with(family.shared)) shared_ = plan();
    }

    RockCase rock() {
        RockCase rock;
        for (int k = random_.between(family_.fewest, family_.most); k > 0; --k) {
            Mesh surface = raw_surface();
            previous_ = surface;
            placement_.apply(surface);
            if (random_.with(family_.ulp_heights)) nudge_heights(random_, surface);
            if (random_.with(family_.ulp_plan)) nudge_plan(random_, surface);
            if (random_.with(family_.flat)) add_flat_triangles(random_, surface);
            if (random_.with(family_.disorder)) disorder(random_, surface);
            rock.surfaces.push_back(std::move(surface));
        }
        if (random_.with(family_.region)) rock.region = region();
        if (random_.with(family_.base)) rock.base_elevation = base_below(rock);
        if (random_.with(family_.rules)) {
            for (std::size_t k = 0; k < rock.surfaces.size(); ++k)
                rock.rules.push_back(static_cast<Rule>(random_.below(std::size(strata::kRules))));
        }
        return rock;
    }

private:
    PlanMesh plan() { return make_plan(random_, random_.one_of(family_.plans), size_); }

    /// In lattice coordinates.
    Mesh raw_surface() {
        if (!previous_.triangles.empty() && random_.with(family_.repeated))
            return changed_a_little();
        const PlanMesh mesh = shared_ ? *shared_ : plan();
        Mesh surface{{}, mesh.triangles};
        const HeightFunction z = make_height(random_, random_.one_of(heights_));
        for (const auto& [x, y] : mesh.vertices)
            surface.vertices.push_back({x, y, z(x, y)});
        if (random_.with(family_.apart)) {
            const double dx = random_.between(-size_, size_), dy = random_.between(-size_, size_);
            for (Point& p : surface.vertices)
                p = {p[0] + dx, p[1] + dy, p[2]};
        }
        if (random_.with(family_.partial)) surface.triangles = some_triangles(random_, mesh);
        if (random_.with(family_.jumps)) add_jumps(random_, surface);
        return surface;
    }

    Mesh changed_a_little() {
        Mesh surface = previous_;
        for (int i = random_.one_of({0, 0, 1, 3}); i > 0; --i)
            surface.vertices[random_.below(surface.vertices.size())][2] +=
                random_.one_of({-1, 1, 1, 2});
        if (random_.with(0.3)) {
            PlanMesh plan{{}, surface.triangles};
            for (const Point& p : surface.vertices)
                plan.vertices.push_back({p[0], p[1]});
            surface.triangles = some_triangles(random_, plan);
        }
        return surface;
    }

    /// Whole, concave, with holes, in parts, on the lattice or off.
    std::optional<PlanMesh> region() {
        const Plan kind = random_.one_of({L, S, F});
        PlanMesh mesh = shared_ && random_.with(0.3) ? *shared_ : make_plan(random_, kind, size_);
        if (random_.with(0.6)) mesh.triangles = some_triangles(random_, mesh);
        constexpr std::array<double, 2> kMoves[] = {
            {1, 0}, {1, 0}, {1, 0}, {0.75, 0.125}, {2, -0.5}, {0.3, 0.1}, {1, 1.0 / 3}};
        const auto [stretch, shift] = random_.one_of(kMoves);
        for (PlanPoint& p : mesh.vertices)
            p = {stretch * p[0] + shift, stretch * p[1] + shift};
        placement_.apply(mesh);
        if (random_.with(family_.ulp_plan)) {
            for (PlanPoint& p : mesh.vertices) {
                if (random_.with(0.3)) p[random_.below(2)] = nudged(random_, p[random_.below(2)]);
            }
        }
        return compacted(mesh);
    }

    /// Just below, a little below, or far.
    double base_below(const RockCase& rock) {
        double lowest = HUGE_VAL;
        for (const Mesh& surface : rock.surfaces) {
            for (const Point& p : surface.vertices)
                lowest = std::min(lowest, p[2]);
        }
        return random_.one_of({std::nextafter(lowest, -HUGE_VAL), lowest - 1, lowest - 1,
                               std::floor(lowest) - 2, lowest - 1e6});
    }

    RandomSource& random_;
    const Family& family_;
    int size_;
    Placement placement_;
    std::vector<Height> heights_;
    std::optional<PlanMesh> shared_;
    Mesh previous_;
};

/// Deals the triangles of a plan mesh out as regions.
std::vector<PlanMesh> dealt(RandomSource& random, int size) {
    const PlanMesh mesh = make_plan(random, random.one_of({L, S, F}), size);
    const int count = random.one_of({2, 2, 3});
    std::vector<PlanMesh> regions(static_cast<std::size_t>(count), {mesh.vertices, {}});
    std::vector<Triangle> first;
    const bool pieces = random.with(0.5);
    if (pieces) first = some_triangles(random, mesh);
    for (const Triangle& t : mesh.triangles) {
        const bool of_first = std::find(first.begin(), first.end(), t) != first.end();
        const int owner =
            !pieces ? random.between(0, count - 1) : (of_first ? 0 : random.between(1, count - 1));
        regions[static_cast<std::size_t>(owner)].triangles.push_back(t);
    }
    std::erase_if(regions, [](const PlanMesh& region) { return region.triangles.empty(); });
    for (PlanMesh& region : regions)
        region = compacted(region);
    return regions;
}

}  // namespace

std::vector<std::string> families() {
    std::vector<std::string> names;
    for (const Family& family : all_families())
        names.emplace_back(family.name);
    return names;
}

StackCase make_stack(RandomSource& random, std::size_t family, int smallest, int largest) {
    const Family& chosen = all_families()[family];
    const int size = random.between(smallest, largest);
    const Place place = random.one_of(chosen.places);
    return {{Maker(random, chosen, size, place).rock()}, chosen.name};
}

StackCase make_rock_masses(RandomSource& random, int largest) {
    // families that stay on the lattice
    constexpr std::size_t kStacks[] = {1, 2, 3, 4, 12, 14, 17};
    const int size = random.between(1, largest);
    StackCase stack{{}, "rock masses"};
    const auto rock = [&] {
        return Maker(random, all_families()[random.one_of(kStacks)], size, Place::kLattice).rock();
    };
    for (const PlanMesh& region : dealt(random, size)) {
        stack.rocks.push_back(rock());
        stack.rocks.back().region = region;
    }
    if (random.with(0.5)) {  // a neighbor whose one long edge faces several shorter ones
        RockCase beside = rock();
        const double low = size, high = 2.0 * size;
        for (Mesh& surface : beside.surfaces) {
            for (Point& p : surface.vertices)
                p[0] += low;
        }
        beside.region = {{{low, 0}, {high, 0}, {high, low}, {low, low}}, {{0, 1, 2}, {0, 2, 3}}};
        stack.rocks.push_back(std::move(beside));
    } else if (random.with(0.5)) {
        Placement(random, random.one_of({Place::kDecimal, Place::kUtm, Place::kRotated}))
            .apply(stack);
    }
    return stack;
}

}  // namespace realmodel::fuzz
