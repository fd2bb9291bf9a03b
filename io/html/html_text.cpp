#include "io/html/html_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace tri {
namespace {

static_assert(std::endian::native == std::endian::little, "the page holds numbers as little endian");

// Length of the UTF-8 sequence at the beginning of `text`, 0 if there is none [RFC 3629].
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const unsigned a = byte(0);
  if (a < 0x80) return 1;
  const std::size_t length = a >= 0xc2 && a < 0xe0 ? 2 : a >= 0xe0 && a < 0xf0 ? 3 : a >= 0xf0 && a < 0xf5 ? 4 : 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  const bool overlong = (a == 0xe0 && byte(1) < 0xa0) || (a == 0xf0 && byte(1) < 0x90);
  const bool outside = (a == 0xed && byte(1) >= 0xa0) || (a == 0xf4 && byte(1) >= 0x90);
  return overlong || outside ? 0 : length;
}

}  // namespace

std::string html_escape(std::string_view text) {
  constexpr const char* replacement = "\xEF\xBF\xBD";
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const char c = text[0];
    if (length == 0 || (length == 1 && static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') || c == 0x7f)
      result += replacement;
    else if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else if (c == '\'')
      result += "&#39;";
    else
      result += text.substr(0, length);
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return result;
}

std::string json_for_script(const nlohmann::ordered_json& value) {
  std::string result;
  for (const char c : value.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace)) {
    if (c == '<')
      result += "\\u003c";
    else if (c == '>')
      result += "\\u003e";
    else if (c == '&')
      result += "\\u0026";
    else
      result += c;
  }
  return result;
}

std::string base64(std::string_view bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  result.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return i + k < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i + k])) : 0u;
    };
    const std::uint32_t group = byte(0) << 16 | byte(1) << 8 | byte(2);
    result += digits[group >> 18];
    result += digits[group >> 12 & 63];
    result += i + 1 < bytes.size() ? digits[group >> 6 & 63] : '=';
    result += i + 2 < bytes.size() ? digits[group & 63] : '=';
  }
  return result;
}

int decimals_for(double range) {
  if (!(range > 0) || !std::isfinite(range)) return 3;
  return std::clamp(3 - static_cast<int>(std::floor(std::log10(2 * range))), 0, 9);
}

std::string fixed_text(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  return text[0] == '-' && text.find_first_of("123456789") == std::string::npos ? text.substr(1) : text;
}

std::string signed_text(double value, int decimals) {
  std::string text = fixed_text(value, decimals);
  return text[0] != '-' && text.find_first_of("123456789") != std::string::npos ? '+' + text : text;
}

}  // namespace tri
