// By-example textures against a cold memcpy of a page, one core.
//   build/release/bin/evaluate_bench [--level N] [ASSET…]
// prints for each method and level what one 256² RGBA page takes, what a cold memcpy of it takes, and their
// ratio; what interchangeable patches cost against content exchange; one isolated texel, and 512² texels.
// Returns 1 where a limit is missed, by however little. Without assets: made ones, content exchange of 64
// patches of 25 contents and 400 interchangeable patches, each on a 512² tile.
//
// Cold: both ends of the memcpy are memory that no cache holds, and so is the image that a page is evaluated
// into. What a page reads is as warm as a server has it that answers one page after the other from anywhere
// in the texture: what pages need again stays in the caches, if it is small enough. Memcpy and page take
// turns, so that whatever else the machine does slows down both; a ratio is the median of those of all pairs.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/scene/asset_file.h"
#include "server/texture/exchange.h"
#include "server/texture/kernels.h"
#include "shared/math/hash.h"
#include "tests/support/synthetic_asset.h"

namespace tessera {
namespace {

constexpr std::size_t page_bytes = 256 * 256 * 4;
constexpr int pairs = 401;
constexpr double finest_level_limit = 4, any_level_limit = 12, interchange_limit = 1.5;
constexpr double texel_limit_us = 0.5, square_limit_us = 1000;

int missed = 0;

/// Prints the end of a line: whether `value` keeps to its limit.
void hold(double value, double limit) {
    std::printf(" (at most %g%s)", limit, value > limit ? ": MISSED" : "");
    missed += value > limit ? 1 : 0;
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Of this thread's processor.
double thread_microseconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_nsec) / 1e3;
}

/// Microseconds that `run()` takes, without those of reading the clock.
template <class Run>
double time_of(const Run& run) {
    static const double clock = [] {
        double least = 1e9;
        for (int i = 0; i < 2000; ++i) {
            const double begun = thread_microseconds();
            least = std::min(least, thread_microseconds() - begun);
        }
        return least;
    }();
    const double begun = thread_microseconds();
    run();
    return thread_microseconds() - begun - clock;
}

/// Pages of memory, many times what caches hold, handed out in an order that no prefetcher guesses: none
/// before all others were.
class ColdPages {
  public:
    ColdPages() {
        for (int i = 0; i < count; ++i) {
            pages_.push_back({256, 256});
            std::fill(pages_.back().bytes.begin(), pages_.back().bytes.end(), std::uint8_t{1});
        }
    }
    Rgba8Image& next() { return pages_[static_cast<std::size_t>(next_++ * 197 % count)]; }

