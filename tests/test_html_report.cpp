#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <regex>

#include "io/html/html_charts.hpp"
#include "io/html/html_report.hpp"
#include "io/html/html_text.hpp"
#include "meshops/error.hpp"
#include "meshops/version.hpp"
#include "temporary_folder.hpp"

using namespace tri;

namespace {

Soup sheet(int cells) {
  Soup soup;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      soup.points.push_back({double(i), double(j), 100});
      soup.vertex_scalars["deviation"].push_back(0.01 * (i - j));
      soup.vertex_scalars["cad_face"].push_back(1 + i % 2);
    }
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (cells + 1) + i), b = a + static_cast<std::uint32_t>(cells) + 1;
      soup.triangles.push_back({a, a + 1, b + 1});
      soup.triangles.push_back({a, b + 1, b});
    }
  return soup;
}

HtmlReport report_of(const Soup& soup) {
  HtmlReport report;
  report.title = "part";
  report.scene = &soup;
  report.scale = {-0.02, 0.02, true};
  return report;
}

std::string page_of(const HtmlReport& report) {
  Context context;
  return html_page(report, context);
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

nlohmann::json scene_of(const std::string& page) {
  const std::string begin = R"(<script type="application/json" id="scene">)";
  const auto at = page.find(begin) + begin.size();
  return nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
}

}  // namespace

TEST_CASE("html_escape: nothing that HTML reads is left, and bytes that are no text become a replacement") {
  CHECK(html_escape("<script>alert('x' & \"y\")</script>") ==
        "&lt;script&gt;alert(&#39;x&#39; &amp; &quot;y&quot;)&lt;/script&gt;");
  CHECK(html_escape("Prüfling \xE2\x82\xAC \xF0\x9F\x94\xA9") == "Prüfling \xE2\x82\xAC \xF0\x9F\x94\xA9");
  const std::string bad = "\xEF\xBF\xBD";
  for (const char* bytes : {"\xFF", "\xC0", "\x80", "\x01", "\x7f"}) CHECK(html_escape(bytes) == bad);
  CHECK(html_escape("\xE2\x82") == bad + bad);            // cut off
  CHECK(html_escape("\xED\xA0\x80") == bad + bad + bad);  // a surrogate
  CHECK(html_escape("\xC1\xBC") == bad + bad);            // an overlong '<'... must not become one
  CHECK(html_escape("a\xFFz") == "a" + bad + "z");
  CHECK(html_escape("") == "");
}

TEST_CASE("json_for_script: cannot end the script it stands in, and reads back as the same") {
  const nlohmann::ordered_json value{{"name", "</script><!-- & \u00e4"}, {"list", {1, 2.5}}};
  const std::string text = json_for_script(value);
  CHECK(text.find_first_of("<>&") == std::string::npos);
  CHECK(nlohmann::ordered_json::parse(text) == value);
}

TEST_CASE("base64: the vectors of RFC 4648") {
  CHECK(base64("") == "");
  CHECK(base64("f") == "Zg==");
  CHECK(base64("fo") == "Zm8=");
  CHECK(base64("foo") == "Zm9v");
  CHECK(base64("foobar") == "Zm9vYmFy");
  CHECK(base64(std::string("\xff\xfe\xfd", 3)) == "//79");
  const std::vector<std::uint16_t> numbers{1, 256};
  CHECK(base64_of(std::span<const std::uint16_t>(numbers)) == base64(std::string("\1\0\0\1", 4)));
}

TEST_CASE("decimals_for: three digits of the greatest number shown") {
  CHECK(decimals_for(0.05) == 4);
  CHECK(decimals_for(0.1) == 4);
  CHECK(decimals_for(1) == 3);
  CHECK(decimals_for(50) == 1);
  CHECK(decimals_for(1e7) == 0);
  CHECK(decimals_for(1e-12) == 9);
  CHECK(decimals_for(0) == 3);
  CHECK(fixed_text(-0.0004, 3) == "0.000");
  CHECK(fixed_text(-0.0006, 3) == "-0.001");
  CHECK(signed_text(0.0004, 3) == "0.000");
  CHECK(signed_text(12, 1) == "+12.0");
  CHECK(signed_text(-12, 0) == "-12");
}

