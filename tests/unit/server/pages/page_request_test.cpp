#include "server/pages/page_request.h"

#include <set>

#include <gtest/gtest.h>

#include "tests/unit/server/pages/test_textures.h"

namespace tessera {
namespace {

TEST(PageId, DiffersInEverythingThatBytesDependOnAndInNothingElse) {
    const ScenePtr scene = test::make_scene("a", nullptr),
                   other = test::make_scene("a", nullptr, "fedcba9876543210");
    std::set<std::string> tags;
    std::size_t count = 0;
    const auto add = [&](const PageRequest& request) {
        tags.insert(etag_of(page_id(request)));
        ++count;
    };
    for (const ScenePtr& s : {scene, other})
        for (const PageKey key : {PageKey{0, 0, 0}, PageKey{1, 0, 0}, PageKey{0, 1, 0}, PageKey{0, 0, 1}})
            for (const PageFormat format : page_formats)
                for (const std::uint8_t gutter : std::initializer_list<std::uint8_t>{0, 1, 16})
                    for (const Accuracy accuracy : {Accuracy::exact, Accuracy::high, Accuracy::fast})
                        add({s, key, {format, ContentCoding::identity, gutter, accuracy}, {}});
    add({scene, {}, {PageFormat::rgba, ContentCoding::zstd, 0, Accuracy::high}, {}});
    for (const ChannelSet channels : channel_sets)
        if (channels != ChannelSet::albedo)
            add({scene, {}, {PageFormat::png, ContentCoding::identity, 0, Accuracy::high, channels}, {}});
    for (const std::int64_t slice : {std::int64_t{1}, std::int64_t{-1}, max_slice})
        add({scene,
             {},
             {PageFormat::png, ContentCoding::identity, 0, Accuracy::high, ChannelSet::albedo, slice},
             {}});
    for (const std::uint32_t millionths : {0u, 1u, 500'000u}) {
        PageRequest limited{scene, {}, {}, {}};
        limited.options.max_error = ErrorLimit{millionths};
        add(limited);
    }
    EXPECT_EQ(tags.size(), count);
    const PageRequest plain{scene, {}, {}, {}}, urgent{scene, {}, {}, {0}},
        renamed{test::make_scene("b", nullptr), {}, {}, {}};
    EXPECT_EQ(page_id(plain), page_id(urgent));
    EXPECT_EQ(page_id(plain), page_id(renamed));  // equal scenes share their pages
}

TEST(Etag, IsAQuotedStringOfThirtyTwoHexDigits) {
    const std::string tag = etag_of({0x0123456789abcdefu, 0xfedcba9876543210u});
    EXPECT_EQ(tag, "\"0123456789abcdeffedcba9876543210\"");
}

}  // namespace
}  // namespace tessera
