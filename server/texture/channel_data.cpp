#include "server/texture/channel_data.h"

#include <atomic>
#include <mutex>
#include <utility>

#include "server/texture/lean.h"

namespace tessera {
namespace {

using Images = std::vector<ExchangeAsset::Channel>;

Rgb16Image greys(const Rgb8Image& image) {
    Rgb16Image wide{image.width, image.height, {}};
    wide.values.reserve(image.bytes.size());
    for (const std::uint8_t byte : image.bytes) wide.values.push_back(static_cast<std::uint16_t>(byte * 257));
    return wide;
}

std::vector<DataImages> data_of(const Images& images, double range) {
    const auto* normal = aligned_image(images, ChannelSet::normal);
    const auto* roughness = aligned_image(images, ChannelSet::roughness);
    const auto* height = aligned_image(images, ChannelSet::height);
    using Part = Rgb8Image ExchangeAsset::Channel::*;
    const auto part_of = [](const ExchangeAsset::Channel* channel, Part part) {
        return channel == nullptr ? nullptr : &(channel->*part);
    };
    std::vector<DataImages> data;
    const auto add = [&](const auto& texels_of) {
        data.push_back(
            {texels_of(&ExchangeAsset::Channel::exemplar), texels_of(&ExchangeAsset::Channel::tile)});
    };
    // Heights travel in the third value of whichever image comes first
    if (normal != nullptr) {
        add([&](Part part) { return lean_slopes(normal->*part, range, part_of(height, part)); });
        add([&](Part part) { return lean_squares(normal->*part, range); });
        add([&](Part part) { return lean_products(normal->*part, range, part_of(roughness, part)); });
    } else if (roughness != nullptr) {
        add([&](Part part) { return squared_alphas(roughness->*part, part_of(height, part)); });
    } else {
        add([&](Part part) { return greys(height->*part); });
    }
    return data;
}

class ChannelData final : public ExchangeData {
  public:
    ChannelData(std::shared_ptr<const ExchangeTexture> albedo, Images images, double range)
        : albedo_{std::move(albedo)}, images_{std::move(images)}, range_{range} {
        std::size_t bytes = 0;
        for (const ExchangeAsset::Channel& image : images_)
            bytes += image.exemplar.bytes.size() + image.tile.bytes.size();
        bytes_ = bytes;
    }

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                std::span<const std::size_t> images, const TakeRow& take_row) const override {
        if (auto spent = check_budget(budget); !spent) return spent.error();
        std::call_once(once_, [this] {
            made_ = albedo_->with_texels(data_of(images_, range_));
            bytes_ = made_->memory_bytes();
            images_ = {};
        });
        return made_->evaluate(region, budget, images, take_row);
    }

    std::size_t memory_bytes() const noexcept override { return bytes_; }

  private:
    std::shared_ptr<const ExchangeTexture> albedo_;
    mutable Images images_;  ///< Until the data is made.
    double range_;
    mutable std::once_flag once_;
    mutable std::shared_ptr<const ExchangeData> made_;
    mutable std::atomic<std::size_t> bytes_;
};

}  // namespace

const ExchangeAsset::Channel* aligned_image(const std::vector<ExchangeAsset::Channel>& channels,
                                            ChannelSet set) noexcept {
    for (const ExchangeAsset::Channel& channel : channels)
        if (channel.name == name_of(set)) return &channel;
    return nullptr;
}

std::shared_ptr<const ExchangeData> make_channel_data(std::shared_ptr<const ExchangeTexture> albedo,
                                                      const ExchangeAsset& asset, double range) {
    Images images;
    for (const ChannelSet set : {ChannelSet::normal, ChannelSet::roughness, ChannelSet::height})
        if (const auto* image = aligned_image(asset.channels, set)) images.push_back(*image);
    if (images.empty()) return nullptr;
    return std::make_shared<ChannelData>(std::move(albedo), std::move(images), range);
}

}  // namespace tessera
