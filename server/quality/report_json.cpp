#include "server/quality/report_json.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "server/scene/asset_file.h"

namespace tessera {
namespace {

/// JSON, indented. Keys and texts are our own and hold nothing to escape.
class Json {
  public:
    void open(std::string_view key, char bracket) {
        begin(key);
        text_ += bracket;
        closing_ += bracket == '{' ? '}' : ']';
        first_ = true;
    }
    void close() {
        const char bracket = closing_.back();
        closing_.pop_back();
        if (!first_) new_line();
        text_ += bracket;
        first_ = false;
    }
    void number(std::string_view key, double value) {
        begin(key);
        std::array<char, 32> digits{};
        const auto end = std::to_chars(digits.data(), digits.data() + digits.size(),
                                       std::isfinite(value) ? value : 0.0, std::chars_format::general, 6);
        text_.append(digits.data(), end.ptr);
    }
    void whole(std::string_view key, std::uint64_t value) {
        begin(key);
        text_ += std::to_string(value);
    }
    void text(std::string_view key, std::string_view value) {
        begin(key);
        text_ += '"';
        text_ += value;
        text_ += '"';
    }
    void truth(std::string_view key, bool value) {
        begin(key);
        text_ += value ? "true" : "false";
    }
    std::string take() { return std::move(text_) + "\n"; }

  private:
    void begin(std::string_view key) {
        if (!closing_.empty()) {
            if (!first_) text_ += ',';
            new_line();
        }
        first_ = false;
        if (key.empty()) return;
        text_ += '"';
        text_ += key;
        text_ += "\": ";
    }
    void new_line() {
        text_ += '\n';
        text_.append(closing_.size() * 2, ' ');
    }
    std::string text_;
    std::string closing_;
    bool first_ = true;
};

void write(Json& json, std::string_view key, const Steps& steps) {
    json.open(key, '{');
    json.number("mean", steps.mean);
    json.number("percentile_99", steps.percentile_99);
    json.close();
}

void write(Json& json, std::string_view key, const TileShare::Figure& figure) {
    json.open(key, '{');
    json.number("mean", figure.mean);
    json.number("greatest", figure.greatest);
    json.number("corner", figure.corner);
    json.number("border", figure.border);
    json.close();
}

void write(Json& json, std::string_view key, const TileShare& share) {
    json.open(key, '{');
    json.whole("occurrences", static_cast<std::uint64_t>(share.occurrences));
    write(json, "tile", share.tile);
    write(json, "repeat", share.repeat);
    json.number("shifted", share.shifted.value);
    json.number("shifted_x", share.shifted.x);
    json.number("shifted_y", share.shifted.y);
    json.number("chance", share.chance);
    json.number("beyond_chance", share.beyond_chance);
    json.close();
}

void write(Json& json, std::string_view key, const Fidelity::Distances& distances) {
    json.open(key, '{');
    json.number("lightness", distances.lightness);
    json.number("green_red", distances.green_red);
    json.number("blue_yellow", distances.blue_yellow);
    json.number("steps", distances.steps);
    json.close();
}

}  // namespace

std::string report_json(const ExchangeAsset& asset, const Quality& quality, const ContentSheets& contents) {
    Json json;
    json.open("", '{');
    json.text("method", method_name(asset.method));
    json.whole("tile_side", static_cast<std::uint64_t>(asset.tile_side));
    json.whole("patches", asset.patches.size());
    json.whole("contents", contents.contents.size() + contents.left_out);
    json.whole("blend_texels", static_cast<std::uint64_t>(asset.blend_texels));
    json.truth("passed", quality.passed());
    json.open("gates", '[');
    for (const Gate& gate : quality.gates) {
        json.open("", '{');
        json.text("name", gate.name);
        json.number("value", gate.value);
        json.number("limit", gate.limit);
        json.truth("passed", gate.passed());
        json.close();
    }
    json.close();

    json.open("seams", '{');
    json.whole("pairs", quality.seams.pairs);
    write(json, "exemplar_steps", quality.seams.exemplar);
    write(json, "hard_steps", quality.seams.hard);
    write(json, "blended_steps", quality.seams.blended);
    write(json, "hard_ratio", quality.seams.hard_ratio);
    write(json, "blended_ratio", quality.seams.blended_ratio);
    if (quality.seams.natural_steps > 0) {
        write(json, "natural_steps", quality.seams.natural);
        write(json, "natural_ratio", quality.seams.natural_ratio);
        write(json, "excess", quality.seams.excess);
        json.number("new_edges", quality.seams.new_edges);
    }
    if (quality.seams.quiet_steps > 0) write(json, "quiet_ratio", quality.seams.quiet_ratio);
    json.close();

    json.open("repetition", '[');
    for (const auto& level : quality.repetition.levels) {
        json.open("", '{');
        json.whole("level", static_cast<std::uint64_t>(level.level));
        json.number("greatest", level.greatest.value);
        json.number("at_x", level.greatest.x);
        json.number("at_y", level.greatest.y);
        json.number("mean", level.mean);
        json.number("elsewhere", level.elsewhere);
        if (level.farther) {
            json.number("farther", level.farther->value);
            json.number("farther_x", level.farther->x);
            json.number("farther_y", level.farther->y);
        }
        json.close();
    }
    json.close();

    write(json, "tile_share", quality.share);
    if (quality.kolar) write(json, "tile_share_choice_kolar", *quality.kolar);

    json.open("fidelity", '{');
    write(json, "texture", quality.fidelity.texture);
    write(json, "tile", quality.fidelity.tile);
    json.close();

    json.open("contents_seam_ratio", '[');
    for (const ContentFacts& facts : contents.contents) {
        json.open("", '{');
        json.whole("patch", facts.patch);
        json.whole("content", facts.content);
        json.whole("texels", static_cast<std::uint64_t>(facts.texels));
        json.number("seam_ratio", facts.seam_ratio);
        json.close();
    }
    json.close();
    json.close();
    return json.take();
}

}  // namespace tessera
