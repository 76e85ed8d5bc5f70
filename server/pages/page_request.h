#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/scene/scene.h"
#include "server/texture/texture.h"
#include "shared/page/channel_set.h"
#include "shared/page/error_limit.h"
#include "shared/page/page_format.h"
#include "shared/page/page_key.h"

namespace tessera {

/// Everything beside scene and key that a page's bytes depend on.
struct PageOptions {
    PageFormat format = PageFormat::png;
    ContentCoding coding = ContentCoding::identity;  ///< zstd only with PageFormat::rgba.
    std::uint8_t gutter = 0;                         ///< Texels, 0 to max_gutter_texels.
    Accuracy accuracy = Accuracy::high;              ///< `high` where there is an error limit.
    ChannelSet channels = ChannelSet::albedo;
    std::int64_t slice = 0;  ///< Scene::same_slice(): one number for all slices that look the same.
    std::optional<ErrorLimit> max_error{};  ///< The cheapest accuracy that keeps it.
    std::int64_t step = 0;                  ///< Of the animation clock; 0 where nothing moves.
    std::int32_t parameter = 0;  ///< Scene::same_parameter(): one number for all that show the same frames.
    bool operator==(const PageOptions&) const = default;
};

/// How soon a page is wanted: RFC 9218's urgency, 0 (first) to 7. Visible pages before prefetched ones.
struct Urgency {
    static constexpr std::uint8_t least = 7;
    std::uint8_t value = 3;
    auto operator<=>(const Urgency&) const = default;
};

/// `scene` is not null, has the channel set asked for, and its extent contains `key`.
struct PageRequest {
    ScenePtr scene;
    PageKey key;
    PageOptions options;
    Urgency urgency;
};

/// The last edit of `scene` that touched the page.
std::uint64_t page_revision(const Scene& scene, PageKey key) noexcept;

/// Names a page's bytes: two requests with equal ids get equal bytes. 128 bits of hash over the scene's
/// fingerprint, the page's own revision, its key, the options, and the encoders' version. Known without
/// evaluating the page.
struct PageId {
    std::uint64_t high = 0, low = 0;
    bool operator==(const PageId&) const = default;
};
/// Of a scene that moves this is the *line* of a page over all steps, and the page if it is the same at all
/// of them.
PageId page_id(const PageRequest& request);

/// Of the pages of a line, the one that is valid from `from` on, and unchanged in all steps before "always".
PageId page_id(PageId line, Step from);

/// A strong entity tag with its quotes (RFC 9110, 8.8.3).
std::string etag_of(PageId id);

}  // namespace tessera

template <>
struct std::hash<tessera::PageId> {
    std::size_t operator()(const tessera::PageId& id) const noexcept { return id.low; }
};
