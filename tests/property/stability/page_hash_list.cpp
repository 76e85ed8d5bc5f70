#include "tests/property/stability/page_hash_list.h"

#include <array>
#include <bit>
#include <stdexcept>

#include "tests/property/stability/bit_hash.h"
#include "tests/property/stability/places.h"

namespace tessera::tests {
std::vector<HashedPage> hashed_pages(const std::vector<Subject>& subjects) {
    std::vector<HashedPage> pages;
    for (std::size_t s = 0; s < subjects.size(); ++s) {
        const Subject& subject = subjects[s];
        for (std::uint8_t level = 0; level <= max_level; ++level) {
            // Five places and three accuracies: coprime, and begun elsewhere for each subject
            HashedPage page{&subject, region_at(level, (level + s) % 5, subject.side),
                            accuracies[(level + s) % accuracies.size()]};
            if (subject.has_slices) page.region.slice = level * 7 - 20;
            pages.push_back(page);
        }
        if (subject.side < 24)
            continue;  // Where a texel costs much, a page takes seconds without optimisation
        constexpr std::array<std::int32_t, 4> gutters{16, 1, 0, 4};
        constexpr std::array<std::uint8_t, 4> levels{0, 3, 7, 30};
        const std::uint8_t level = levels[s % 4];
        const std::uint32_t last = Extent{max_level}.side_pages(level) - 1;
        pages.push_back({&subject, region_of({level, last, last / 3}, gutters[s / 4 % 4]), Accuracy::high});
    }
    return pages;
}

std::string hash_line(const HashedPage& page) {
    const Budget budget{.accuracy = page.accuracy};
    LinearImage linear;
    Rgba8Image codes;
    const auto did = page.subject->texture->evaluate(page.region, budget, linear);
    if (!did || !page.subject->texture->evaluate(page.region, budget, codes))
        throw std::logic_error{page.subject->name + " could not be evaluated"};
    BitHash bits;
    for (const float value : linear.values) bits.add(std::bit_cast<std::uint32_t>(value));
    for (const std::uint8_t code : codes.bytes) bits.add(code);
    const TexelRegion& r = page.region;
    std::string line = page.subject->name;
    const auto add = [&](const std::string& word) { line.append(" ").append(word); };
    add("level " + std::to_string(r.level));
    add("at " + std::to_string(r.x) + "," + std::to_string(r.y));
    if (r.slice != 0) add("slice " + std::to_string(r.slice));
    add(std::to_string(r.width) + "x" + std::to_string(r.height));
    add(std::string{name_of(page.accuracy)});
    std::string method{did->method};
    for (char& c : method)
        if (c == ' ') c = '_';
    add(method);
    add(bits.text());
    return line;
}

}  // namespace tessera::tests