  private:
    static constexpr int count = 512;
    std::vector<Rgba8Image> pages_;
    int next_ = 0;
};

/// A page of a level that was not asked for yet: what a request that misses every cache costs.
TexelRegion fresh_page(std::uint8_t level) {
    static std::int64_t i = 0;
    const auto pages = std::uint32_t{1} << std::min(30 - level, 24);
    const auto at = [&](std::uint64_t axis) {
        return std::int64_t{uniform_below(hash(1, stream("bench page", axis), i, level), pages)} * 256;
    };
    ++i;
    return {level, at(0), at(1), 256, 256};
}

struct Measured {
    std::string name;
    std::shared_ptr<const Texture> texture;
};

[[noreturn]] void give_up(const std::string& why) {
    std::fprintf(stderr, "%s\n", why.c_str());
    std::exit(2);
}

void evaluate(const Texture& texture, const TexelRegion& region, Rgba8Image& out) {
    if (!texture.evaluate(region, Budget{}, out)) give_up("a page was not evaluated");
}

/// A bench refuses to time a wrong answer: the page must be the reduction of its children.
bool right(const Texture& texture, std::uint8_t level) {
    if (level == 0) return true;  // level 0 is what the others are held to
    const TexelRegion region{level, 3 * 256, 5 * 256, 64, 64};
    const TexelRegion children{static_cast<std::uint8_t>(level - 1), 6 * 256, 10 * 256, 128, 128};
    LinearImage page, below;
    if (!texture.evaluate(region, Budget{}, page) || !texture.evaluate(children, Budget{}, below))
        return false;
    for (std::int32_t y = 0; y < 64; ++y)
        for (std::int32_t x = 0; x < 64; ++x)
            for (std::int32_t c = 0; c < 3; ++c) {
                const float mean =
                    0.25F * (below.row(2 * y)[8 * x + c] + below.row(2 * y)[8 * x + 4 + c] +
                             below.row(2 * y + 1)[8 * x + c] + below.row(2 * y + 1)[8 * x + 4 + c]);
                if (std::abs(mean - page.row(y)[4 * x + c]) > 0.02 * code_in_linear) return false;
            }
    return true;
}

/// The pages of one level of all textures, each after a memcpy.
void measure_level(const std::vector<Measured>& textures, std::uint8_t level, ColdPages& from,
                   ColdPages& to) {
    struct Times {
        std::vector<double> copy, page, ratio, to_first;
    };
    std::vector<Times> times(textures.size());
    for (const Measured& one : textures)
        if (!right(*one.texture, level)) give_up(one.name + ": a page is not the reduction of its children");
    for (int pair = 0; pair < pairs; ++pair)
        for (std::size_t t = 0; t < textures.size(); ++t) {
            const Rgba8Image& source = from.next();
            Rgba8Image& copied = to.next();
            Rgba8Image& page = to.next();
            const TexelRegion region = fresh_page(level);
            const double copy =
                time_of([&] { std::memcpy(copied.bytes.data(), source.bytes.data(), page_bytes); });
            const double took = time_of([&] { evaluate(*textures[t].texture, region, page); });
            times[t].copy.push_back(copy);
            times[t].page.push_back(took);
            times[t].ratio.push_back(took / copy);
            times[t].to_first.push_back(took / times[0].page.back());
        }
    for (std::size_t t = 0; t < textures.size(); ++t) {
        const double copy = median(times[t].copy), page = median(times[t].page);
        const double ratio = median(times[t].ratio);
        const auto gigabytes = [](double us) { return double{page_bytes} / 1e3 / us; };
        std::printf("%-17s level %2d  memcpy %5.1f us %5.1f GB/s  page %6.1f us %5.1f GB/s  %5.2f x",
                    textures[t].name.c_str(), int{level}, copy, gigabytes(copy), page, gigabytes(page),
                    ratio);
        if (textures[t].name == "content_exchange")
            hold(ratio, level == 0 ? finest_level_limit : any_level_limit);
        if (t > 0) {
            const double to_first = median(times[t].to_first);
            std::printf("  %4.2f x %s", to_first, textures[0].name.c_str());
            if (textures[t].name == "interchange" && textures[0].name == "content_exchange")
                hold(to_first, interchange_limit);
        }
        std::printf("\n");
    }
}

/// Squares of level 0 anywhere: single texels, as rays need them, or many at once.
void measure_squares(const Measured& measured) {
    const auto squares = [&](std::int32_t side, int count) {
        Rgba8Image out;
        for (int i = 0; i < count; ++i) {
            TexelRegion region = fresh_page(0);
            region.x += i * 37 % 256;
            region.y += i * 101 % 256;
            region.width = region.height = side;
            evaluate(*measured.texture, region, out);
        }
    };
    // What texels need stays in the caches, as it does for a ray tracer that asks for millions of them
    std::vector<double> texel, square;
    squares(1, 20000);
    for (int i = 0; i < 21; ++i) texel.push_back(time_of([&] { squares(1, 1000); }) / 1000);
    for (int i = 0; i < 21; ++i) square.push_back(time_of([&] { squares(512, 5); }) / 5);
    std::printf("%-17s one texel %.2f us", measured.name.c_str(), median(texel));
    hold(median(texel), texel_limit_us);
    std::printf("  512 x 512 texels %.0f us", median(square));
    hold(median(square), square_limit_us);
    std::printf("\n");
}

std::vector<Measured> textures_of(const std::vector<std::string>& assets) {
    std::vector<Measured> textures;
    const auto add = [&](const ExchangeAsset& asset) {
        const auto made = make_exchange_texture(asset, {.seed = 1});
        textures.push_back({std::string{made->kind()}, made});
    };
    for (const std::string& folder : assets) {
        const auto asset = read_exchange_asset(folder);
        if (!asset) give_up(asset.error().detail);
        add(*asset);
    }
    if (!textures.empty()) return textures;
    add(tests::make_synthetic_asset({.tile_side = 512, .patches = 64, .contents = 25, .blend_texels = 4}));
    add(tests::make_synthetic_interchange({.tile_side = 512, .patches = 400, .blend_texels = 4}));
    return textures;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
    using namespace tessera;
    int only_level = -1;
    std::vector<std::string> assets;
    for (int i = 1; i < argc; ++i)
        if (std::string_view{argv[i]} == "--level" && i + 1 < argc)
            only_level = std::atoi(argv[++i]);
        else
            assets.push_back(argv[i]);
    const std::vector<Measured> textures = textures_of(assets);
    std::printf("kernels: %s\n", kernels().name);
    for (const Measured& one : textures) std::printf("%s", one.texture->description().c_str());
    ColdPages from, to;
    for (int level = 0; level <= 12; ++level)
        if (only_level < 0 || level == only_level)
            measure_level(textures, static_cast<std::uint8_t>(level), from, to);
    if (only_level < 0)
        for (const Measured& one : textures) measure_squares(one);
    std::printf(missed == 0 ? "All limits hold\n" : "%d limits missed\n", missed);
    return missed == 0 ? 0 : 1;
}
