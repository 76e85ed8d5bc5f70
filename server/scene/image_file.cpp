#include "server/scene/image_file.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>

#include <OpenImageIO/imageio.h>
#include <webp/decode.h>

#include "server/files/whole_file.h"
#include "server/scene/png_file.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using Reader = std::unique_ptr<OIIO::ImageInput>;

/// Deflate packs at most 1032 bytes into one, and a byte holds at most 8 texels: beyond that, a header lies.
constexpr std::int64_t max_texels_per_file_byte = 8 * 1032;
/// Below this the ratio is not worth an argument: one colour packs into next to nothing.
constexpr std::int64_t small_texels = std::int64_t{1} << 22;

Error invalid(const fs::path& file, const std::string& what) {
    return {ErrorCode::invalid_input, file.string() + ": " + what};
}

/// OIIO's name of the format that the first bytes tell; empty if it is none of ours.
std::string format_of(const std::string& head) {
    if (head.starts_with("\x89PNG\r\n\x1a\n")) return "png";
    if (head.starts_with("\xff\xd8\xff")) return "jpeg";
    if (head.starts_with("RIFF") && head.size() >= 12 && head.compare(8, 4, "WEBP") == 0) return "webp";
    if (head.starts_with(std::string{"II*\0", 4}) || head.starts_with(std::string{"MM\0*", 4})) return "tiff";
    return {};
}

struct File {
    std::int64_t bytes = 0;
    std::string head;  ///< The first 32 bytes, or fewer.
    std::string format;
};

Result<File> inspect(const fs::path& path, const ImageLimits& limits) {
    std::error_code failure;
    const auto status = fs::status(path, failure);
    if (status.type() == fs::file_type::not_found)
        return Error{ErrorCode::io_failure, path.string() + ": there is no such file"};
    if (failure) return Error{ErrorCode::io_failure, path.string() + ": " + failure.message()};
    if (!fs::is_regular_file(status)) return Error{ErrorCode::io_failure, path.string() + ": is not a file"};
    File file;
    file.bytes = static_cast<std::int64_t>(fs::file_size(path, failure));
    if (failure) return Error{ErrorCode::io_failure, path.string() + ": " + failure.message()};
    if (file.bytes > limits.max_file_bytes)
        return invalid(path, "has " + std::to_string(file.bytes) + " bytes, more than the limit of " +
                                 std::to_string(limits.max_file_bytes) + "; save it smaller");
    std::ifstream in{path, std::ios::binary};
    file.head.resize(32);
    in.read(file.head.data(), std::ssize(file.head));
    file.head.resize(static_cast<std::size_t>(in.gcount()));
    if (in.bad() || !in.is_open()) return Error{ErrorCode::io_failure, path.string() + ": cannot be read"};
    file.format = format_of(file.head);
    if (file.format.empty())
        return invalid(path,
                       "is no PNG, JPEG, WebP or TIFF by its first bytes; save the image as one of these");
    return file;
}

/// What a header declares, held against the limits before any texel is decoded.
Result<void> check_size(const fs::path& path, std::int64_t width, std::int64_t height, std::int64_t depth,
                        std::int64_t file_bytes, const ImageLimits& limits) {
    const std::string size = "is " + std::to_string(width) + "×" + std::to_string(height);
    if (width < 1 || height < 1 || depth != 1) return invalid(path, size + ": not a flat image");
    if (width > limits.max_side || height > limits.max_side || width * height > limits.max_texels)
        return invalid(path, size + " texels, more than the limit of " + std::to_string(limits.max_side) +
                                 " a side and " + std::to_string(limits.max_texels) +
                                 " in all; scale it down" + limits.how_to_raise);
    if (width * height > small_texels && width * height / max_texels_per_file_byte > file_bytes)
        return invalid(path, size + " by its header, but holds only " + std::to_string(file_bytes) +
                                 " bytes: it is truncated or made to exhaust memory");
    return {};
}

