#include "tests/property/stability/filter_hash_list.h"

#include <bit>
#include <stdexcept>

#include "shared/math/hash.h"
#include "tests/property/stability/bit_hash.h"

namespace tessera::tests {
namespace {

/// −1 to 1, in steps of 2^−20: nothing that a C library could round otherwise.
double drawn(std::int64_t i, std::int64_t what) {
    return static_cast<double>(hash(8, stream("footprints"), i, what) >> 43) / (1 << 20) - 1;
}

std::vector<Footprint> footprints() {
    constexpr std::int64_t far = std::int64_t{1} << 38;
    constexpr std::int64_t origins[]{0, -300, far - 1, -far, 255, 1234567891};
    std::vector<Footprint> all;
    for (std::int64_t i = 0; i < 24; ++i) {
        // Sides from 2^-4 to 2^7 texels, the other one down to a 2^20th of it, or none
        const double side = static_cast<double>(std::int64_t{1} << (i % 12)) / 16;
        const double ratio = i % 8 == 7 ? 0 : 1.0 / static_cast<double>(std::int64_t{1} << (i * 5 % 21));
        const TexelPoint along{drawn(i, 0) * side, drawn(i, 1) * side};
        const TexelPoint across{(-along.y + drawn(i, 2) * along.x / 4) * ratio,
                                (along.x + drawn(i, 2) * along.y / 4) * ratio};
        Footprint f = footprint_around(origins[i % 6], origins[i / 6 % 6], {drawn(i, 3) * 9, drawn(i, 4) * 9},
                                       along, across);
        if (i % 5 == 4) f.corners[0] = f.corners[1];  // A triangle
        if (check_footprint(f)) all.push_back(f);
    }
    return all;
}

}  // namespace

std::vector<HashedFilter> hashed_filters(const std::vector<Subject>& subjects) {
    LinearImage image{57, 64};
    for (std::size_t i = 0; i < image.values.size(); ++i)
        image.values[i] =
            static_cast<float>(hash(9, stream("image"), static_cast<std::int64_t>(i), 0) >> 48) / 65535.0F;
    std::shared_ptr<const Texture> texture;
    for (const Subject& subject : subjects)
        if (subject.name == "content_exchange_100_patches") texture = subject.texture;
    if (texture == nullptr) throw std::logic_error{"no texture to filter"};
    std::vector<HashedFilter> all;
    for (const auto& [of, pages] :
         {std::pair{"image", pages_of_image(image, Beyond::repeat)},
          std::pair{"texture", pages_of_texture(texture, Accuracy::exact, std::size_t{64} << 20)}})
        for (const FootprintFilter& filter : compared_filters()) all.push_back({filter, of, pages});
    return all;
}

std::string hash_line(const HashedFilter& hashed) {
    const std::vector<Footprint> asked = footprints();
    std::vector<FilteredSample> samples(asked.size());
    const auto sampler = make_sampler(hashed.filter, hashed.pages);
    if (const auto said = sampler->sample(asked, {}, samples); !said)
        throw std::logic_error{said.error().detail};
    BitHash bits;
    for (const FilteredSample& sample : samples)
        for (const float value : sample.color) bits.add(std::bit_cast<std::uint32_t>(value));
    return "filter " + name_of(hashed.filter) + " of " + hashed.of + " " + std::to_string(asked.size()) +
           " footprints " + bits.text();
}

}  // namespace tessera::tests
