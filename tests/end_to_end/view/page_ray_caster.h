#pragma once

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>

#include "client/link/background_page_client.h"
#include "client/residency/camera.h"
#include "shared/math/srgb.h"
#include "shared/page/texel_image.h"

namespace tessera::testing {

/// Draws a view of the plane on the CPU, in doubles, through the pages that the server gives: fetched one by
/// one, without gutters, as the filter touches them. Shares no code with the GL client but the HTTP
/// connection.
class PageRayCaster {
  public:
    PageRayCaster(const ServerAddress& server, const SceneInfo& scene)
        : extent_{scene.extent}, client_{server, scene} {}

    /// PSNR in decibels between a frame and the ray-cast of the same view, over the pixels that see the plane
    /// far enough below the horizon that no haze lies on them.
    double compare(const Rgba8Image& frame, const Camera& camera) {
        double squares = 0;
        std::size_t pixels = 0;
        for (int y = 0; y < frame.height; ++y) {
            for (int x = 0; x < frame.width; ++x) {
                const Ray ray = ray_at(camera, frame.width, frame.height, x + 0.5, y + 0.5);
                if (ray.below < 0.4) continue;  // sine of the angle: e^-14 of the haze is left
                const auto codes = pixel(camera, frame.width, frame.height, x, y);
                for (std::size_t c = 0; c < 3; ++c) {
                    const double d = codes[c] - frame.row(y)[4 * static_cast<std::size_t>(x) + c];
                    squares += d * d;
                }
                ++pixels;
            }
        }
        compared_pixels = pixels;
        return 10 * std::log10(255.0 * 255.0 * 3 * static_cast<double>(pixels) / std::max(squares, 1e-9));
    }
    std::size_t compared_pixels = 0;

  private:
    struct Ray {
        double x = 0, y = 0;  ///< Where it meets the plane, from the point under the eye
        double below = -1;    ///< Sine of its angle below the horizon
    };

    static Ray ray_at(const Camera& camera, int width, int height, double px, double py) {
        const double degree = std::numbers::pi / 180;
        const double tangent = std::tan(camera.field_of_view_degrees / 2 * degree);
        const double right = (px - width / 2.0) / (height / 2.0) * tangent;
        const double up = (height / 2.0 - py) / (height / 2.0) * tangent;
        const double pitch = camera.pitch_degrees * degree, yaw = camera.yaw_degrees * degree;
        const double ahead = std::cos(pitch) - up * std::sin(pitch),
                     rise = std::sin(pitch) + up * std::cos(pitch);
        if (rise >= 0) return {};
        const double reach = camera.height_texels / -rise;
        return {reach * (right * std::cos(yaw) + ahead * std::sin(yaw)),
                reach * (right * std::sin(yaw) - ahead * std::cos(yaw)),
                -rise / std::sqrt(right * right + ahead * ahead + rise * rise)};
    }

    std::array<double, 3> pixel(const Camera& camera, int width, int height, int px, int py) {
        const double x = px + 0.5, y = py + 0.5, e = 1e-3;
        const Ray at = ray_at(camera, width, height, x, y);
        const auto speed = [&](double dx, double dy) {
            const Ray before = ray_at(camera, width, height, x - dx, y - dy);
            const Ray after = ray_at(camera, width, height, x + dx, y + dy);
            return std::hypot(after.x - before.x, after.y - before.y) / (2 * e);
        };
        const double level =
            std::clamp(std::log2(std::max(speed(e, 0), speed(0, e))), 0.0, static_cast<double>(extent_.n));
        const int finer = static_cast<int>(level);
        const auto a = bilinear(camera, finer, at),
                   b = bilinear(camera, std::min<int>(finer + 1, extent_.n), at);
        std::array<double, 3> codes{};
        for (std::size_t c = 0; c < 3; ++c) {
            const double linear = a[c] + (level - finer) * (b[c] - a[c]);
            codes[c] =
                255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
        }
        return codes;
    }

    std::array<double, 3> bilinear(const Camera& camera, int level, const Ray& at) {
        const std::int64_t side = std::int64_t{1} << level;
        const auto split = [&](std::int64_t whole, double fraction, double offset) {
            const double within =
                (static_cast<double>(whole & (side - 1)) + fraction + offset) / static_cast<double>(side) -
                0.5;
            return std::pair{(whole >> level) + static_cast<std::int64_t>(std::floor(within)),
                             within - std::floor(within)};
        };
        const auto [column, u] = split(camera.ground.x, camera.ground.fraction_x, at.x);
        const auto [row, v] = split(camera.ground.y, camera.ground.fraction_y, at.y);
        std::array<double, 3> sum{};
        for (int i = 0; i < 4; ++i) {
            const double weight = (i % 2 ? u : 1 - u) * (i / 2 ? v : 1 - v);
            const auto* texel = texel_at(level, column + i % 2, row + i / 2);
            for (std::size_t c = 0; c < 3; ++c)
                sum[c] += weight * static_cast<double>(from_srgb(static_cast<std::uint8_t>(texel[c])));
        }
        return sum;
    }

    const char* texel_at(int level, std::int64_t x, std::int64_t y) {
        const PageKey key{static_cast<std::uint8_t>(level), static_cast<std::uint32_t>(x >> 8),
                          static_cast<std::uint32_t>(y >> 8)};
        if (key != last_key_ || !last_page_) {
            auto found = pages_.find(key);
            if (found == pages_.end()) found = pages_.emplace(key, fetch(key)).first;
            last_key_ = key;
            last_page_ = &found->second;
        }
        return last_page_->data() + 4 * ((y & 255) * 256 + (x & 255));
    }

    std::string fetch(PageKey key) {
        client_.request(key, {.format = PageFormat::rgba});
        for (;;) {
            client_.wait_for_finished(std::chrono::seconds{30});
            for (FinishedPage& page : client_.take_finished()) {
                if (!page.result) throw std::runtime_error{page.result.error().detail};
                return std::move(page.result->bytes);
            }
        }
    }

    Extent extent_;
    BackgroundPageClient client_;
    std::map<PageKey, std::string> pages_;
    PageKey last_key_;
    const std::string* last_page_ = nullptr;
};

}  // namespace tessera::testing