/// Width and height of a WebP's first chunk. OIIO decodes a WebP as it opens it, so the limit comes before.
Result<void> check_webp(const fs::path& path, const File& file, const ImageLimits& limits) {
    const auto byte = [&](std::size_t i) {
        return i < file.head.size() ? std::int64_t{static_cast<unsigned char>(file.head[i])} : 0;
    };
    std::int64_t width = 0, height = 0;
    const std::string chunk = file.head.size() >= 30 ? file.head.substr(12, 4) : std::string{};
    if (chunk == "VP8X") {
        width = 1 + (byte(24) | byte(25) << 8 | byte(26) << 16);
        height = 1 + (byte(27) | byte(28) << 8 | byte(29) << 16);
    } else if (chunk == "VP8L") {
        const std::int64_t bits = byte(21) | byte(22) << 8 | byte(23) << 16 | byte(24) << 24;
        width = 1 + (bits & 0x3fff);
        height = 1 + (bits >> 14 & 0x3fff);
    } else if (chunk == "VP8 ") {
        width = (byte(26) | byte(27) << 8) & 0x3fff;
        height = (byte(28) | byte(29) << 8) & 0x3fff;
    } else {
        return invalid(path, "is a broken or truncated WebP; save it again");
    }
    return check_size(path, width, height, 1, file.bytes, limits);
}

Error broken(const fs::path& path, const std::string& format, std::string reason) {
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    return invalid(path, "is a broken or truncated " + format + " (" + reason + "); save or copy it again");
}

/// Opens with the one reader that the first bytes name, never with whatever plug-in claims the file.
Result<Reader> open_image(const fs::path& path, const File& file, const ImageLimits& limits) {
    static std::once_flag once;
    std::call_once(once, [] { OIIO::attribute("plugin_searchpath", ""); });
    if (file.format == "webp")
        if (auto fits = check_webp(path, file, limits); !fits) return fits.error();
    // libpng would say so on stderr, and leak what OIIO held
    if (file.format == "png")
        if (auto whole = check_png(path); !whole) return broken(path, file.format, whole.error().detail);
    Reader reader = OIIO::ImageInput::create(file.format, false, nullptr, "");
    if (!reader) {
        OIIO::geterror();
        return Error{ErrorCode::io_failure, path.string() + ": this OpenImageIO reads no " + file.format};
    }
    OIIO::ImageSpec spec, hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    if (!reader->open(path.string(), spec, hints)) return broken(path, file.format, reader->geterror());
    if (auto fits = check_size(path, spec.width, spec.height, spec.depth, file.bytes, limits); !fits)
        return fits.error();
    if (spec.tile_width > 0 && (spec.tile_width > limits.max_side || spec.tile_height > limits.max_side ||
                                std::int64_t{spec.tile_width} * spec.tile_height > limits.max_texels))
        return invalid(path, "has tiles larger than the limit; save it without tiles");
    if (spec.format != OIIO::TypeDesc::UINT8 && spec.format != OIIO::TypeDesc::UINT16)
        return invalid(path, "holds samples of type " + std::string{spec.format.c_str()} +
                                 "; save it with 8 or 16 bits a channel");
    return reader;
}

/// Hands over the image in strips of rows, as 16-bit samples of `channels` a texel (8-bit ones as they are).
template <class Take>
Result<void> read_strips(const fs::path& path, const std::string& format, OIIO::ImageInput& reader,
                         Take&& take) {
    const OIIO::ImageSpec spec = reader.spec();
    const bool tiled = spec.tile_width > 0;
    const int rows = tiled ? spec.tile_height : 64;
    const std::size_t row_samples =
        static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.nchannels);
    std::vector<std::uint8_t> narrow;
    std::vector<std::uint16_t> wide;
    const bool eight = spec.format == OIIO::TypeDesc::UINT8;
    for (int y = 0; y < spec.height; y += rows) {
        const int end = std::min(y + rows, spec.height);
        const std::size_t samples = row_samples * static_cast<std::size_t>(end - y);
        wide.resize(samples);
        if (eight) narrow.resize(samples);
        void* target = eight ? static_cast<void*>(narrow.data()) : wide.data();
        const int top = spec.y + y;
        const bool read =
            tiled ? reader.read_tiles(0, 0, spec.x, spec.x + spec.width, top, spec.y + end, 0, 1, 0,
                                      spec.nchannels, spec.format, target)
                  : reader.read_scanlines(0, 0, top, spec.y + end, 0, 0, spec.nchannels, spec.format, target);
        // Some readers fill what is missing, return true and leave a message
        if (!read || reader.has_error()) return broken(path, format, reader.geterror());
        if (eight) std::copy(narrow.begin(), narrow.end(), wide.begin());
        if (auto taken = take(y, end - y, wide); !taken) return taken;
    }
    return {};
}

