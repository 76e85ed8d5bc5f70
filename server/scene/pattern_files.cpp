#include "server/scene/pattern_files.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "server/scene/compile_exchange.h"
#include "server/scene/image_file.h"
#include "server/scene/scene_path.h"

namespace tessera {
namespace {

constexpr const char* how_to_raise = ", or name fewer images in the scene";

Error invalid(const std::string& field, const std::string& what) {
    return {ErrorCode::invalid_input, field + ": " + what};
}

Error at(const std::string& field, const Error& error) { return {error.code, field + ": " + error.detail}; }

std::string size_of(const StraightRgba8Image& image) {
    return std::to_string(image.width) + "×" + std::to_string(image.height);
}

bool is_side(std::int64_t side) {
    return side >= 1 && side <= PatternFiles::max_side &&
           std::has_single_bit(static_cast<std::uint64_t>(side));
}

/// The set with what is unset filled in, as far as it can be said without its images.
struct Numbers {
    std::int64_t side = 0;   ///< 0: not said.
    std::int64_t count = 0;  ///< 0: all.
    std::int64_t slices = 1;
};

Result<Numbers> numbers_of(const std::string& field, const proto::PatternSet& set) {
    if (set.side_texels() != 0 && !is_side(set.side_texels()))
        return invalid(field + ".side_texels",
                       "is " + std::to_string(set.side_texels()) + "; a power of two from 1 to 1024");
    if (set.slices() > PatternFiles::max_slices)
        return invalid(field + ".slices", "is " + std::to_string(set.slices()) + "; at most 1024");
    if (set.count() > PatternFiles::max_patterns)
        return invalid(field + ".count", "is " + std::to_string(set.count()) + "; at most 65536");
    return Numbers{set.side_texels(), set.count(), std::max<std::int64_t>(1, set.slices())};
}

/// How many patterns `room` images make: as many as were asked for, or all.
Result<std::int32_t> count_of(const std::string& field, const Numbers& numbers, std::int64_t room,
                              const std::string& where) {
    const std::int64_t whole = room / numbers.slices;
    const std::string has = where + " has room for " + std::to_string(room) + " images";
    const std::string each =
        numbers.slices == 1 ? "" : " of " + std::to_string(numbers.slices) + " slices each";
    if (whole < 1) return invalid(field + ".slices", "is " + std::to_string(numbers.slices) + ", but " + has);
    if (numbers.count > whole)
        return invalid(field + ".count", "is " + std::to_string(numbers.count) + each + ", but " + has);
    if (numbers.count == 0 && whole > std::int64_t{PatternFiles::max_patterns})
        return invalid(field, "has " + std::to_string(whole) + " patterns; at most 65536");
    return static_cast<std::int32_t>(numbers.count == 0 ? whole : numbers.count);
}

PatternImages make_images(std::int64_t side, std::int32_t count, std::int64_t slices) {
    PatternImages images{static_cast<std::int32_t>(side), count, static_cast<std::int32_t>(slices), {}};
    images.codes.resize(std::size_t(count) * std::size_t(slices) * std::size_t(side) * std::size_t(side) * 4);
    return images;
}

}  // namespace

std::int64_t PatternFiles::texels_left(std::size_t bytes_each) const noexcept {
    return std::min(ImageLimits{}.max_texels, static_cast<std::int64_t>(bytes_left_ / bytes_each));
}

Result<PatternImages> PatternFiles::read_patterns(const std::string& field, const proto::PatternSet& set) {
    if (set.image().empty() == set.files().empty())
        return invalid(field, "give it one of image (all patterns in one) and files (one for each)");
    return set.files().empty() ? read_sheet(field, set) : read_files(field, set);
}

Result<PatternImages> PatternFiles::read_sheet(const std::string& field, const proto::PatternSet& set) {
    const std::string image_field = field + ".image";
    const auto numbers = numbers_of(field, set);
    if (!numbers) return numbers.error();
    const auto file = path_inside(folder_, image_field, set.image(), "image");
    if (!file) return file.error();
    const auto sheet = read_rgba_image(*file, {.max_texels = texels_left(4), .how_to_raise = how_to_raise});
    if (!sheet) return at(image_field, sheet.error());
    const std::string its = "\"" + set.image() + "\", which is " + size_of(*sheet) + ",";

    const std::int64_t side = numbers->side != 0 ? numbers->side : sheet->height;
    if (!is_side(side))
        return invalid(field + ".side_texels",
                       "is unset, and the height of " + its +
                           " is no power of two up to 1024; say how large a pattern is");
    if (sheet->width % side != 0 || sheet->height % side != 0)
        return invalid(image_field, its + " holds no whole number of patterns of " + std::to_string(side) +
                                        " texels a side; cut it, or change side_texels");
    const std::int64_t columns = sheet->width / side;
    const auto count = count_of(field, *numbers, columns * (sheet->height / side), its);
    if (!count) return count.error();

    PatternImages images = make_images(side, *count, numbers->slices);
    const std::size_t row_bytes = std::size_t(side) * 4;
    std::uint8_t* out = images.codes.data();
    for (std::int64_t i = 0; i < *count * numbers->slices; ++i) {
        const std::uint8_t* from =
            sheet->bytes.data() + (i / columns * side * sheet->width + i % columns * side) * 4;
        for (std::int64_t y = 0; y < side; ++y, out += row_bytes, from += std::size_t(sheet->width) * 4)
            std::memcpy(out, from, row_bytes);
    }
    bytes_left_ -= images.codes.size();
    return images;
}

Result<PatternImages> PatternFiles::read_files(const std::string& field, const proto::PatternSet& set) {
    const auto numbers = numbers_of(field, set);
    if (!numbers) return numbers.error();
    const std::string files_field = field + ".files";
    if (set.files_size() > static_cast<int>(max_patterns))
        return invalid(files_field, "has " + std::to_string(set.files_size()) +
                                        " files; at most 65536, or pack them in one image");
    if (set.files_size() % numbers->slices != 0)
        return invalid(files_field, "has " + std::to_string(set.files_size()) +
                                        " files, which are no multiple of the slices of a pattern, " +
                                        std::to_string(numbers->slices));
    const auto count = count_of(field, *numbers, set.files_size(), "files");
    if (!count) return count.error();

    PatternImages images;
    const std::int64_t used = *count * numbers->slices;
    for (std::int64_t i = 0; i < used; ++i) {
        const std::string& name = set.files(static_cast<int>(i));
        const std::string file_field = files_field + "[" + std::to_string(i) + "]";
        const auto file = path_inside(folder_, file_field, name, "image");
        if (!file) return file.error();
        const auto image = read_rgba_image(
            *file, {.max_texels = texels_left(4), .max_side = max_side, .how_to_raise = how_to_raise});
        if (!image) return at(file_field, image.error());
        const std::string its = "\"" + name + "\" is " + size_of(*image);
        if (i == 0) {
            const std::int64_t side = numbers->side != 0 ? numbers->side : image->width;
            if (!is_side(side) || image->width != image->height)
                return invalid(file_field, its + "; a pattern is a square whose side is a power of two");
            // Known before the others are read
            const std::int64_t texels = side * side * used;
            if (texels > texels_left(4))
                return invalid(files_field, std::to_string(used) + " images of " + std::to_string(side) +
                                                "×" + std::to_string(side) +
                                                " texels are more than the limit of " +
                                                std::to_string(texels_left(4)) + " texels" + how_to_raise);
            images = make_images(side, *count, numbers->slices);
        }
        if (image->width != images.side || image->height != images.side)
            return invalid(file_field, its + "; the patterns of this set are " + std::to_string(images.side) +
                                           "×" + std::to_string(images.side));
        std::memcpy(images.codes.data() + std::size_t(i) * image->bytes.size(), image->bytes.data(),
                    image->bytes.size());
    }
    bytes_left_ -= images.codes.size();
    return images;
}

Result<StoredMap> PatternFiles::read_map(const std::string& field, const std::string& image) {
    const auto file = path_inside(folder_, field, image, "image");
    if (!file) return file.error();
    const auto labels = read_label_image(
        *file, {.max_texels = texels_left(sizeof(std::int32_t)), .how_to_raise = how_to_raise});
    if (!labels) return at(field, labels.error());
    StoredMap map;
    map.width = labels->width;
    map.height = labels->height;
    map.values = std::vector<std::int32_t>(labels->labels.begin(), labels->labels.end());
    bytes_left_ -= map.values.size() * sizeof(std::int32_t);
    return map;
}

Result<std::shared_ptr<const Texture>> PatternFiles::read_exchange(const std::string& field,
                                                                   const proto::Block& block) {
    const auto make = [&](ExchangeMethod method,
                          const proto::Exchange& message) -> Result<std::shared_ptr<const Texture>> {
        const auto read = tessera::read_exchange(folder_, field, method, message);
        if (!read) return read.error();
        exchange_bytes_ += read->bytes;
        if (exchange_bytes_ > max_exchange_bytes)
            return too_large_exchange(field, message.asset(), exchange_bytes_);
        return std::shared_ptr<const Texture>{make_exchange_texture(read->asset, read->options)};
    };
    switch (block.block_case()) {
        case proto::Block::kContentExchange:
            return make(ExchangeMethod::content_exchange, block.content_exchange());
        case proto::Block::kInterchange:
            return make(ExchangeMethod::interchange, block.interchange());
        case proto::Block::kWang:
            return make(ExchangeMethod::wang, block.wang());
        default:
            return invalid(field, "is no prepared photograph");
    }
}

}  // namespace tessera
