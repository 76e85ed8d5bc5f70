#include "server/http/web_files.h"

#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>

#include <libdeflate.h>
#include <xxhash.h>

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_bytes = std::size_t{64} << 20;

struct Kind {
    std::string_view extension, content_type;
    bool text;
};
constexpr std::array kinds{Kind{".html", "text/html; charset=utf-8", true},
                           Kind{".js", "text/javascript; charset=utf-8", true},
                           Kind{".mjs", "text/javascript; charset=utf-8", true},
                           Kind{".css", "text/css; charset=utf-8", true},
                           Kind{".json", "application/json", true},
                           Kind{".map", "application/json", true},
                           Kind{".svg", "image/svg+xml", true},
                           Kind{".txt", "text/plain; charset=utf-8", true},
                           Kind{".webmanifest", "application/manifest+json", true},
                           Kind{".wasm", "application/wasm", true},
                           Kind{".png", "image/png", false},
                           Kind{".jpg", "image/jpeg", false},
                           Kind{".webp", "image/webp", false},
                           Kind{".ico", "image/x-icon", false},
                           Kind{".woff2", "font/woff2", false}};

WebFiles::File make_file(std::string_view extension, std::vector<std::uint8_t> bytes) {
    WebFiles::File file;
    file.content_type = "application/octet-stream";
    bool text = false;
    for (const Kind& kind : kinds) {
        if (kind.extension != extension) continue;
        file.content_type = kind.content_type;
        text = kind.text;
    }
    char tag[24];
    std::snprintf(tag, sizeof tag, "\"%016llx\"",
                  static_cast<unsigned long long>(XXH3_64bits(bytes.data(), bytes.size())));
    file.etag = tag;
    file.bytes = std::move(bytes);
    if (text && file.bytes.size() > 512) {
        const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor{
            libdeflate_alloc_compressor(9), libdeflate_free_compressor};
        file.gzip.resize(file.bytes.size());
        file.gzip.resize(libdeflate_gzip_compress(compressor.get(), file.bytes.data(), file.bytes.size(),
                                                  file.gzip.data(), file.gzip.size()));
    }
    return file;
}

/// Bundlers write app-3f2a9c1b.js or app.3f2a9c1b.js: eight or more letters and digits, at least one of them
/// a digit, behind the last '-' or '.' of the stem.
bool has_hash(const fs::path& name) {
    const std::string stem = name.stem().string();
    const std::size_t mark = stem.find_last_of("-.");
    if (mark == std::string::npos || stem.size() - mark - 1 < 8) return false;
    bool digit = false;
    for (const char c : stem.substr(mark + 1)) {
        const bool is_digit = c >= '0' && c <= '9';
        if (!is_digit && !(c >= 'a' && c <= 'z') && !(c >= 'A' && c <= 'Z') && c != '_') return false;
        digit = digit || is_digit;
    }
    return digit;
}

constexpr std::string_view plain_page = R"(<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>Tessera</title>
<style>
  body { font: 16px/1.6 system-ui, sans-serif; max-width: 40rem; margin: 4rem auto; padding: 0 1rem; color: #1b1f24 }
  code { background: #eef0f3; padding: .1em .3em; border-radius: 3px }
</style>
<h1>Tessera is serving pages</h1>
<p>The viewer is not built yet. Build it with <code>npm ci &amp;&amp; npm run build</code> in
  <code>client/web</code>, or name its folder with <code>tessera serve --web FOLDER</code>.</p>
<p>Meanwhile: <a href="/scenes">the scenes</a> as JSON; each names its TileJSON, which any web map reads.</p>
</html>
)";

}  // namespace

Result<std::shared_ptr<const WebFiles>> WebFiles::read(const fs::path& folder) {
    auto files = std::make_shared<WebFiles>();
    std::error_code failure;
    std::size_t total = 0;
    for (fs::recursive_directory_iterator entry{folder, failure}, end; !failure && entry != end;
         entry.increment(failure)) {
        if (!entry->is_regular_file(failure)) continue;
        total += static_cast<std::size_t>(entry->file_size(failure));
        if (total > most_bytes)
            return Error{ErrorCode::invalid_input, folder.string() +
                                                       ": is larger than 64 MiB; --web names the "
                                                       "folder of the built web page alone"};
        std::ifstream in{entry->path(), std::ios::binary};
        std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>{in}, {}};
        if (!in) return Error{ErrorCode::io_failure, entry->path().string() + ": cannot be read"};
        File file = make_file(entry->path().extension().string(), std::move(bytes));
        file.immutable = has_hash(entry->path());
        files->files_.emplace(entry->path().lexically_relative(folder).generic_string(), std::move(file));
    }
    if (failure) return Error{ErrorCode::io_failure, folder.string() + ": " + failure.message()};
    if (files->find("") == nullptr)
        return Error{ErrorCode::invalid_input,
                     folder.string() + ": has no index.html; build the web page first"};
    return std::shared_ptr<const WebFiles>{std::move(files)};
}

std::shared_ptr<const WebFiles> WebFiles::plain() {
    auto files = std::make_shared<WebFiles>();
    files->files_.emplace("index.html", make_file(".html", {plain_page.begin(), plain_page.end()}));
    return files;
}

const WebFiles::File* WebFiles::find(std::string_view path) const {
    const auto found = files_.find(path.empty() ? "index.html" : path);
    return found == files_.end() ? nullptr : &found->second;
}

}  // namespace tessera
