#pragma once

#include <string>
#include <vector>

#include "tests/property/stability/subjects.h"

namespace tessera::tests {

/// A region of a subject, and how it is asked for.
struct HashedPage {
    const Subject* subject = nullptr;
    TexelRegion region;
    Accuracy accuracy = Accuracy::high;
};

/// For each subject: a square at every level 0 to 30, in turn at the origin, across it, in the middle of
/// nowhere, on both sides of 2^38 and left of −2^38, in turn exact, high and fast; and a whole page with a
/// gutter. `subjects` outlives what is given back.
std::vector<HashedPage> hashed_pages(const std::vector<Subject>& subjects);

/// A line of the list: subject, region, accuracy, method, and a hash over the bits of the linear texels and
/// over the codes that are sent. Bounds are left out: they may take a logarithm from the C library.
std::string hash_line(const HashedPage& page);

}  // namespace tessera::tests
