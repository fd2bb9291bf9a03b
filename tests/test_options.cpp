#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "meshops/error.hpp"
#include "meshops/options.hpp"

using namespace tri;

namespace {

enum class Color { red, green };

struct SampleOptions {
  int max_edges = 100;
  double max_length = std::numeric_limits<double>::infinity();
  double sharp_angle = 0.5;
  double ratio = 0.25;
  bool keep = false;
  Color color = Color::green;
  std::string label = "none";
  std::vector<double> levels = {1, 2.5};

  static const OptionSchema& schema() {
    using O = SampleOptions;
    static const OptionSchema schema =
        Schema<O>()
            .integer("max-edges", &O::max_edges, {.unit = "edges", .min = 3, .max = 1000, .help = "longest loop"})
            .number("max-length", &O::max_length, {.unit = "mm", .min = 0, .min_open = true, .infinite = true})
            .angle("sharp-angle", &O::sharp_angle, {.min = 0, .max = 180})
            .number("ratio", &O::ratio, {.min = 0, .max = 1, .max_open = true})
            .boolean("keep", &O::keep, {.help = "keep it"})
            .choice("color", &O::color, {{"red", Color::red}, {"green", Color::green}}, {})
            .text("label", &O::label, {})
            .numbers("levels", &O::levels, {.min = 0});
    return schema;
  }
};

const OptionSchema& schema() {
  return SampleOptions::schema();
}

/// The message of the InvalidInput that setting `name` to `value` throws; checks that the options did not change.
std::string refusal(std::string_view name, const Json& value) {
  SampleOptions options;
  const Json before = schema().to_json(&options, true);
  std::string message;
  try {
    schema().set_json(&options, name, value);
  } catch (const InvalidInput& error) {
    message = error.what();
  }
  CHECK(schema().to_json(&options, true) == before);
  return message;
}

bool mentions(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("options: defaults are those of a default-constructed struct") {
  const Json description = schema().describe();
  REQUIRE(description.size() == 8);
  CHECK(description[0] == Json{{"name", "max-edges"},
                               {"type", "integer"},
                               {"default", 100},
                               {"unit", "edges"},
                               {"minimum", 3},
                               {"maximum", 1000},
                               {"help", "longest loop"}});
  CHECK(description[1]["default"] == "inf");
  CHECK(description[1]["above"] == 0);
  CHECK(description[3]["below"] == 1);
  CHECK(description[5]["choices"] == Json{"red", "green"});
  const SampleOptions defaults;
  CHECK(schema().to_json(&defaults) == Json::object());
  CHECK(schema().to_text(&defaults).empty());
}

TEST_CASE("options: JSON and text give the same struct and come back") {
  SampleOptions from_json, from_text;
  const Json json = {{"max-edges", 50}, {"max-length", 2.5}, {"sharp-angle", 30}, {"ratio", 0.1},
                     {"keep", true},    {"color", "red"},    {"label", "a b"},    {"levels", {3, 4.5}}};
  for (const auto& [name, value] : json.items()) schema().set_json(&from_json, name, value);
  CHECK(from_json.max_edges == 50);
  CHECK(from_json.max_length == 2.5);
  CHECK(from_json.sharp_angle == doctest::Approx(std::numbers::pi / 6).epsilon(1e-15));
  CHECK(from_json.keep);
  CHECK(from_json.color == Color::red);
  CHECK(from_json.levels == std::vector<double>{3, 4.5});
  CHECK(schema().to_json(&from_json) == json);
  for (const auto& [name, text] : schema().to_text(&from_json)) schema().set_text(&from_text, name, text);
  CHECK(schema().to_json(&from_text, true) == schema().to_json(&from_json, true));
  CHECK(from_text.sharp_angle == from_json.sharp_angle);
}

TEST_CASE("options: infinity is spelt inf where it is allowed") {
  SampleOptions options;
  options.max_length = 1;
  schema().set_json(&options, "max-length", "inf");
  CHECK(std::isinf(options.max_length));
  schema().set_text(&options, "max-length", "4");
  schema().set_text(&options, "max-length", "inf");
  CHECK(std::isinf(options.max_length));
  CHECK_THROWS_AS(schema().set_text(&options, "ratio", "inf"), InvalidInput);
  CHECK_THROWS_AS(schema().set_text(&options, "max-length", "-inf"), InvalidInput);
  CHECK_THROWS_AS(schema().set_text(&options, "max-length", "nan"), InvalidInput);
}

TEST_CASE("options: a refusal names key, value and what is allowed, and changes nothing") {
  const std::string range = refusal("max-edges", 2);
  CHECK(mentions(range, "max-edges = 2"));
  CHECK(mentions(range, "from 3 to 1000"));
  CHECK(mentions(refusal("max-edges", 1001), "1001"));
  CHECK(mentions(refusal("max-edges", 3.5), "whole number"));
  CHECK(mentions(refusal("max-edges", 1e300), "whole number"));
  CHECK(mentions(refusal("max-edges", "many"), "many"));
  CHECK(mentions(refusal("max-length", 0), "above 0"));
  CHECK(mentions(refusal("ratio", 1), "below 1"));
  CHECK(mentions(refusal("sharp-angle", 181), "180 (deg)"));
  CHECK(mentions(refusal("keep", 1), "true or false"));
  CHECK(mentions(refusal("color", "blue"), "red, green"));
  CHECK(mentions(refusal("levels", Json{1, -1}), "from 0"));
  CHECK(mentions(refusal("levels", 1), "numbers"));
  const std::string unknown = refusal("max-edge", 5);
  CHECK(mentions(unknown, "max-edge;"));
  CHECK(mentions(unknown, "max-edges, max-length"));
  CHECK(refusal("max-edges", true) != "");
}

TEST_CASE("options: text that is not wholly a value is refused") {
  SampleOptions options;
  for (const char* text : {"", "5x", "0x10", " 5", "5 ", "5,"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(schema().set_text(&options, "max-edges", text), InvalidInput);
  }
  CHECK_THROWS_AS(schema().set_text(&options, "keep", "yes"), InvalidInput);
  CHECK_THROWS_AS(schema().set_text(&options, "levels", "1,,2"), InvalidInput);
  CHECK_THROWS_AS(schema().set_text(&options, "levels", "1,"), InvalidInput);
  CHECK(options.max_edges == 100);
}

TEST_CASE("options: validate finds values set from C++") {
  SampleOptions options;
  CHECK_NOTHROW(validate(options));
  options.max_edges = 2;
  CHECK_THROWS_AS(validate(options), InvalidInput);
  options = {};
  options.ratio = std::nan("");
  CHECK_THROWS_AS(validate(options), InvalidInput);
  options = {};
  options.color = static_cast<Color>(7);
  CHECK_THROWS_AS(validate(options), InvalidInput);
  options = {};
  options.sharp_angle = std::numbers::pi;
  CHECK_NOTHROW(validate(options));
  options.sharp_angle = std::nextafter(std::numbers::pi, 4);
  CHECK_THROWS_AS(validate(options), InvalidInput);
}

TEST_CASE("options: degrees are short and come back to the same radians") {
  for (const int degrees : {0, 1, 5, 30, 33, 45, 90, 120, 179, 180, 360}) {
    CAPTURE(degrees);
    CHECK(to_degrees(to_radians(degrees)) == degrees);
    CHECK(to_radians(degrees) == doctest::Approx(degrees / 180.0 * std::numbers::pi).epsilon(1e-15));
  }
}

TEST_CASE("options: a schema that cannot be right is refused") {
  CHECK_THROWS_AS(Schema<SampleOptions>().boolean("Keep", &SampleOptions::keep, {}), InvalidInput);
  CHECK_THROWS_AS(Schema<SampleOptions>().boolean("no-keep", &SampleOptions::keep, {}), InvalidInput);
  CHECK_THROWS_AS(Schema<SampleOptions>().integer("max-edges", &SampleOptions::max_edges, {.max = 99}), InvalidInput);
  CHECK_THROWS_AS(
      Schema<SampleOptions>().boolean("keep", &SampleOptions::keep, {}).boolean("keep", &SampleOptions::keep, {}),
      InvalidInput);
}