std::uint8_t to_eight_bits(std::uint16_t sample, bool wide) {
    return static_cast<std::uint8_t>(wide ? (sample * 255u + 32767u) / 65535u : sample);
}

/// Turns the image as its EXIF orientation says (TIFF 6.0: 1 upright, 3 half turn, 6 and 8 quarter turns, the
/// others mirrored), so that the texture stands as the photograph is shown everywhere else.
template <class Image>
Image turned(Image image, int orientation) {
    if (orientation < 2 || orientation > 8) return image;
    const bool transposed = orientation >= 5;
    const std::ptrdiff_t channels =
        std::ssize(image.bytes) / (std::ptrdiff_t{image.width} * std::ptrdiff_t{image.height});
    Image out;
    out.width = transposed ? image.height : image.width;
    out.height = transposed ? image.width : image.height;
    out.bytes.resize(image.bytes.size());
    const bool from_right = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
    const bool from_bottom = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
    for (std::int32_t y = 0; y < out.height; ++y)
        for (std::int32_t x = 0; x < out.width; ++x) {
            const std::int32_t u = transposed ? y : x;
            const std::int32_t v = transposed ? x : y;
            const std::int32_t source_x = from_right ? image.width - 1 - u : u;
            const std::int32_t source_y = from_bottom ? image.height - 1 - v : v;
            std::copy_n(image.bytes.begin() + channels * (std::ptrdiff_t{source_y} * image.width + source_x),
                        channels, out.bytes.begin() + channels * (std::ptrdiff_t{y} * out.width + x));
        }
    return out;
}

/// A colour image that is open, and how its samples make red, green, blue and alpha.
struct ColorImage {
    File file;
    Reader reader;
    OIIO::ImageSpec spec;
    bool has_alpha = false;
    bool wide = false;  ///< 16 bits a sample.

    /// Texels of 16-bit samples; alpha is `opaque` where there is none.
    struct Texel {
        std::uint16_t red, green, blue, alpha;
    };
    std::uint16_t opaque() const { return wide ? 65535 : 255; }
    std::uint8_t code(std::uint16_t sample) const { return to_eight_bits(sample, wide); }

    /// Hands over every texel in reading order.
    template <class Take>
    Result<void> read(const fs::path& path, Take&& take) {
        const std::size_t stride = static_cast<std::size_t>(spec.nchannels);
        const std::size_t green = stride >= 3 ? 1 : 0, blue = stride >= 3 ? 2 : 0;
        return read_strips(path, file.format, *reader,
                           [&](int, int, const std::vector<std::uint16_t>& samples) -> Result<void> {
                               for (std::size_t i = 0; i < samples.size(); i += stride)
                                   take(Texel{samples[i], samples[i + green], samples[i + blue],
                                              has_alpha ? samples[i + stride - 1] : opaque()});
                               return {};
                           });
    }
};