TEST_CASE("deviation_color: the ends of the scale are blue and red, 0 is neutral also where the ends differ") {
  const DeviationScale scale{-0.1, 0.4, true};
  CHECK(deviation_color(0, scale) == diverging_color(0));
  CHECK(deviation_color(-0.1, scale) == diverging_color(-1));
  CHECK(deviation_color(0.4, scale) == diverging_color(1));
  CHECK((deviation_color(0.2, scale) - diverging_color(0.5)).norm() < 1e-12);
  // Beyond a tolerance there is a colour that is none of the scale's; without one the ends go on.
  for (const double beyond : {-0.11, 0.41}) {
    for (double t = -1; t <= 1; t += 0.01) CHECK((deviation_color(beyond, scale) - diverging_color(t)).norm() > 0.3);
    CHECK(deviation_color(beyond, {-0.1, 0.4, false}) == diverging_color(beyond < 0 ? -1 : 1));
  }
  CHECK(deviation_color(std::nan(""), scale) == missing_color());
  CHECK(deviation_color(1.5, {1, 2, false}) == diverging_color(0));
}

TEST_CASE("legend_svg: says the ends of the tolerance") {
  const std::string legend = legend_svg({-0.1, 0.25, true}, "mm");
  CHECK(count(legend, ">-0.1<") + count(legend, ">-0.10<") == 1);
  CHECK(count(legend, ">+0.25<") == 1);
  CHECK(count(legend, ">above<") == 1);
  CHECK(count(legend, ">below<") == 1);
  CHECK(count(legend_svg({-1, 1, false}, "mm"), ">above<") == 0);
  CHECK(count(legend_svg({-1, 1, false}, "<b>"), "<b>") == 0);
}

TEST_CASE("histogram_svg: a bar for each bin that is not empty, as high as its count, and what lies beyond") {
  const Histogram h{-1, 1, {2, 0, 4, 1}, 3, 5};
  const std::string svg = histogram_svg(h, {-0.5, 0.5, true}, 0.1, "mm");
  CHECK(count(svg, "<rect") == 3);
  const std::regex height("<rect[^>]* height=\"([0-9.]+)\"");
  std::vector<double> heights;
  for (std::sregex_iterator i(svg.begin(), svg.end(), height), end; i != end; ++i)
    heights.push_back(std::stod((*i)[1]));
  REQUIRE(heights.size() == 3);
  CHECK(heights[0] == doctest::Approx(heights[1] / 2).epsilon(0.01));
  CHECK(heights[2] == doctest::Approx(heights[1] / 4).epsilon(0.01));
  CHECK(svg.find("3 below") != std::string::npos);
  CHECK(svg.find("5 above") != std::string::npos);
  CHECK(count(svg, "tolerance</title>") == 2);
}

TEST_CASE("histogram_svg: the numbers of the axis stand apart and differ, however narrow or wide the range") {
  for (const double half : {1e-15, 3e-7, 0.00012, 0.1, 7.0, 12345.0}) {
    CAPTURE(half);
    const Histogram h{-half, half, {1, 0, 2}, 0, 0};
    const std::string svg = histogram_svg(h, {-half, half, false}, std::nullopt, "mm");
    const std::regex label(R"re(<text x="([0-9.]+)" y="213" class="middle">([^<]*)</text>)re");
    std::vector<std::pair<double, std::string>> labels;
    for (std::sregex_iterator it(svg.begin(), svg.end(), label), end; it != end; ++it)
      labels.emplace_back(std::stod((*it)[1]), (*it)[2]);
    REQUIRE(labels.size() >= 3);
    for (std::size_t i = 1; i < labels.size(); ++i) {
      const double letters = static_cast<double>(labels[i].second.size() + labels[i - 1].second.size()) / 2;
      CHECK(labels[i].first - labels[i - 1].first > 6.5 * letters);  // a digit of 12 px text is 6.7 px wide
      CHECK(labels[i].second != labels[i - 1].second);
    }
  }
}

