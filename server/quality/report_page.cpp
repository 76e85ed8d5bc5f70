#include "server/quality/report_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "server/quality/report_json.h"

namespace tessera {
namespace {

[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...) {
    std::array<char, 1024> text{};
    va_list arguments;
    va_start(arguments, pattern);
    std::vsnprintf(text.data(), text.size(), pattern, arguments);
    va_end(arguments);
    return text.data();
}

std::string escaped(const std::string& text) {
    std::string out;
    for (const char letter : text)
        out += letter == '<'   ? "&lt;"
               : letter == '&' ? "&amp;"
               : letter == '"' ? "&quot;"
                               : std::string(1, letter);
    return out;
}

std::string percent(double share) { return format("%.1f %%", share * 100); }

/// A picture that a click enlarges. `picture` names a background of the style sheet.
std::string zoomable(const std::string& picture, const EmbeddedPicture& size, const std::string& label,
                     const char* more_class = "") {
    return format(
               "<button class=\"picture shows-%s %s\" data-zoom=\"%d %d\" style=\"aspect-ratio:%d/%d\" "
               "aria-label=\"",
               picture.c_str(), more_class, size.width, size.height, size.width, size.height) +
           escaped(label) + "\" title=\"Click to enlarge\"></button>";
}

std::string heat_legend(const std::string& least, const std::string& most) {
    return "<div class=scale></div><div class=ends><span>" + least + "</span><span>" + most + "</span></div>";
}

std::string header(const std::string& title, const ExchangeAsset& asset, const Quality& quality,
                   const ContentSheets& contents) {
    std::string out = "<h1>" + escaped(title) + "</h1>\n";
    const auto failed = std::count_if(quality.gates.begin(), quality.gates.end(),
                                      [](const Gate& gate) { return !gate.passed(); });
    out += failed == 0 ? "<span class=\"verdict pass\" data-verdict>All gates passed</span>"
                       : format("<span class=\"verdict fail\" data-verdict>%td of %zu gates failed</span>",
                                failed, quality.gates.size());
    const char* method = asset.method == ExchangeMethod::content_exchange ? "Content exchange"
                         : asset.method == ExchangeMethod::interchange    ? "Interchangeable patches"
                                                                          : "Wang tiles";
    out += format(
        "\n<ul class=facts><li>%s<li>tile of %d × %d texels<li>%zu patches<li>%zu contents<li>blended over "
        "%d texels"
        "<li>exemplar of %d × %d texels</ul>\n",
        method, asset.tile_side, asset.tile_side, asset.patches.size(),
        contents.contents.size() + contents.left_out, asset.blend_texels, asset.exemplar.width,
        asset.exemplar.height);
    return out;
}

std::string gates_section(const Quality& quality) {
    std::string out =
        "<section><h2>Gates</h2><p>Seams are colour steps between neighbouring texels that come from "
        "different places, divided by "
        "the photograph’s own steps: 1 is as if there were no seam. Repetition is what the texture has in "
        "common with itself, moved "
        "by whole tiles: 1 is the plain periodic tile.</p><div class=wide><table "
        "data-gates><thead><tr><th>Figure<th class=n>Measured"
        "<th class=n>At most<th aria-hidden=true><th></thead><tbody>\n";
    for (const Gate& gate : quality.gates) {
        // The mark of the limit stands at two thirds
        const double part = std::clamp(gate.value / gate.limit / 1.5, 0.0, 1.0) * 100;
        out += format(
            "<tr><th>%s<td class=n>%.3f<td class=n>%.3f<td><div class=\"bar%s\"><i "
            "style=\"width:%.1f%%\"></i><b></b></div>"
            "<td><span class=\"verdict %s\">%s</span>\n",
            gate.name.c_str(), gate.value, gate.limit, gate.passed() ? "" : " over", part,
            gate.passed() ? "pass" : "fail", gate.passed() ? "passed" : "failed");
    }
    return out + "</tbody></table></div></section>\n";
}

/// What the figure of seams is made of.
std::string seams_section(const Quality& quality) {
    const Seams& seams = quality.seams;
    std::string out =
        "<section><h2>Seams, taken apart</h2><p>The figure of unblended seams is a product. <b>Place</b>: "
        "the steps that the two sources have of themselves where the border runs, against the photograph’s "
        "mean; "
        "below 1 where borders keep to quiet places. <b>Excess</b>: the steps between the sources against "
        "those; 1 as if both were one. A border along a dark gap may have a high place and no excess, and "
        "is not seen. <b>New edges</b> are pairs whose step is greater than either source’s own by more than "
        "is just seen (2.3 units of CIELAB). <b>Quietest</b>: the photograph’s own steps along the "
        "curves of the smallest sum around some of its places, as large as a patch, with nothing exchanged: "
        "an estimate of what no place can be much below.</p><div class=wide><table data-seams><thead><tr><th>"
        "<th class=n>Seams<th class=n>Place<th class=n>Excess<th class=n>New edges<th "
        "class=n>Quietest</thead><tbody>\n";
    const auto row = [&](const char* name, double Steps::*part, bool counts_edges) {
        const auto figure = [](bool known, double value) {
            return "<td class=n>" + (known ? format("%.3f", value) : std::string{"–"});
        };
        const bool natural = seams.natural_steps > 0;
        out += format("<tr><th>%s", name) + figure(true, seams.hard_ratio.*part) +
               figure(natural, seams.natural_ratio.*part) + figure(natural, seams.excess.*part) +
               "<td class=n>" + (counts_edges && natural ? percent(seams.new_edges) : "") +
               figure(seams.quiet_steps > 0, seams.quiet_ratio.*part) + "\n";
    };
    row("Mean", &Steps::mean, true);
    row("99th percentile", &Steps::percentile_99, false);
    return out + "</tbody></table></div></section>\n";
}

std::string previews_section(const ReportPictures& pictures) {
    std::string out =
        "<section><h2>Previews</h2><p>2048 × 2048 texels of a level, beside the tile repeated. Click for the "
        "texels themselves.</p><div class=levels>";
    for (const auto& preview : pictures.previews)
        out += format("<button data-level=%d aria-pressed=false>Level %d</button>", preview.level,
                      preview.level);
    out += "</div>\n";
    for (const auto& preview : pictures.previews) {
        const std::string level = std::to_string(preview.level);
        out +=
            "<div class=pair data-preview=" + level + "><figure>" +
            zoomable("preview-" + level, preview.texture, "The texture at level " + level, "preview") +
            "<figcaption><b>Texture</b>, level " + level + "</figcaption></figure><figure>" +
            format(
                "<button class=\"picture preview shows-repeat-%d\" data-zoom=\"%d %d\" data-period=\"%dpx\" "
                "style=\"aspect-ratio:1;background-size:%.4f%%\" aria-label=\"The tile repeated, level %d\" "
                "title=\"Click to enlarge\"></button>",
                preview.level, preview.texture.width, preview.texture.height, preview.tile.width,
                100.0 * preview.tile.width / preview.texture.width, preview.level) +
            "<figcaption><b>The tile repeated</b>, level " + level + "</figcaption></figure></div>\n";
    }
    return out + "</section>\n";
}

std::string tile_section(const ExchangeAsset& asset, const ReportPictures& pictures, const Quality& quality) {
    std::string out =
        "<section><h2>Tile</h2><p>What repeats where nothing is exchanged, and what is exchanged "
        "where.</p><div class=pair><figure>" +
        zoomable("tile", pictures.tile, "The periodic tile") +
        "<figcaption><b>Periodic tile</b></figcaption></figure>\n";
    if (asset.method == ExchangeMethod::content_exchange)
        out += "<figure>" + zoomable("patches", pictures.patches, "The patch map") +
               "<figcaption><b>Patch map</b>, with the numbers of the patches</figcaption></figure>\n";
    if (asset.method == ExchangeMethod::interchange)
        out += "<figure>" +
               zoomable("patches", pictures.patches, "How many patches cover each texel of the tile") +
               heat_legend("none", std::to_string(pictures.greatest_coverage) + " patches") +
               "<figcaption><b>Coverage</b>: patches of the library that lie over each "
               "texel</figcaption></figure>\n";
    out += "<figure>" + zoomable("seams", pictures.seam_energy, "Energy of the seams") +
           heat_legend("as the photograph’s own steps: " + format("%.2f", quality.seams.exemplar.mean),
                       format("%.0f times that", seam_full_scale)) +
           "<figcaption><b>Seam energy</b>, unblended: where seams lie, and what they "
           "cost</figcaption></figure></div></section>\n";
    return out;
}

std::string shares_section(const ReportPictures& pictures, const Quality& quality) {
    const TileShare& share = quality.share;
    std::string out =
        "<section><h2>What repeats where</h2><p>How often each place of the tile shows the tile itself, and "
        "how likely two occurrences of the "
        "tile show the same there" +
        format(", over %lld occurrences.</p><div class=pair><figure>",
               static_cast<long long>(share.occurrences)) +
        zoomable("share", pictures.tile_share, "How often each place shows the tile", "cells") +
        heat_legend("never", "always") +
        "<figcaption><b>Shows the tile itself</b></figcaption></figure><figure>" +
        zoomable("repeat", pictures.repeat_rate, "How likely two occurrences show the same", "cells") +
        heat_legend("never", "always") +
        "<figcaption><b>Shows the same twice</b></figcaption></figure><figure>" +
        zoomable("mean", pictures.mean_tile, "The mean of all occurrences") +
        "<figcaption><b>Mean of all occurrences</b>: what of the period can be seen from afar; plain grey is "
        "best</figcaption></figure></div>\n<div class=wide><table "
        "data-shares><thead><tr><th><th class=n>Mean"
        "<th class=n>Greatest<th class=n>Corner<th class=n>Border<th class=n title=\"Independent draws with "
        "the mean rate, and three standard deviations\">Chance"
        "<th class=n title=\"Cells of 8 × 8 texels that repeat more often than chance\">Beyond "
        "chance</thead><tbody>\n";
    const auto row = [&](const char* name, const TileShare::Figure& figure, const std::string& chance,
                         const std::string& beyond) {
        out += format("<tr><th>%s", name);
        for (const double value : {figure.mean, figure.greatest, figure.corner, figure.border})
            out += "<td class=n>" + percent(value);
        out += "<td class=n>" + chance + "<td class=n>" + beyond + "\n";
    };
    row("Shows the tile itself", share.tile, "", "");
    row("Shows the same twice", share.repeat, percent(share.chance), percent(share.beyond_chance));
    if (quality.kolar) {
        row("The tile itself, <code>choice: kolar</code>", quality.kolar->tile, "", "");
        row("The same twice, <code>choice: kolar</code>", quality.kolar->repeat,
            percent(quality.kolar->chance), percent(quality.kolar->beyond_chance));
    }
    return out + "</tbody></table></div></section>\n";
}

std::string repetition_section(const Quality& quality) {
    std::string out =
        "<section><h2>Repetition</h2><p>Autocorrelation of lightness for shifts by whole tiles, in "
        "hundredths; 100 is the plain tile. “Elsewhere” is the "
        "greatest for as many shifts that are half a tile off: what chance shows.</p><div class=pair>\n";
    for (const auto& level : quality.repetition.levels) {
        out += format("<figure><h3>Level %d</h3><table class=shifts><tr><td>", level.level);
        for (int x = -3; x <= 3; ++x) out += format("<th>%+d", x);
        for (int y = -3; y <= 3; ++y) {
            out += format("<tr><th>%+d", y);
            for (int x = -3; x <= 3; ++x) {
                const auto found = std::find_if(
                    level.shifts.begin(), level.shifts.end(), [&](const Repetition::Shift& shift) {
                        return (shift.x == x && shift.y == y) || (shift.x == -x && shift.y == -y);
                    });
                if (found == level.shifts.end()) {
                    out += "<td title=\"No shift\">·";
                    continue;
                }
                const double strength = std::clamp(found->value / 0.25, 0.0, 1.0);
                out += format(
                    "<td style=\"background:color-mix(in srgb, var(--bad) %.0f%%, transparent)\" "
                    "title=\"%.4f for a shift by (%d, %d) tiles\">%.1f",
                    strength * 80, found->value, x, y, found->value * 100);
            }
        }
        out += format(
            "</table><figcaption>Greatest <b>%.2f</b> at (%+.0f, %+.0f), mean %.2f, elsewhere "
            "%.2f</figcaption></figure>\n",
            level.greatest.value * 100, level.greatest.x, level.greatest.y, level.mean * 100,
            level.elsewhere * 100);
        if (level.farther)
            out += format(
                "<p>By 4 to 8 tiles, where units of several tiles may be alike: greatest <b>%.2f</b> "
                "at (%+.0f, %+.0f).</p>\n",
                level.farther->value * 100, level.farther->x, level.farther->y);
    }
    return out + "</div></section>\n";
}

/// A chart of two histograms between the values that hold nearly all of both.
std::string chart(const char* name, const Histogram& own, const Histogram& made, double apart) {
    constexpr int columns = 96;
    const double first = std::min(own.percentile(0.002), made.percentile(0.002));
    const double last = std::max({own.percentile(0.998), made.percentile(0.998), first + 1});
    const auto heights = [&](const Histogram& histogram) {
        std::vector<double> out(columns);
        for (std::size_t bin = 0; bin < histogram.counts().size(); ++bin) {
            const double value =
                double(histogram.lowest()) + (double(bin) + 0.5) / double(Histogram::bins_per_unit);
            const double column = (value - first) / (last - first) * columns;
            if (column >= 0 && column < columns)
                out[static_cast<std::size_t>(column)] +=
                    double(histogram.counts()[bin]) / double(std::max<std::uint64_t>(histogram.count(), 1));
        }
        return out;
    };
    const std::vector<double> a = heights(own), b = heights(made);
    const double highest =
        std::max({*std::max_element(a.begin(), a.end()), *std::max_element(b.begin(), b.end()), 1e-9});
    std::string area = "M0 100", line;
    for (int column = 0; column < columns; ++column) {
        const auto i = static_cast<std::size_t>(column);
        area += format("L%d %.1fH%d", column, 100 - 96 * a[i] / highest, column + 1);
        line +=
            format("%s%d %.1fH%d", column == 0 ? "M" : "L", column, 100 - 96 * b[i] / highest, column + 1);
    }
    return format(
               "<figure><svg viewBox=\"0 0 %d 100\" preserveAspectRatio=none role=img "
               "aria-label=\"%s\"><path class=own d=\"",
               columns, name) +
           area + format("V100Z\"/><path class=made d=\"") + line +
           format(
               "\"/></svg><div class=ends><span>%.1f</span><span>%.1f</span></div><figcaption><b>%s</b>: "
               "%.2f units apart</figcaption></figure>\n",
               first, last, name, apart);
}

std::string fidelity_section(const Quality& quality) {
    const Fidelity& fidelity = quality.fidelity;
    std::string out =
        "<section><h2>Fidelity</h2><p>Histograms of the photograph (filled) and of the texture (line). The "
        "distance is how far values have to move on "
        "average to turn one into the other, in units of CIELAB; one unit is just about seen.</p><div "
        "class=pair>\n";
    const auto& own = fidelity.exemplar_curves;
    const auto& made = fidelity.texture_curves;
    out += chart("Lightness", own.lightness, made.lightness, fidelity.texture.lightness);
    out += chart("Green to red", own.green_red, made.green_red, fidelity.texture.green_red);
    out += chart("Blue to yellow", own.blue_yellow, made.blue_yellow, fidelity.texture.blue_yellow);
    out += chart("Steps between neighbours", own.steps, made.steps, fidelity.texture.steps);
    out +=
        "</div><div class=wide><table><thead><tr><th>Distance from the photograph<th class=n>Lightness<th "
        "class=n>Green to red<th class=n>Blue to yellow"
        "<th class=n>Steps</thead><tbody>";
    const auto row = [&](const char* name, const Fidelity::Distances& d) {
        out += format("<tr><th>%s<td class=n>%.2f<td class=n>%.2f<td class=n>%.2f<td class=n>%.2f\n", name,
                      d.lightness, d.green_red, d.blue_yellow, d.steps);
    };
    row("Texture", fidelity.texture);
    row("Plain tile", fidelity.tile);
    return out + "</tbody></table></div></section>\n";
}

std::string contents_section(const ExchangeAsset& asset, const ContentSheets& contents) {
    std::string out = format(
        "<section style=\"--side:%dpx\"><h2>Contents</h2><p>Each with its number, patch:content, which "
        "<code>--drop</code> and <code>--keep</code> take, on the tile "
        "around it. The figure behind is its seam to the tile against the photograph’s own steps; red is "
        "more than 1.5.</p>\n",
        contents.thumbnail_side);
    const bool by_patch = asset.method == ExchangeMethod::content_exchange;
    const std::size_t none = asset.patches.size();
    std::size_t patch = none;
    if (!by_patch) out += "<div class=contents>\n";
    for (const ContentFacts& facts : contents.contents) {
        if (by_patch && facts.patch != patch) {
            if (patch != none) out += "</div></details>\n";
            patch = facts.patch;
            out += format("<details%s><summary>Patch %zu, %zu contents</summary><div class=contents>\n",
                          patch < 4 ? " open" : "", patch, asset.patches[patch].contents.size());
        }
        const auto& content = asset.patches[facts.patch].contents[facts.content - 1];
        const char* standing = content.standing == ExchangeAsset::Standing::dropped  ? " dropped"
                               : content.standing == ExchangeAsset::Standing::pinned ? " pinned"
                                                                                     : "";
        std::string corners;
        if (asset.method == ExchangeMethod::wang)
            for (int corner = 0; corner < 4; ++corner)
                corners += static_cast<char>('0' + (content.corners >> (2 * corner) & 3));
        const std::string words = format(
            "%zu:%zu%s, %d texels from (%d, %d) of the exemplar%s%s, seam %.2f times the photograph’s steps",
            facts.patch, facts.content, standing, facts.texels, content.at.x, content.at.y,
            corners.empty() ? "" : ", corners ", corners.c_str(), facts.seam_ratio);
        out += format(
            "<button class=\"content%s%s\" data-zoom=\"%d %d\" data-at=\"-%dpx -%dpx\" title=\"%s\" "
            "aria-label=\"%s\"><i class=\"shows-sheet-%zu\" "
            "style=\"background-position:-%dpx -%dpx\"></i><span>%zu:%zu · %.2f</span></button>\n",
            standing, facts.seam_ratio > 1.5 ? " costly" : "", contents.thumbnail_side,
            contents.thumbnail_side, facts.x, facts.y, words.c_str(), words.c_str(), facts.sheet, facts.x,
            facts.y, facts.patch, facts.content, facts.seam_ratio);
    }
    if (!by_patch || patch != none) out += by_patch ? "</div></details>\n" : "</div>\n";
    if (contents.left_out > 0) out += format("<p>%zu more are not shown.</p>", contents.left_out);
    return out + "</section>\n";
}

/// Every picture once, as a rule of its own: a variable of the style sheet may not be as long as a picture.
std::string backgrounds(const ReportPictures& pictures) {
    std::string out;
    const auto add = [&](const std::string& name, const EmbeddedPicture& picture) {
        if (!picture.address.empty())
            out += ".shows-" + name + "{background-image:url(" + picture.address + ")}\n";
    };
    add("tile", pictures.tile);
    add("patches", pictures.patches);
    add("seams", pictures.seam_energy);
    add("mean", pictures.mean_tile);
    add("share", pictures.tile_share);
    add("repeat", pictures.repeat_rate);
    for (const auto& preview : pictures.previews) {
        add("preview-" + std::to_string(preview.level), preview.texture);
        add("repeat-" + std::to_string(preview.level), preview.tile);
    }
    for (std::size_t i = 0; i < pictures.sheets.size(); ++i)
        add("sheet-" + std::to_string(i), pictures.sheets[i]);
    return out;
}

}  // namespace

std::string report_page(const std::string& title, const ExchangeAsset& asset, const Quality& quality,
                        const ContentSheets& contents, const ReportPictures& pictures) {
    return "<!doctype html>\n<html lang=en>\n<meta charset=utf-8>\n<meta name=viewport "
           "content=\"width=device-width\">\n<title>" +
           escaped(title) + " · Tessera</title>\n<link rel=icon href=\"data:,\">\n<style>" + report_style +
           backgrounds(pictures) + "</style>\n<main>\n" + header(title, asset, quality, contents) +
           gates_section(quality) + seams_section(quality) + previews_section(pictures) +
           tile_section(asset, pictures, quality) + shares_section(pictures, quality) +
           repetition_section(quality) + fidelity_section(quality) + contents_section(asset, contents) +
           "</main>\n<dialog aria-label=\"Enlarged picture\"><header><span data-words></span><span>wheel or "
           "+ − zooms, drag or arrows move</span>"
           "<span><button data-fit>Fit</button> <button data-close>Close</button></span></header><div "
           "class=stage></div></dialog>\n<script type=module>" +
           report_script + "</script>\n</html>\n";
}

}  // namespace tessera