Result<ColorImage> open_color_image(const fs::path& path, const ImageLimits& limits) {
    auto file = inspect(path, limits);
    if (!file) return file.error();
    auto reader = open_image(path, *file, limits);
    if (!reader) return reader.error();
    ColorImage image{std::move(*file), std::move(*reader), {}};
    image.spec = image.reader->spec();

    const std::string color_space = image.spec.get_string_attribute(
        "jpeg:ColorSpace", image.spec.get_string_attribute("tiff:ColorSpace"));
    if (color_space == "CMYK" || color_space == "YCbCrK" || color_space == "YCCK")
        return invalid(path, "is in " + color_space + ", the colours of a printer; save it as RGB");
    const int channels = image.spec.nchannels;
    image.has_alpha = channels == 2 || channels == 4;
    if (channels < 1 || channels > 4 || (image.has_alpha && image.spec.alpha_channel != channels - 1))
        return invalid(path, "has " + std::to_string(channels) + " channels; save it as grey or RGB");
    image.wide = image.spec.format == OIIO::TypeDesc::UINT16;
    return image;
}

}  // namespace

Result<Rgb8Image> read_rgb_image(const fs::path& path, const ImageLimits& limits) {
    auto opened = open_color_image(path, limits);
    if (!opened) return opened.error();
    Rgb8Image image{opened->spec.width, opened->spec.height, {}};
    image.bytes.resize(std::size_t{3} * static_cast<std::size_t>(image.width) *
                       static_cast<std::size_t>(image.height));
    std::uint8_t* out = image.bytes.data();
    bool transparent = false;
    const auto read = opened->read(path, [&](const ColorImage::Texel& texel) {
        transparent |= texel.alpha != opened->opaque();
        *out++ = opened->code(texel.red);
        *out++ = opened->code(texel.green);
        *out++ = opened->code(texel.blue);
    });
    if (!read) return read.error();
    if (transparent)
        return invalid(path, "has transparent texels; fill them with a background and save it without alpha");
    return turned(std::move(image), opened->spec.get_int_attribute("Orientation", 1));
}

namespace {

/// libwebp itself: OIIO premultiplies the texels of a WebP, and what was lost does not come back.
Result<StraightRgba8Image> read_webp(const fs::path& path, const File& file, const ImageLimits& limits) {
    if (auto fits = check_webp(path, file, limits); !fits) return fits.error();
    const auto bytes = read_whole_file(path, limits.max_file_bytes);
    if (!bytes) return bytes.error();
    const auto* data = reinterpret_cast<const std::uint8_t*>(bytes->data());
    StraightRgba8Image image;
    // The size that is allocated is the one that is checked: the file may be another by now
    if (WebPGetInfo(data, bytes->size(), &image.width, &image.height) == 0)
        return broken(path, file.format, "no header");
    if (auto fits = check_size(path, image.width, image.height, 1, std::ssize(*bytes), limits); !fits)
        return fits.error();
    image.bytes.resize(std::size_t{4} * static_cast<std::size_t>(image.width) *
                       static_cast<std::size_t>(image.height));
    if (WebPDecodeRGBAInto(data, bytes->size(), image.bytes.data(), image.bytes.size(), 4 * image.width) ==
        nullptr)
        return broken(path, file.format, "cannot be decoded");
    return image;
}

}  // namespace

Result<StraightRgba8Image> read_rgba_image(const fs::path& path, const ImageLimits& limits) {
    const auto file = inspect(path, limits);
    if (!file) return file.error();
    if (file->format == "webp") return read_webp(path, *file, limits);
    auto opened = open_color_image(path, limits);
    if (!opened) return opened.error();
    StraightRgba8Image image{opened->spec.width, opened->spec.height, {}};
    image.bytes.resize(std::size_t{4} * static_cast<std::size_t>(image.width) *
                       static_cast<std::size_t>(image.height));
    // Only a TIFF may hold premultiplied colours, and then it does not say that they are not
    const bool premultiplied = opened->has_alpha && opened->file.format == "tiff" &&
                               opened->spec.get_int_attribute("oiio:UnassociatedAlpha") == 0;
    const auto straight = [&](std::uint16_t color, std::uint16_t alpha) {
        if (!premultiplied || alpha == 0) return opened->code(color);
        const std::uint32_t opaque = opened->opaque();
        const std::uint32_t divided = (color * opaque + alpha / 2u) / alpha;
        return opened->code(static_cast<std::uint16_t>(std::min(divided, opaque)));
    };
    std::uint8_t* out = image.bytes.data();
    const auto read = opened->read(path, [&](const ColorImage::Texel& texel) {
        *out++ = straight(texel.red, texel.alpha);
        *out++ = straight(texel.green, texel.alpha);
        *out++ = straight(texel.blue, texel.alpha);
        *out++ = opened->code(texel.alpha);
    });
    if (!read) return read.error();
    return turned(std::move(image), opened->spec.get_int_attribute("Orientation", 1));
}

