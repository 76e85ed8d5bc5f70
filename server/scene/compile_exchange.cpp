#include "server/scene/compile_exchange.h"

#include <algorithm>

#include "proto/exchange.pb.h"

#include "server/scene/asset_file.h"
#include "server/scene/scene_path.h"

namespace tessera {
namespace {

Error invalid(const std::string& what) { return {ErrorCode::invalid_input, what}; }

Result<ExchangeOptions> to_options(const std::string& field, ExchangeMethod method,
                                   const proto::Exchange& message) {
    ExchangeOptions options;
    options.seed = message.seed();
    options.blended = !message.unblended();
    options.types = message.types();
    if (options.types != 0 &&
        (options.types < 64 || options.types > 16384 || (options.types & (options.types - 1)) != 0))
        return invalid(field + ".types: is " + std::to_string(options.types) +
                       "; a power of two from 64 to 16384");
    switch (message.choice()) {
        case proto::Choice::typed:
            options.choice = Choice::typed;
            return options;
        case proto::Choice::independent:
            options.choice = Choice::independent;
            if (method == ExchangeMethod::content_exchange) return options;
            break;
        case proto::Choice::kolar:
            options.choice = Choice::kolar;
            if (method == ExchangeMethod::interchange) return options;
            break;
        default:
            break;
    }
    static constexpr const char* allowed[] = {"\"typed\" or \"independent\"", "\"typed\" or \"kolar\"",
                                              "\"typed\" only"};
    return invalid(field + ".choice: " + allowed[static_cast<std::size_t>(method)]);
}

/// Both sets have patches: else nothing is ever exchanged.
bool has_both_sets(const ExchangeAsset& asset) {
    const auto has = [&](ExchangeAsset::Set set) {
        return std::ranges::count(asset.patches, set, &ExchangeAsset::Patch::set) > 0;
    };
    return has(ExchangeAsset::Set::a) && has(ExchangeAsset::Set::b);
}

}  // namespace

Result<ReadExchange> read_exchange(const std::filesystem::path& folder, const std::string& field,
                                   ExchangeMethod method, const proto::Exchange& message) {
    const auto asset_folder = path_inside(folder, field + ".asset", message.asset(), "asset");
    if (!asset_folder) return asset_folder.error();
    const auto options = to_options(field, method, message);
    if (!options) return options.error();
    auto asset = read_exchange_asset(*asset_folder);
    if (!asset) return Error{asset.error().code, field + ".asset: " + asset.error().detail};
    if (asset->method != method)
        return invalid(field + ".asset: \"" + message.asset() + "\" was prepared for " +
                       std::string{method_name(asset->method)} +
                       "; name the field so, or prepare it with --method " +
                       std::string{method_name(method)});
    if (options->choice == Choice::kolar && !has_both_sets(*asset))
        return invalid(field + ".choice: \"kolar\" needs patches of both sets, which \"" + message.asset() +
                       "\" has not; prepare it again, or choose \"typed\"");
    const std::size_t bytes = exchange_bytes(*asset, *options);
    return ReadExchange{std::move(*asset), *options, bytes};
}

Error too_large_exchange(const std::string& field, const std::string& asset, std::size_t bytes) {
    return invalid(field + ".asset: \"" + asset + "\" would take about " + std::to_string(bytes >> 20) +
                   " MiB, more than " + std::to_string(max_exchange_bytes >> 20) +
                   "; prepare it with a smaller tile, or fewer patches, contents or aligned images");
}

}  // namespace tessera
