// Comparisons that need no plan: light, depth of contents, integrals.
#include <array>
#include <cstdint>
#include <functional>
#include <string_view>

#include "server/accuracy/page_comparisons.h"
#include "server/accuracy/page_measuring.h"
#include "shared/math/hash.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

constexpr int light_levels = 6, depth_levels = 6;

proto::PageRow& add_row(std::vector<proto::PageRow>& rows, std::string_view comparison,
                        const std::string& texture, std::string_view setting, int level) {
    proto::PageRow& row = rows.emplace_back();
    row.set_comparison(std::string{comparison});
    row.set_texture(texture);
    row.set_setting(std::string{setting});
    row.set_level(static_cast<std::uint32_t>(level));
    row.set_confidence(1);
    return row;
}

void set_error(proto::PageRow& row, const PageError& error) {
    row.set_mse(error.mse);
    row.set_max_error(error.max_linear);
}

template <class Map>
LinearImage mapped(const LinearImage& in, Map&& map) {
    LinearImage out = in;
    for (std::size_t i = 0; i < out.values.size(); ++i)
        if (i % 4 != 3) out.values[i] = map(out.values[i]);
    return out;
}

/// The MIP chain, each level kept as `keep` keeps it.
LinearImage chain(LinearImage image, int level, const std::function<LinearImage(LinearImage)>& keep) {
    for (int i = 0; i < level; ++i) image = keep(reduced(image));
    return image;
}

LinearImage as_is(LinearImage image) { return image; }

float to_8_bit_srgb(float linear) { return from_srgb(steps_to_srgb()[to_steps(linear)]); }
float to_8_bit_linear(float linear) { return std::floor(std::clamp(linear, 0.F, 1.F) * 255 + 0.5F) / 255; }
float to_16_bit_linear(float linear) { return static_cast<float>(to_steps(linear)) / linear_one; }

/// The weight of content `index` of four: smooth, and all four sum to one.
float weight_of(int index, float x, float y) {
    const float u = x * x * (3 - 2 * x), v = y * y * (3 - 2 * y);
    return (index % 2 == 0 ? 1 - u : u) * (index / 2 == 0 ? 1 - v : v);
}

/// Content `index`: the image from another place, times its weight.
LinearImage weighted_content(const LinearImage& image, int index) {
    LinearImage out(image.width, image.height);
    const std::int32_t dx = index * image.width / 4, dy = index * image.height / 5;
    constexpr std::int32_t period = 64;
    for (std::int32_t y = 0; y < image.height; ++y)
        for (std::int32_t x = 0; x < image.width; ++x) {
            const float w = weight_of(index, static_cast<float>(x % period) / period,
                                      static_cast<float>(y % period) / period);
            const float* from =
                image.row((y + dy) % image.height) + std::ptrdiff_t{4} * ((x + dx) % image.width);
            float* to = out.row(y) + std::ptrdiff_t{4} * x;
            for (int c = 0; c < 4; ++c) to[c] = w * from[c];
        }
    return out;
}

}  // namespace

void compare_light(const std::string& name, const LinearImage& image, std::vector<proto::PageRow>& rows) {
    const LinearImage coded =
        mapped(image, [](float v) { return static_cast<float>(fractional_srgb_code(double(v)) / 255); });
    for (int level = 1; level <= light_levels; ++level) {
        const LinearImage truth = chain(image, level, as_is);
        LinearImage naive;
        const double naive_time = median_milliseconds([&] { naive = chain(coded, level, as_is); });
        naive =
            mapped(naive, [](float code) { return static_cast<float>(detail::decode(double(code) * 255)); });
        LinearImage right;
        const double right_time = median_milliseconds([&] { right = chain(image, level, as_is); });
        proto::PageRow& wrong = add_row(rows, "light", name, "sRGB codes", level);
        set_error(wrong, page_error(truth, naive));
        wrong.set_milliseconds(naive_time);
        proto::PageRow& linear = add_row(rows, "light", name, "linear light", level);
        set_error(linear, page_error(truth, right));
        linear.set_milliseconds(right_time);
    }
}

