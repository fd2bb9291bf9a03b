#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

namespace tri {

/// `text` as the content of an HTML element or a quoted attribute: & < > " ' become entities. Bytes that are not UTF-8
/// and control characters become U+FFFD, so that a file name of any bytes gives a valid page.
std::string html_escape(std::string_view text);

/// JSON that may stand inside <script>: no "<", ">" or "&" is left in it.
std::string json_for_script(const nlohmann::ordered_json& value);

/// Base64 (RFC 4648, with padding) of the bytes of `values`, little endian.
std::string base64(std::string_view bytes);
template <class Value>
std::string base64_of(std::span<const Value> values) {
  return base64({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
}

/// How many decimals show numbers of a range about 0 well: 4 for 0.05 to 0.49, 3 for 0.5, 1 for 50; 0 to 9.
int decimals_for(double range);

/// A number with so many decimals, without and with a plus; a zero has no sign.
std::string fixed_text(double value, int decimals);
std::string signed_text(double value, int decimals);

}  // namespace tri
