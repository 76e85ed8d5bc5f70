#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "shared/result/result.h"

namespace tessera {

/// The built web page, read into memory once: no request ever touches the disk.
class WebFiles {
  public:
    struct File {
        std::string content_type;
        std::string etag;
        bool immutable = false;  ///< Its name holds a hash of its content.
        std::vector<std::uint8_t> bytes;
        std::vector<std::uint8_t> gzip;  ///< Empty where it would not be smaller.
    };

    /// Reads `folder`. Errors: io_failure if it cannot be read, invalid_input if it is larger than 64 MiB.
    static Result<std::shared_ptr<const WebFiles>> read(const std::filesystem::path& folder);
    /// One plain page that says how to build the real one.
    static std::shared_ptr<const WebFiles> plain();

    /// `path` is relative to the folder, percent-decoded, without a leading slash; empty is index.html. Null
    /// if there is no such file.
    const File* find(std::string_view path) const;

  private:
    std::map<std::string, File, std::less<>> files_;
};

}  // namespace tessera
