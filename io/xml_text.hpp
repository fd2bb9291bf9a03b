#pragma once

#include <string>
#include <string_view>

namespace tri::io_detail {

/// Text as it may stand within an attribute of XML; what XML cannot hold at all (control characters) becomes "?".
inline std::string xml_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += static_cast<unsigned char>(c) < 32 ? '?' : c;
  }
  return out;
}

}  // namespace tri::io_detail
