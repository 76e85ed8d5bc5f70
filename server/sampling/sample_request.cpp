#include "server/sampling/sample_request.h"

#include <cmath>
#include <string>

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/unknown_field_set.h>
#include <google/protobuf/wire_format_lite.h>

#include "proto/sample.pb.h"

#include "shared/math/footprint_from_rays.h"
#include "shared/page/page_key.h"
#include "shared/page/parameter.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedInputStream;

/// More than any footprint takes, and all the other fields together.
constexpr std::size_t max_field_bytes = 1024;

Error malformed(std::string why) { return {ErrorCode::malformed_request, std::move(why)}; }

bool has_unknown_fields(const google::protobuf::Message& message) {
    return !message.GetReflection()->GetUnknownFields(message).empty();
}

Result<Footprint> corners_of(const proto::FootprintCorners& corners) {
    if (has_unknown_fields(corners)) return malformed("corners: has a field that is not known here");
    if (corners.x_size() != 4)
        return malformed("corners.x: four numbers, not " + std::to_string(corners.x_size()));
    if (corners.y_size() != 4)
        return malformed("corners.y: four numbers, not " + std::to_string(corners.y_size()));
    Footprint footprint;
    for (int i = 0; i < 4; ++i) footprint.corners[static_cast<std::size_t>(i)] = {corners.x(i), corners.y(i)};
    return footprint;
}

Result<Footprint> axes_of(const proto::FootprintAxes& axes) {
    if (has_unknown_fields(axes)) return malformed("axes: has a field that is not known here");
    const struct {
        const char* name;
        double value;
    } numbers[] = {{"x", axes.x()},
                   {"y", axes.y()},
                   {"along_x", axes.along_x()},
                   {"along_y", axes.along_y()},
                   {"across_x", axes.across_x()},
                   {"across_y", axes.across_y()}};
    for (const auto& [name, value] : numbers)
        if (!std::isfinite(value)) return malformed(std::string{"axes."} + name + ": is not a finite number");
    return footprint_around(0, 0, {axes.x(), axes.y()}, {axes.along_x(), axes.along_y()},
                            {axes.across_x(), axes.across_y()});
}

Result<Footprint> seen_by(const proto::FootprintRays& rays) {
    if (has_unknown_fields(rays)) return malformed("rays: has a field that is not known here");
    std::optional<Error> wrong;
    const auto vector = [&](const char* name, const google::protobuf::RepeatedField<double>& numbers,
                            bool needed) -> WorldVector {
        if (numbers.empty() && !needed) return {};
        if (numbers.size() == 3) return {numbers[0], numbers[1], numbers[2]};
        if (!wrong)
            wrong = malformed(std::string{"rays."} + name + ": three numbers, not " +
                              std::to_string(numbers.size()));
        return {};
    };
    RayDifferentials seen{};
    seen.origin = vector("origin", rays.origin(), true);
    seen.direction = vector("direction", rays.direction(), true);
    seen.direction_dx = vector("direction_dx", rays.direction_dx(), false);
    seen.direction_dy = vector("direction_dy", rays.direction_dy(), false);
    seen.origin_dx = vector("origin_dx", rays.origin_dx(), false);
    seen.origin_dy = vector("origin_dy", rays.origin_dy(), false);
    TexturedPlane plane{};
    plane.point = vector("point", rays.point(), true);
    plane.per_s = vector("per_s", rays.per_s(), true);
    plane.per_t = vector("per_t", rays.per_t(), true);
    plane.texel = {rays.s(), rays.t()};
    if (wrong) return *wrong;
    const auto footprint = footprint_from_rays(seen, plane);
    if (!footprint) return malformed("rays." + footprint.error().detail);
    return footprint;
}

Result<Footprint> footprint_of(const proto::SampleFootprint& given) {
    if (has_unknown_fields(given)) return malformed("has a field that is not known here");
    Result<Footprint> shape = malformed("has no shape; give axes, corners or rays");
    const char* name = "";
    switch (given.shape_case()) {
        case proto::SampleFootprint::kAxes:
            name = "axes: ";
            shape = axes_of(given.axes());
            break;
        case proto::SampleFootprint::kCorners:
            name = "corners: ";
            shape = corners_of(given.corners());
            break;
        case proto::SampleFootprint::kRays:
            name = "rays: ";
            shape = seen_by(given.rays());
            break;
        case proto::SampleFootprint::SHAPE_NOT_SET:
            break;
    }
    if (!shape) return shape;
    shape->x = given.origin_x();
    shape->y = given.origin_y();
    const auto within = [](std::int64_t v) {
        return v >= -max_footprint_origin && v <= max_footprint_origin;
    };
    if (!within(shape->x)) return malformed("origin_x: lies beyond ±2^40 texels");
    if (!within(shape->y)) return malformed("origin_y: lies beyond ±2^40 texels");
    if (const auto good = check_footprint(*shape); !good) return malformed(name + good.error().detail);
    return shape;
}

