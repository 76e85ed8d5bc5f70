#include "server/accuracy/report_page.h"

#include <array>
#include <cstdio>

#include "server/accuracy/filter_family.h"
#include "server/accuracy/page_files.h"
#include "server/accuracy/row_pictures.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

/// JSON that may stand inside <script>.
std::string for_script(const std::string& json) {
    std::string out;
    out.reserve(json.size());
    for (const char c : json) {
        if (c == '<')
            out += "\\u003c";
        else if (c != '\n')
            out += c;
    }
    return out;
}

std::string families_json() {
    std::string out = "[";
    for (const FilterFamily& family : filter_families) {
        std::array<char, 160> text{};
        std::snprintf(text.data(), text.size(), "%s[\"%.*s\",\"%.*s\",\"#%02x%02x%02x\"]",
                      out.size() > 1 ? "," : "", int(family.prefix.size()), family.prefix.data(),
                      int(family.title.size()), family.title.data(), family.color[0], family.color[1],
                      family.color[2]);
        out += text.data();
    }
    return out + "]";
}

std::string situations_json() {
    std::string out = "[";
    for (const Situation& situation : situations(16, 16))
        out += (out.size() > 1 ? ",[\"" : "[\"") + std::string{situation.name} + "\",\"" +
               std::string{situation.title} + "\"]";
    return out + "]";
}

void replace(std::string& text, std::string_view mark, const std::string& with) {
    if (const auto at = text.find(mark); at != std::string::npos) text.replace(at, mark.size(), with);
}

}  // namespace

std::string report_page(const proto::AccuracyReport& report) {
    std::string page{page_html};
    replace(page, "/*STYLE*/", std::string{page_style});
    replace(page, "/*FAMILIES*/", families_json());
    replace(page, "/*SITUATIONS*/", situations_json());
    replace(page, "/*SCRIPT*/", std::string{page_script});
    replace(page, "/*REPORT*/", for_script(write_json(report)));
    return page;
}

}  // namespace tessera
