#include "server/stream/page_message.h"

#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>

#include "proto/stream.pb.h"

#include "shared/page/parameter.h"

namespace tessera {
namespace {

using google::protobuf::internal::WireFormatLite;

void append_varint(std::string& bytes, std::uint64_t value) {
    std::uint8_t digits[10];
    const std::uint8_t* const end =
        google::protobuf::io::CodedOutputStream::WriteVarint64ToArray(value, digits);
    bytes.append(reinterpret_cast<const char*>(digits), static_cast<std::size_t>(end - digits));
}

void append_length(std::string& bytes, int field, std::uint64_t length) {
    append_varint(bytes, WireFormatLite::MakeTag(field, WireFormatLite::WIRETYPE_LENGTH_DELIMITED));
    append_varint(bytes, length);
}

void append_big_endian(std::string& bytes, std::uint64_t value) {
    for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(value >> shift & 0xff));
}

std::uint64_t big_endian(std::string_view bytes) {
    std::uint64_t value = 0;
    for (const char byte : bytes) value = value << 8 | static_cast<std::uint8_t>(byte);
    return value;
}

Error malformed(std::string why) { return {ErrorCode::malformed_request, std::move(why)}; }

}  // namespace

Result<PageOptions> page_options_of(const proto::StreamPageOptions& message) {
    PageOptions options;
    const auto format = message.format().empty() ? PageFormat::rgba : page_format(message.format());
    if (!format) return malformed("options.format: rgba, png, jpg or webp");
    options.format = *format;
    if (options.format == PageFormat::rgba && !message.plain()) options.coding = ContentCoding::zstd;
    if (message.gutter() > static_cast<std::uint32_t>(max_gutter_texels))
        return malformed("options.gutter: texels from 0 to " + std::to_string(max_gutter_texels));
    options.gutter = static_cast<std::uint8_t>(message.gutter());
    const auto accuracy = message.accuracy().empty() ? Accuracy::high : accuracy_named(message.accuracy());
    if (!accuracy) return malformed("options.accuracy: exact, high or fast");
    options.accuracy = *accuracy;
    if (message.has_max_error()) {
        const double codes = message.max_error();
        if (!(codes >= 0 && codes <= 255)) return malformed("options.max_error: 8-bit codes from 0 to 255");
        options.max_error = ErrorLimit{static_cast<std::uint32_t>(std::lround(codes * 1e6))};
        options.accuracy = Accuracy::high;
    }
    const auto channels =
        message.channels().empty() ? ChannelSet::albedo : channel_set_named(message.channels());
    if (!channels) return malformed("options.channels: albedo, normal, roughness, height or moments");
    options.channels = *channels;
    if (message.slice() < -max_slice || message.slice() > max_slice)
        return malformed("options.slice: an integer from -2^40 to 2^40");
    options.slice = message.slice();
    if (!(message.parameter() >= 0 && message.parameter() <= 1))
        return malformed("options.parameter: a number from 0 to 1");
    options.parameter = static_cast<std::int32_t>(message.parameter() * parameter_one);
    return options;
}

std::string tag_bytes(PageTag tag) {
    std::string bytes;
    append_big_endian(bytes, tag.id.high);
    if (!tag.half) append_big_endian(bytes, tag.id.low);
    return bytes;
}

std::optional<PageTag> read_tag(std::string_view bytes) {
    if (bytes.size() == 8) return PageTag{{big_endian(bytes), 0}, true};
    if (bytes.size() == 16) return PageTag{{big_endian(bytes.substr(0, 8)), big_endian(bytes.substr(8))}};
    return std::nullopt;
}

PageMessage page_message(const StreamPage& page) {
    proto::PageData data;
    data.set_id(page.id);
    if (!page.brief) {
        proto::StreamPageKey& key = *data.mutable_page();
        key.set_level(page.key.level);
        key.set_x(page.key.x);
        key.set_y(page.key.y);
        data.set_revision(page.revision);
    }
    data.set_scene_revision(page.scene_revision);
    data.set_tag(tag_bytes({page.tag, page.brief}));
    data.set_unchanged(page.unchanged);
    PageMessage message;
    if (page.page) {
        const Evaluation& evaluation = page.page->evaluation;
        if (evaluation.validity.from != always) data.set_from(evaluation.validity.from);
        if (evaluation.validity.until != never) data.set_until(evaluation.validity.until);
        if (!page.brief) {
            data.set_method(evaluation.method.data(), evaluation.method.size());
            data.set_bound_codes(evaluation.bound_codes);
            data.set_confidence(evaluation.confidence);
            data.set_cost(evaluation.work);
        }
        if (page.unchanged) {
        } else if (page.page->colour) {
            data.set_colour(*page.page->colour);
        } else {
            message.texels = *page.page->bytes;
        }
    }
    const std::string fields = data.SerializeAsString();
    std::string texels_head;
    if (!message.texels.empty())
        append_length(texels_head, proto::PageData::kTexelsFieldNumber, message.texels.size());
    append_length(message.head, proto::ServerMessage::kPageFieldNumber,
                  fields.size() + texels_head.size() + message.texels.size());
    message.head += fields;
    message.head += texels_head;
    return message;
}

}  // namespace tessera
