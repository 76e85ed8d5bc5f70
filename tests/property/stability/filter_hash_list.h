#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/filter/footprint_sampler.h"
#include "tests/property/stability/subjects.h"

namespace tessera::tests {

/// A footprint filter on texels, and the footprints that it averages.
struct HashedFilter {
    FootprintFilter filter;
    std::string of;  ///< "image" or "texture".
    std::shared_ptr<const TexelPages> pages;
};

/// Every filter that reports compare, on a stored image and on content exchange.
std::vector<HashedFilter> hashed_filters(const std::vector<Subject>& subjects);

/// A line of the list: filter, texels, and a hash over the bits of the colours of some dozen footprints, from
/// lines and needles to thousands of texels, also on both sides of 2^38.
std::string hash_line(const HashedFilter& filter);

}  // namespace tessera::tests
