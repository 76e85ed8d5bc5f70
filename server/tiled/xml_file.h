#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <pugixml.hpp>
#include <string>

#include "shared/result/result.h"

namespace tessera {

/// Parses a file of at most 64 MiB whose root is `root`. Nothing outside it is read: document types and
/// entities beyond XML's own five are passed over. Error: invalid_input, io_failure, which name the file.
Result<pugi::xml_document> read_xml(const std::filesystem::path& file, const char* root);

/// Reads attributes, and remembers the first that is wrong.
class XmlNumbers {
  public:
    explicit XmlNumbers(std::filesystem::path file) : file_{std::move(file)} {}

    /// The attribute as an integer within the range; `missing` if it is not there, which without one is
    /// wrong.
    std::int64_t integer(const pugi::xml_node& node, const char* name, std::int64_t least, std::int64_t most,
                         std::optional<std::int64_t> missing = {});
    /// A finite number.
    double number(const pugi::xml_node& node, const char* name, double missing);

    Error wrong(const pugi::xml_node& node, const std::string& what) const;
    void fail(const pugi::xml_node& node, const std::string& what);
    const std::optional<Error>& error() const noexcept { return error_; }
    const std::filesystem::path& file() const noexcept { return file_; }

  private:
    std::filesystem::path file_;
    std::optional<Error> error_;
};

}  // namespace tessera
