#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace tri::io_detail {

/// RFC 4648, with "=" to a multiple of four characters.
std::string to_base64(std::string_view bytes);

/// The reverse; "=" at the end may be missing. Nothing if a character is no digit of base 64 or the length cannot be.
std::optional<std::string> from_base64(std::string_view text);

}  // namespace tri::io_detail
