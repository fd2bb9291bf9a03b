#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/html/html_report.hpp"

namespace tri {

/// The data of a page's picture.
struct HtmlScene {
  nlohmann::ordered_json json;     ///< what the page's script reads, arrays as base64
  std::string picture;             ///< the static picture, a PNG file in base64
  std::vector<std::string> notes;  ///< what was thinned
};

/// @throws as `html_page`
HtmlScene html_scene(const HtmlReport& report, Context& context);

}  // namespace tri