namespace {

/// Opens a PNG whose samples are grey, of any of these numbers of bits; `what` it holds is for the message.
Result<Reader> open_grey_png(const fs::path& path, const ImageLimits& limits, int few_bits, int many_bits,
                             const std::string& what) {
    const auto file = inspect(path, limits);
    if (!file) return file.error();
    // Bytes 24 and 25 of a PNG: bits a sample, and the kind of colour, 0 for grey
    if (file->format != "png" || file->head.size() < 26 ||
        (file->head[24] != few_bits && file->head[24] != many_bits) || file->head[25] != 0)
        return invalid(path, "is no grey PNG of " + std::to_string(few_bits) + " or " +
                                 std::to_string(many_bits) + " bits, which holds " + what +
                                 " for each texel");
    auto reader = open_image(path, *file, limits);
    if (!reader) return reader.error();
    if ((*reader)->spec().nchannels != 1)
        return invalid(path, "has transparency, which it cannot have; save it as plain grey");
    return reader;
}

}  // namespace

Result<LabelImage> read_label_image(const fs::path& path, const ImageLimits& limits) {
    auto reader = open_grey_png(path, limits, 8, 16, "a label");
    if (!reader) return reader.error();
    LabelImage image;
    image.width = (*reader)->spec().width;
    image.height = (*reader)->spec().height;
    image.labels.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    const auto read = read_strips(
        path, "png", **reader, [&](int y, int, const std::vector<std::uint16_t>& samples) -> Result<void> {
            std::copy(samples.begin(), samples.end(), image.labels.begin() + std::ptrdiff_t{y} * image.width);
            return {};
        });
    if (!read) return read.error();
    return image;
}

Result<BitMask> read_bit_image(const fs::path& path, const ImageLimits& limits) {
    auto reader = open_grey_png(path, limits, 1, 8, "a bit");
    if (!reader) return reader.error();
    BitMask image{(*reader)->spec().width, (*reader)->spec().height};
    const auto read =
        read_strips(path, "png", **reader,
                    [&](int top, int rows, const std::vector<std::uint16_t>& samples) -> Result<void> {
                        std::size_t i = 0;
                        for (int y = top; y < top + rows; ++y)
                            for (int x = 0; x < image.width; ++x)
                                if (samples[i++] > 127) image.set(x, y);
                        return {};
                    });
    if (!read) return read.error();
    return image;
}

Result<void> write_rgb_png(const fs::path& file, const Rgb8Image& image) {
    return write_whole_file(file, to_png(image.width, image.height, PngColor::rgb, 8, image.bytes));
}

Result<void> write_rgba_png(const fs::path& file, const StraightRgba8Image& image) {
    return write_whole_file(file, to_png(image.width, image.height, PngColor::rgba, 8, image.bytes));
}

Result<void> write_label_png(const fs::path& file, const LabelImage& image) {
    const bool wide =
        std::any_of(image.labels.begin(), image.labels.end(), [](auto label) { return label > 255; });
    std::vector<std::uint8_t> samples;
    samples.reserve(image.labels.size() * (wide ? 2 : 1));
    for (const std::uint16_t label : image.labels) {
        if (wide) samples.push_back(static_cast<std::uint8_t>(label >> 8));
        samples.push_back(static_cast<std::uint8_t>(label));
    }
    return write_whole_file(file, to_png(image.width, image.height, PngColor::grey, wide ? 16 : 8, samples));
}

Result<void> write_bit_png(const fs::path& file, const BitMask& image) {
    return write_whole_file(file, to_png(image.width, image.height, PngColor::grey, 1, image.bytes));
}

}  // namespace tessera
