#include "server/stream/page_message.h"

#include <limits>

#include <gtest/gtest.h>

#include "proto/stream.pb.h"

namespace tessera {
namespace {

StreamPage made_page(std::size_t bytes) {
    auto page = std::make_shared<EncodedPage>();
    EncodedBytes texels(bytes);
    for (std::size_t i = 0; i < bytes; ++i) texels[i] = static_cast<std::uint8_t>(i * 7);
    page->bytes = std::make_shared<const EncodedBytes>(std::move(texels));
    page->evaluation = {"stamps", 0.25, 0.5, 77, {5, 9}};
    return {.id = 3,
            .key = {4, 5, 6},
            .tag = {0x0123456789abcdef, 0xfedcba9876543210},
            .revision = 8,
            .scene_revision = 9,
            .page = std::move(page)};
}

proto::PageData read(const PageMessage& message) {
    std::string bytes = message.head;
    bytes.append(reinterpret_cast<const char*>(message.texels.data()), message.texels.size());
    proto::ServerMessage whole;
    EXPECT_TRUE(whole.ParseFromString(bytes));
    EXPECT_EQ(whole.message_case(), proto::ServerMessage::kPage);
    return whole.page();
}

TEST(PageMessage, IsReadByWhoeverReadsProtobuf) {
    for (const std::size_t bytes : {1u, 127u, 128u, 70'000u, 300'000u}) {
        const StreamPage page = made_page(bytes);
        const proto::PageData data = read(page_message(page));
        EXPECT_EQ(data.id(), 3u);
        EXPECT_EQ(data.page().level(), 4u);
        EXPECT_EQ(data.page().x(), 5);
        EXPECT_EQ(data.page().y(), 6);
        EXPECT_EQ(data.revision(), 8u);
        EXPECT_EQ(data.scene_revision(), 9u);
        EXPECT_EQ(data.from(), 5);
        EXPECT_EQ(data.until(), 9);
        EXPECT_EQ(data.method(), "stamps");
        EXPECT_EQ(data.bound_codes(), 0.25);
        EXPECT_EQ(data.confidence(), 0.5);
        EXPECT_EQ(data.cost(), 77u);
        const auto tag = read_tag(data.tag());
        ASSERT_TRUE(tag);
        EXPECT_EQ(tag->id, page.tag);
        EXPECT_EQ(data.texels(), std::string(page.page->bytes->begin(), page.page->bytes->end()));
    }
}

TEST(PageMessage, OfAPageThatTheClientHasCarriesNoTexels) {
    StreamPage page = made_page(1000);
    page.unchanged = true;
    const proto::PageData data = read(page_message(page));
    EXPECT_TRUE(data.unchanged());
    EXPECT_TRUE(data.texels().empty());
    EXPECT_EQ(data.until(), 9);
    page.page = nullptr;  // it is not even in the cache
    EXPECT_TRUE(read(page_message(page)).unchanged());
}

TEST(PageMessage, OfOneColourCarriesTheColour) {
    StreamPage page = made_page(1000);
    auto one = std::make_shared<EncodedPage>(*page.page);
    one->colour = 0x80402010u;
    one->evaluation.validity = {};
    page.page = one;
    const PageMessage message = page_message(page);
    EXPECT_TRUE(message.texels.empty());
    const proto::PageData data = read(message);
    EXPECT_EQ(data.colour(), 0x80402010u);
    EXPECT_FALSE(data.has_from());
    EXPECT_FALSE(data.has_until());
}

TEST(PageOptions, AreThoseOfAnAddress) {
    proto::StreamPageOptions message;
    auto options = page_options_of(message);
    ASSERT_TRUE(options);
    EXPECT_EQ(options->format, PageFormat::rgba);
    EXPECT_EQ(options->coding, ContentCoding::zstd);
    message.set_plain(true);
    message.set_gutter(2);
    message.set_max_error(0.5);
    message.set_accuracy("fast");
    message.set_parameter(0.25);
    options = page_options_of(message);
    ASSERT_TRUE(options);
    EXPECT_EQ(options->coding, ContentCoding::identity);
    EXPECT_EQ(options->gutter, 2);
    EXPECT_EQ(options->parameter, 16384);
    EXPECT_EQ(options->max_error->millionths, 500'000u);
    EXPECT_EQ(options->accuracy, Accuracy::high) << "a limit goes before it";

    const auto refused = [](auto change, const char* field) {
        proto::StreamPageOptions wrong;
        change(wrong);
        const auto read = page_options_of(wrong);
        ASSERT_FALSE(read) << field;
        EXPECT_EQ(read.error().detail.rfind(std::string{"options."} + field, 0), 0u) << read.error().detail;
    };
    refused([](auto& wrong) { wrong.set_format("bmp"); }, "format");
    refused([](auto& wrong) { wrong.set_gutter(17); }, "gutter");
    refused([](auto& wrong) { wrong.set_accuracy("best"); }, "accuracy");
    refused([](auto& wrong) { wrong.set_max_error(std::numeric_limits<double>::quiet_NaN()); }, "max_error");
    refused([](auto& wrong) { wrong.set_max_error(-1); }, "max_error");
    refused([](auto& wrong) { wrong.set_channels("colour"); }, "channels");
    refused([](auto& wrong) { wrong.set_parameter(1.5); }, "parameter");
    refused([](auto& wrong) { wrong.set_slice(max_slice + 1); }, "slice");
}

TEST(PageMessage, ThatIsBriefTakesLittleMoreThanItsTexels) {
    StreamPage page = made_page(60'000);
    page.brief = true;
    page.id = 100'000;
    page.revision = page.scene_revision = 1'000'000;
    auto still = std::make_shared<EncodedPage>(*page.page);
    still->evaluation.validity = {};
    page.page = still;
    const PageMessage message = page_message(page);
    EXPECT_LE(message.head.size() + 4, 32u) << "with the WebSocket's header";
    const proto::PageData data = read(message);
    EXPECT_EQ(data.id(), 100'000u);
    EXPECT_EQ(data.texels().size(), 60'000u);
    const auto tag = read_tag(data.tag());
    ASSERT_TRUE(tag);
    EXPECT_TRUE(tag->names(page.tag));
    EXPECT_FALSE(tag->names({page.tag.high + 1, page.tag.low}));
}

TEST(PageTag, OfAnotherLengthIsNone) {
    for (const std::size_t length : {0u, 5u, 15u, 17u}) EXPECT_FALSE(read_tag(std::string(length, 'x')));
}

}  // namespace
}  // namespace tessera
