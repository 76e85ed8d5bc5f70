#include "server/http/routes.h"

#include <cstdio>
#include <sstream>

#include <prometheus/text_serializer.h>
#include <xxhash.h>

#include "server/http/descriptions.h"
#include "server/http/editables.h"

namespace tessera {
namespace {

namespace http = boost::beast::http;

constexpr std::string_view now_caching = "Cache-Control: no-cache\r\n";
constexpr std::string_view no_caching = "Cache-Control: no-store\r\n";
constexpr std::string_view immutable_caching = "Cache-Control: public, max-age=31536000, immutable\r\n";

/// A document that may change: revalidated each time, by a hash of its content.
Answer document(const RequestHead& request, std::string_view content_type, std::string body) {
    char tag[32];
    std::snprintf(tag, sizeof tag, "\"%016llx\"",
                  static_cast<unsigned long long>(XXH3_64bits(body.data(), body.size())));
    const std::string fields = "ETag: " + std::string{tag} + "\r\n" + std::string{now_caching};
    if (matches(request[http::field::if_none_match], tag)) return text_answer(304, {}, {}, fields);
    return text_answer(200, content_type, std::move(body), fields);
}

Refusal no_such_scene(const Catalog& catalog, const std::string& id) {
    const Catalog::Problem* problem = catalog.problem_of(id);
    if (problem != nullptr && problem->passing) return {503, problem->message, false};
    return {404, "there is no scene \"" + id + "\"; /scenes lists them", false};
}

Answer options_answer(std::string_view path) {
    if (is_posted_to(path))
        return text_answer(204, {}, {},
                           "Allow: POST, OPTIONS\r\n"
                           "Access-Control-Allow-Methods: POST, OPTIONS\r\n"
                           "Access-Control-Allow-Headers: Accept, Authorization, Content-Type\r\n"
                           "Access-Control-Max-Age: 86400\r\n");
    return text_answer(204, {}, {},
                       "Allow: GET, HEAD, OPTIONS\r\n"
                       "Access-Control-Allow-Methods: GET, HEAD, OPTIONS\r\n"
                       "Access-Control-Allow-Headers: Accept-Encoding, If-None-Match, Priority, Range\r\n"
                       "Access-Control-Max-Age: 86400\r\n");
}

}  // namespace

Routes::Outcome Routes::route(const RequestHead& request, const Site& site) {
    if (request.is(http::verb::options)) return options_answer(request.path);
    const auto segments = path_segments(request.path);
    if (!segments) return refusal_answer(segments.error());
    const std::string& first = segments->front();
    if (segments->size() == 1) {
        if (first == "healthz")
            return text_answer(200, "text/plain; charset=utf-8", "alive\n", "Cache-Control: no-store\r\n");
        if (first == "readyz") return readiness(site);
        if (first == "metrics") return metrics();
    }
    if (!site.catalog) return refusal_answer({503, "the scenes are being loaded", false});
    if (first != "scenes") return web_file(request, site, *segments);

    if (is_sprite_address(*segments)) {
        const ScenePtr scene = site.catalog->find((*segments)[1]);
        return scene ? sprites(request, scene, *segments)
                     : refusal_answer(no_such_scene(*site.catalog, (*segments)[1]));
    }
    if (is_page_address(*segments)) return page(request, site, *segments);
    if (segments->size() == 3 && segments->back() == "sample") {
        const ScenePtr scene = site.catalog->find((*segments)[1]);
        return scene ? sample(request, scene) : refusal_answer(no_such_scene(*site.catalog, (*segments)[1]));
    }
    if (segments->size() == 3 && segments->back() == "edits") {
        const ScenePtr scene = site.catalog->find((*segments)[1]);
        return scene ? edit(request, *scene, *site.access)
                     : refusal_answer(no_such_scene(*site.catalog, (*segments)[1]));
    }
    if (!request.query.empty()) return refusal_answer({400, "this address takes no parameters", false});
    if (segments->size() == 3 && segments->back() == "stream") {
        if (site.draining) return refusal_answer({503, "stopping", true});
        const ScenePtr scene = site.catalog->find((*segments)[1]);
        return scene ? stream(request, *scene) : refusal_answer(no_such_scene(*site.catalog, (*segments)[1]));
    }
    if (segments->size() == 3 && segments->back() == "editables") {
        const ScenePtr scene = site.catalog->find((*segments)[1]);
        return scene ? text_answer(200, "application/json", describe_editables(*scene),
                                   "Cache-Control: no-store\r\n")
                     : refusal_answer(no_such_scene(*site.catalog, (*segments)[1]));
    }
    if (segments->size() == 1) return scene_list(request, *site.catalog);
    if (segments->size() == 2) {
        const ScenePtr scene = site.catalog->find((*segments)[1]);
        return scene ? tile_json(request, *scene)
                     : refusal_answer(no_such_scene(*site.catalog, (*segments)[1]));
    }
    return refusal_answer({404, "pages are at /scenes/{id}/{z}/{x}/{y}.png", false});
}

Routes::Outcome Routes::page(const RequestHead& request, const Site& site,
                             const std::vector<std::string>& segments) {
    const auto address = page_address(segments);
    if (!address) return refusal_answer(address.error());
    auto query = page_query(request.query);
    if (!query) return refusal_answer(query.error());
    const ScenePtr scene = site.catalog->find(address->scene);
    if (!scene) return refusal_answer(no_such_scene(*site.catalog, address->scene));
    if (scene->texture_of(query->channels) == nullptr)
        return refusal_answer({404,
                               "the scene has no channels \"" + std::string{name_of(query->channels)} +
                                   "\"; it has " + scene->channel_names(),
                               false});
    query->slice = scene->same_slice(query->slice);
    query->step = scene->same_step(query->step);
    query->parameter = scene->same_parameter(query->parameter);
    const std::uint8_t n = scene->extent.n;
    const std::uint64_t side = address->z <= n ? std::uint64_t{1} << address->z : 0;
    if (address->x >= side || address->y >= side) {
        return refusal_answer(
            {404, "there is no such page; z goes to " + std::to_string(n) + ", x and y to 2^z − 1", false});
    }

    PendingPage pending{{scene,
                         {static_cast<std::uint8_t>(n - address->z), static_cast<std::uint32_t>(address->x),
                          static_cast<std::uint32_t>(address->y)},
                         {address->format, ContentCoding::identity, query->gutter, query->accuracy,
                          query->channels, query->slice, query->max_error, query->step, query->parameter},
                         urgency_of(request["Priority"])},
                        address->pin.has_value()};
    PageRequest& wanted = pending.request;
    if (wanted.options.format == PageFormat::rgba && accepts(request[http::field::accept_encoding], "zstd"))
        wanted.options.coding = ContentCoding::zstd;

    if (address->pin) {
        const auto [revision, fingerprint] = *address->pin;
        const std::uint64_t own = page_revision(*scene, wanted.key);
        if (fingerprint != scene->fingerprint)
            return refusal_answer({404, "the scene is now " + scene->fingerprint, false});
        if (revision > scene->revision)
            return refusal_answer(
                {404, "the scene is only at revision " + std::to_string(scene->revision), false});
        if (revision < own)
            return refusal_answer({410, "the page has changed at revision " + std::to_string(own), false});
        // One address for one page: that of its own revision, with the query in its one order
        const std::string canonical_query = query->canonical();
        const std::string_view asked_query =
            canonical_query.empty() ? std::string_view{} : std::string_view{canonical_query}.substr(1);
        if (revision > own || request.query != asked_query) {
            const std::string location = "/scenes/" + scene->id + "/r" + std::to_string(own) + "-" +
                                         fingerprint + "/" + std::to_string(address->z) + "/" +
                                         std::to_string(address->x) + "/" + std::to_string(address->y) + "." +
                                         std::string{extension(address->format)} + canonical_query;
            return text_answer(308, "text/plain; charset=utf-8", location + "\n",
                               "Location: " + location + "\r\n" + std::string{now_caching});
        }
    }

    const std::optional<PageId> id = pages_.id_of(wanted);
    const std::string_view caching = pending.pinned ? immutable_caching : now_caching;
    const std::string_view known = request[http::field::if_none_match];
    if (id && !known.empty() && !(known == "*" && wanted.options.max_error) && matches(known, etag_of(*id)))
        return page_not_modified(*id, wanted.options, pending.pinned);
    if (id)
        if (const PagePtr page = pages_.find(*id, wanted)) return page_answer(page, pending.pinned, true);
    if (request.is(http::verb::head)) {
        Answer answer;
        answer.fields = page_fields_without_body(id, wanted.options, false)
                            .append(wanted.options.max_error ? no_caching : caching);
        answer.prelude = text_answer(204, {}, {}).prelude;
        return answer;
    }
    // Only its evaluation tells in which steps a page that moves stays the same, and so its entity tag
    if (!id) pending.if_none_match = known;
    return pending;
}

Answer Routes::page_not_modified(PageId id, const PageOptions& options, bool pinned) {
    return text_answer(
        304, {}, {},
        page_fields_without_body(id, options, true).append(pinned ? immutable_caching : now_caching));
}

Answer Routes::page_answer(const PagePtr& page, const PendingPage& pending) {
    if (!pending.if_none_match.empty() && page->within_limit &&
        matches(pending.if_none_match, etag_of(page->id)))
        return page_not_modified(page->id, page->options, pending.pinned);
    return page_answer(page, pending.pinned, false);
}

Answer Routes::page_answer(const PagePtr& page, bool pinned, bool from_cache) {
    Answer answer;
    answer.fields = !page->within_limit ? no_caching : pinned ? immutable_caching : now_caching;
    if (from_cache) {
        answer.fields += "Server-Timing: cache;desc=hit\r\n";
    } else {
        const auto milliseconds = [](std::chrono::nanoseconds time) {
            return std::chrono::duration<double, std::milli>(time).count();
        };
        char timing[160];
        const int length = std::snprintf(timing, sizeof timing,
                                         "Server-Timing: cache;desc=miss, queue;dur=%.3f, evaluate;dur=%.3f, "
                                         "encode;dur=%.3f\r\n",
                                         milliseconds(page->queued), milliseconds(page->evaluated),
                                         milliseconds(page->encoded));
        answer.fields.append(timing, static_cast<std::size_t>(length));
    }
    answer.prelude = page->prelude;
    answer.body = *page->bytes;
    answer.owner = page;
    return answer;
}

Answer Routes::scene_list(const RequestHead& request, const Catalog& catalog) {
    return document(request, "application/json", describe_scenes(catalog));
}

Answer Routes::tile_json(const RequestHead& request, const Scene& scene) {
    // A proxy that ends TLS says so; the entity tag covers it, so a cached copy never answers for the other
    const bool secure = request["X-Forwarded-Proto"] == "https";
    const std::string origin = (secure ? "https://" : "http://") + std::string{request.host};
    return document(request, "application/json", describe_tiles(scene, origin));
}

Answer Routes::readiness(const Site& site) {
    if (site.draining) return refusal_answer({503, "stopping", false});
    if (!site.catalog) return refusal_answer({503, "loading", false});
    return text_answer(200, "text/plain; charset=utf-8", "ready\n", "Cache-Control: no-store\r\n");
}

Answer Routes::metrics() {
    pages_.update_gauges();
    samples_.update_gauges();
    edits_.update_gauges();
    std::ostringstream text;
    prometheus::TextSerializer{}.Serialize(text, registry_.Collect());
    return text_answer(200, "text/plain; version=0.0.4; charset=utf-8", text.str(),
                       "Cache-Control: no-store\r\n");
}

Answer Routes::web_file(const RequestHead& request, const Site& site,
                        const std::vector<std::string>& segments) {
    std::string path = segments.front();
    for (std::size_t i = 1; i < segments.size(); ++i) path += "/" + segments[i];
    const WebFiles::File* file = site.web->find(path);
    if (file == nullptr)
        return refusal_answer({404, "there is nothing here; /scenes lists the scenes", false});

    const bool gzip = !file->gzip.empty() && accepts(request[http::field::accept_encoding], "gzip");
    std::string etag = file->etag;
    if (gzip) etag.insert(etag.size() - 1, "-gzip");
    Answer answer;
    answer.fields = "ETag: " + etag + "\r\n";
    answer.fields += file->immutable ? immutable_caching : now_caching;
    if (!file->gzip.empty()) answer.fields += "Vary: Accept-Encoding\r\n";
    answer.prelude = text_answer(204, {}, {}).prelude;
    answer.owner = site.web;
    if (matches(request[http::field::if_none_match], etag)) {
        answer.status = 304;
        return answer;
    }
    answer.body = gzip ? file->gzip : file->bytes;
    if (gzip) answer.fields += "Content-Encoding: gzip\r\n";
    answer.fields += "Content-Type: " + file->content_type +
                     "\r\nContent-Length: " + std::to_string(answer.body.size()) + "\r\n";
    return answer;
}

}  // namespace tessera