void compare_content_depth(const std::string& name, const LinearImage& image,
                           std::vector<proto::PageRow>& rows) {
    struct Depth {
        std::string_view name;
        float (*keep)(float);
    };
    constexpr std::array depths{Depth{"8-bit sRGB", to_8_bit_srgb}, Depth{"8-bit linear", to_8_bit_linear},
                                Depth{"16-bit linear", to_16_bit_linear}};
    constexpr std::size_t contents = 4;
    std::array<LinearImage, contents> levels;
    std::array<std::array<LinearImage, contents>, depths.size()> stored;
    for (std::size_t i = 0; i < contents; ++i) {
        levels[i] = weighted_content(image, static_cast<int>(i));
        for (std::size_t d = 0; d < depths.size(); ++d) stored[d][i] = mapped(levels[i], depths[d].keep);
    }
    const auto sum_of = [](const std::array<LinearImage, contents>& parts) {
        LinearImage sum = parts[0];
        for (std::size_t i = 1; i < contents; ++i)
            for (std::size_t k = 0; k < sum.values.size(); ++k) sum.values[k] += parts[i].values[k];
        return sum;
    };
    for (int level = 0; level <= depth_levels; ++level) {
        const LinearImage truth = sum_of(levels);
        for (std::size_t d = 0; d < depths.size(); ++d) {
            LinearImage sum;
            const double time = median_milliseconds([&] { sum = sum_of(stored[d]); });
            proto::PageRow& row = add_row(rows, "content-depth", name, depths[d].name, level);
            set_error(row, page_error(truth, sum));
            row.set_milliseconds(time);
            for (LinearImage& content : stored[d]) content = mapped(reduced(content), depths[d].keep);
        }
        for (LinearImage& content : levels) content = reduced(content);
    }
}

void compare_integrals(std::vector<proto::PageRow>& rows) {
    constexpr std::size_t span = 16, spans = 4096;
    for (int level = 8; level <= 22; level += 2) {
        const std::size_t length = std::size_t{1} << level;
        std::vector<float> floats(length + 1);
        std::vector<std::uint32_t> steps(length + 1);
        std::vector<std::uint16_t> texels(length);
        for (std::size_t i = 0; i < length; ++i) {
            texels[i] = srgb_to_steps[hash(1, stream("column"), std::int64_t(i), 0) % 256];
            floats[i + 1] = floats[i] + static_cast<float>(texels[i]) / linear_one;
            steps[i + 1] = steps[i] + texels[i];
        }
        // The last texels of the column, where sums are greatest
        const std::size_t count = std::min(spans, length - span);
        std::vector<float> by_floats(count), by_steps(count);
        const double float_time = median_milliseconds([&] {
            for (std::size_t k = 0; k < count; ++k)
                by_floats[k] = (floats[length - k] - floats[length - k - span]) / float(span);
        });
        const double step_time = median_milliseconds([&] {
            for (std::size_t k = 0; k < count; ++k)
                by_steps[k] = static_cast<float>(steps[length - k] - steps[length - k - span]) /
                              (float(span) * linear_one);
        });
        const auto add = [&](std::string_view setting, const std::vector<float>& means, double time) {
            double squares = 0, worst = 0;
            for (std::size_t k = 0; k < count; ++k) {
                std::uint32_t sum = 0;
                for (std::size_t i = length - k - span; i < length - k; ++i) sum += texels[i];
                const double right = double(sum) / (double(span) * double(linear_one));
                const double d = fractional_srgb_code(double(means[k])) - fractional_srgb_code(right);
                squares += d * d;
                worst = std::max(worst, std::fabs(double(means[k]) - right) * 255);
            }
            proto::PageRow& row = add_row(rows, "integral", "noise", setting, level);
            row.set_mse(squares / double(count));
            row.set_max_error(worst);
            row.set_milliseconds(time);
        };
        add("32-bit float sums", by_floats, float_time);
        add("modular integer sums", by_steps, step_time);
    }
}

}  // namespace tessera
