#include "server/prepare/judged_contents.h"

#include <algorithm>

#include "server/prepare/candidates.h"

namespace tessera {

JudgedContents::JudgedContents(const ExchangeAsset::Patch& earlier)
    : distance_{std::max(4, std::min(earlier.width, earlier.height) / 8)} {
    for (const auto& content : earlier.contents)
        if (content.standing != ExchangeAsset::Standing::chosen) judged_.push_back(content);
}

std::vector<ExchangeAsset::Content> JudgedContents::with(const std::vector<ShapedContent>& found,
                                                         std::int32_t wanted) const {
    using Standing = ExchangeAsset::Standing;
    std::vector<ExchangeAsset::Content> contents;
    const auto add_judged = [&](Standing standing) {
        std::ranges::copy_if(judged_, std::back_inserter(contents),
                             [&](const auto& content) { return content.standing == standing; });
    };
    add_judged(Standing::pinned);
    for (const ShapedContent& content : found) {
        if (std::ssize(contents) >= wanted) break;
        const bool is_known = std::ranges::any_of(
            judged_, [&](const auto& judged) { return !lie_apart(judged.at, content.at, distance_); });
        if (!is_known) contents.push_back({content.at, content.shape, Standing::chosen, 0});
    }
    add_judged(Standing::dropped);
    return contents;
}

}  // namespace tessera
