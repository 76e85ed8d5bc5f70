#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tessera {

/// How many letters of `a` must be changed, put in or left out to make it `b` (Levenshtein's distance).
inline std::size_t letters_between(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i + 1);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

/// Which of `names` was probably meant by what somebody wrote; empty where none is close. What is written may
/// be long: only so much of it is compared.
inline std::string nearest_name(std::string_view written, const std::vector<std::string>& names) {
    written = written.substr(0, 64);
    std::size_t fewest = std::max<std::size_t>(2, written.size() / 3) + 1;
    std::string nearest;
    for (const std::string& name : names) {
        const std::size_t letters = letters_between(written, name);
        if (letters >= std::min(fewest, name.size())) continue;
        fewest = letters;
        nearest = name;
    }
    return nearest;
}

}  // namespace tessera