TEST_CASE("html_page: one file that refers to nothing outside and holds every triangle") {
  const Soup soup = sheet(4);
  const std::string page = page_of(report_of(soup));
  CHECK(page.starts_with("<!DOCTYPE html>"));
  CHECK(page.find("{{") == std::string::npos);  // no gap of the template is left
  for (const char* outside : {" src=\"http", " href=", "@import", "url("})
    CHECK(page.find(outside) == std::string::npos);
  CHECK(page.find("default-src 'none'") != std::string::npos);
  CHECK(page.find(std::string("tri ") + version) != std::string::npos);
  CHECK(page.find("data:image/png;base64,iVBOR") != std::string::npos);
  const nlohmann::json scene = scene_of(page);
  CHECK(scene["scene"]["vertices"] == 25);
  CHECK(scene["scene"]["triangles"] == 32);
  CHECK(scene["scene"]["indices"].get<std::string>() == base64_of(std::span<const Triangle>(soup.triangles)));
  CHECK(scene["low"] == nlohmann::json({0, 0, 100}));
  CHECK(scene["backdrop"].is_null());
  CHECK(page_of(report_of(soup)) == page);
}

TEST_CASE("html_page: texts of any kind stay texts") {
  const Soup soup = sheet(2);
  const std::string evil = "</script><img src=x onerror=alert(1)>{{scene}}\"'\xff";
  HtmlReport report = report_of(soup);
  report.title = report.kind = report.unit = report.scale_note = evil;
  report.facts = {{evil, evil}};
  report.figures = {{evil, evil, evil, true}};
  report.histogram = histogram(std::vector<double>{0}, -1, 1, 4);
  report.spot_columns = {{evil, true}};
  report.spots = {{{0, 0, 100}, {0, 0, 1}, evil, {evil}}};
  report.tables = {{evil, evil, {{evil, false}}, {{evil}}, {1}}};
  report.blocks = {{evil, evil}};
  report.notes = {evil};
  const std::string page = page_of(report), plain = page_of(report_of(soup));
  CHECK(count(page, "<img") == count(plain, "<img"));
  CHECK(count(page, "</script") == count(plain, "</script"));
  CHECK(count(page, "<script") == count(plain, "<script"));
  CHECK(count(page, "{{scene}}") >= 10);
  CHECK(page.find('\xff') == std::string::npos);
}

TEST_CASE("html_page: what is too heavy is thinned, and a note says so") {
  const Soup soup = sheet(40);
  HtmlReport report = report_of(soup);
  report.most_elements = 500;
  const std::string page = page_of(report);
  const auto shown = scene_of(page)["scene"]["triangles"].get<std::size_t>();
  CHECK(shown <= 500);
  CHECK(shown > 100);
  CHECK(page.find("shows " + std::to_string(shown) + " triangles of 3200 triangles") != std::string::npos);
}

TEST_CASE("html_page: points are shown over the model, which is told from them") {
  const Soup surface = sheet(3);
  Soup points = sheet(5);
  points.triangles.clear();
  points.vertex_scalars["deviation"][3] = std::nan("");
  HtmlReport report = report_of(points);
  report.backdrop = &surface;
  const nlohmann::json scene = scene_of(page_of(report));
  CHECK(scene["scene"]["vertices"] == 36);
  CHECK(scene["scene"]["triangles"] == 0);
  CHECK(scene["backdrop"]["triangles"] == 18);
}

TEST_CASE("html_page: refuses what it cannot show, and leaves no file") {
  const test::TemporaryFolder folder;
  Context context;
  const Soup soup = sheet(2);
  Soup infinite = soup, empty;
  infinite.points[1][0] = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(page_of(HtmlReport{}), InvalidInput);
  CHECK_THROWS_AS(page_of(report_of(empty)), InvalidInput);
  HtmlReport report = report_of(soup);
  report.tables = {{"ragged", "", {{"one", false}, {"two", true}}, {{"cell"}}, {}}};
  CHECK_THROWS_AS(page_of(report), InvalidInput);
  report = report_of(soup);
  report.scale = {1, 1, false};
  CHECK_THROWS_AS(page_of(report), InvalidInput);
  CHECK_THROWS_AS(write_html(folder / "a.html", report_of(infinite), context), InvalidInput);
  CHECK(folder.entries().empty());
  write_html(folder / "a.html", report_of(soup), context);
  CHECK(test::file_bytes(folder / "a.html") == page_of(report_of(soup)));
}