Result<void> read_choices(const proto::SampleRequest& given, SampleRequest& request) {
    if (has_unknown_fields(given)) return malformed("the request has a field that is not known here");
    if (!given.filter().empty()) {
        request.filter = filter_named(given.filter());
        if (!request.filter)
            return malformed("filter: there is no \"" + given.filter() +
                             "\"; take exact, line-integral, anisotropic-16, trilinear or the like, or leave "
                             "it out for the cheapest that meets the budget");
        if (given.has_max_error()) return malformed("max_error: chooses the filter; give one of the two");
    }
    if (!given.accuracy().empty()) {
        const auto accuracy = accuracy_named(given.accuracy());
        if (!accuracy) return malformed("accuracy: exact, high or fast");
        request.accuracy = *accuracy;
    }
    if (given.has_max_error()) {
        if (!(given.max_error() >= 0 && given.max_error() <= 255))
            return malformed("max_error: 8-bit codes from 0 to 255, such as 0.5");
        request.max_error = given.max_error();
    }
    if (!given.channels().empty()) {
        const auto channels = channel_set_named(given.channels());
        if (!channels) return malformed("channels: albedo, normal, roughness, height or moments");
        request.channels = *channels;
    }
    if (given.slice() < -max_slice || given.slice() > max_slice)
        return malformed("slice: an integer from -2^40 to 2^40");
    request.slice = given.slice();
    if (given.step() < -max_step || given.step() > max_step)
        return malformed("step: an integer from -2^62 to 2^62");
    if (!(given.parameter() >= 0 && given.parameter() <= 1))
        return malformed("parameter: a number from 0 to 1");
    request.time = {given.step(), static_cast<std::int32_t>(given.parameter() * parameter_one)};
    return {};
}

Result<SampleRequest> read_protobuf(std::string_view body) {
    const Error broken = malformed("the body is no protobuf message SampleRequest");
    CodedInputStream in{reinterpret_cast<const std::uint8_t*>(body.data()), static_cast<int>(body.size())};
    SampleRequest request;
    std::string choices;
    proto::SampleFootprint footprint;
    constexpr std::uint32_t footprint_tag = WireFormatLite::MakeTag(
        proto::SampleRequest::kFootprintsFieldNumber, WireFormatLite::WIRETYPE_LENGTH_DELIMITED);
    for (;;) {
        const int begin = in.CurrentPosition();
        const std::uint32_t tag = in.ReadTag();
        if (tag == 0) {
            if (!in.ConsumedEntireMessage()) return broken;
            break;
        }
        if (tag != footprint_tag) {
            if (!WireFormatLite::SkipField(&in, tag)) return broken;
            choices.append(body.substr(static_cast<std::size_t>(begin),
                                       static_cast<std::size_t>(in.CurrentPosition() - begin)));
            if (choices.size() > max_field_bytes)
                return malformed("the fields beside the footprints take more than " +
                                 std::to_string(max_field_bytes) + " bytes");
            continue;
        }
        std::uint32_t size = 0;
        const void* bytes = nullptr;
        int left = 0;
        if (!in.ReadVarint32(&size)) return broken;
        const std::string where = "footprints[" + std::to_string(request.footprints.size()) + "]";
        if (size == 0) {
            footprint.Clear();
        } else {
            if (!in.GetDirectBufferPointer(&bytes, &left) || static_cast<std::uint32_t>(left) < size)
                return broken;
            if (size > max_field_bytes)
                return malformed(where + ": takes more than " + std::to_string(max_field_bytes) + " bytes");
            if (!footprint.ParseFromArray(bytes, static_cast<int>(size)))
                return malformed(where + ": is no protobuf message SampleFootprint");
            in.Skip(static_cast<int>(size));
        }
        if (request.footprints.size() == max_sample_footprints)
            return malformed("footprints: more than " + std::to_string(max_sample_footprints) +
                             "; send them in several requests");
        const auto read = footprint_of(footprint);
        if (!read) {
            const std::string& why = read.error().detail;
            return malformed(where + (why.starts_with("has ") ? " " : ".") + why);
        }
        request.footprints.push_back(*read);
    }
    proto::SampleRequest given;
    if (!given.ParseFromString(choices)) return broken;
    if (const auto good = read_choices(given, request); !good) return good.error();
    if (request.footprints.empty()) return malformed("footprints: there are none");
    return request;
}

}  // namespace

std::string_view content_type(WireCoding coding) noexcept {
    return coding == WireCoding::json ? "application/json" : "application/x-protobuf";
}

Result<SampleRequest> read_sample_request(std::string_view body, WireCoding coding) {
    if (coding == WireCoding::protobuf) return read_protobuf(body);
    // JSON becomes the binary form, at most some four times as long: one reader checks both
    const auto binary = json_to_binary(body, proto::SampleRequest::descriptor()->full_name());
    if (!binary) return malformed(binary.error().detail);
    return read_protobuf(*binary);
}

}  // namespace tessera
