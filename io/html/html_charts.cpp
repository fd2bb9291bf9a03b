#include "io/html/html_charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/html/html_text.hpp"
#include "meshops/limits.hpp"

namespace tri {
namespace {

constexpr const char* ink = "#33414f";
constexpr const char* faint = "#dde3e9";

// Round numbers from low to high, about `wanted` of them [Heckbert 1990].
std::vector<double> ticks(double low, double high, int wanted) {
  const double raw = (high - low) / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double share = raw / power;
  const double step = power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
  std::vector<double> result;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1)
    result.push_back(k * step + 0.0);  // no -0
  return result;
}

// Texts of round numbers, with as few decimals as tell them apart; with an exponent where that would be many.
std::vector<std::string> tick_texts(const std::vector<double>& values) {
  constexpr int most_decimals = 6;
  double apart = infinity;
  for (const double a : values)
    for (const double b : values)
      if (a < b) apart = std::min(apart, b - a);
  std::vector<std::string> texts;
  for (int decimals = 0; decimals <= most_decimals; ++decimals) {
    const double power = std::pow(10.0, decimals);
    if (!std::all_of(values.begin(), values.end(),
                     [&](double v) { return std::abs(v - std::round(v * power) / power) < 1e-3 * apart; }))
      continue;
    for (const double v : values) texts.push_back(signed_text(v, decimals));
    return texts;
  }
  for (const double v : values) texts.push_back(v == 0 ? "0" : fmt::format("{:+.1e}", v));
  return texts;
}

std::string with_thousands(double value) {
  std::string digits = fmt::format("{:.0f}", value);
  for (auto i = static_cast<std::ptrdiff_t>(digits.size()) - 3; i > 0; i -= 3)
    digits.insert(static_cast<std::size_t>(i), 1, ' ');
  return digits;
}

}  // namespace

std::string css_color(const Vec3& color) {
  const auto byte = [&](int k) { return static_cast<int>(std::lround(255 * std::clamp(color[k], 0.0, 1.0))); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(0), byte(1), byte(2));
}

std::string legend_svg(const DeviationScale& scale, const std::string& unit) {
  constexpr double left = 8, width = 18, top = 52, height = 240, cap = 18, gap = 9;
  constexpr int steps = 120;
  std::string svg =
      fmt::format(R"(<svg class="legend" viewBox="0 0 120 {:.0f}" role="img" aria-label="Colours of the deviation">)",
                  top + height + cap + gap + 4);
  svg += fmt::format(R"(<text x="{:.0f}" y="14" class="legend-title">deviation, {}</text>)", left, html_escape(unit));
  for (int i = 0; i < steps; ++i) {
    const double value = scale.high - (scale.high - scale.low) * (i + 0.5) / steps;
    svg += fmt::format(R"(<rect x="{:.0f}" y="{:.2f}" width="{:.0f}" height="{:.2f}" fill="{}"/>)", left,
                       top + height * i / steps, width, height / steps + 0.6, css_color(deviation_color(value, scale)));
  }
  std::vector<double> values = ticks(scale.low, scale.high, 6);
  // A tick so near to an end that the two texts would touch.
  std::erase_if(values,
                [&](double v) { return std::min(v - scale.low, scale.high - v) < 0.06 * (scale.high - scale.low); });
  values.push_back(scale.low);
  values.push_back(scale.high);
  const std::vector<std::string> texts = tick_texts(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double v = values[i];
    const double y = top + height * (scale.high - v) / (scale.high - scale.low);
    const bool end = v == scale.low || v == scale.high;
    svg += fmt::format(R"(<line x1="{0:.0f}" x2="{1:.0f}" y1="{2:.2f}" y2="{2:.2f}" stroke="{3}"/>)", left + width,
                       left + width + 5, y, ink);
    svg += fmt::format(R"(<text x="{:.0f}" y="{:.2f}"{}>{}</text>)", left + width + 9, y + 4,
                       end ? R"( class="end")" : "", texts[i]);
  }
  svg += fmt::format(R"(<rect x="{:.0f}" y="{:.0f}" width="{:.0f}" height="{:.0f}" fill="none" stroke="{}"/>)", left,
                     top, width, height, ink);
  if (scale.tolerance) {
    const double step = scale.high - scale.low;
    for (const bool above : {true, false}) {
      const double y = above ? top - cap - gap : top + height + gap;
      svg +=
          fmt::format(R"(<rect x="{:.0f}" y="{:.0f}" width="{:.0f}" height="{:.0f}" fill="{}" stroke="{}"/>)", left, y,
                      width, cap, css_color(deviation_color(above ? scale.high + step : scale.low - step, scale)), ink);
      svg += fmt::format(R"(<text x="{:.0f}" y="{:.0f}">{}</text>)", left + width + 9, y + cap / 2 + 4,
                         above ? "above" : "below");
    }
  }
  return svg + "</svg>";
}

std::string histogram_svg(const Histogram& histogram, const DeviationScale& scale, std::optional<double> mean,
                          const std::string& unit) {
  constexpr double left = 52, right = 24, top = 16, width = 520, height = 180, bottom = 44;
  const std::size_t n = histogram.bins.size();
  const double most =
      static_cast<double>(std::max<std::uint64_t>(1, *std::max_element(histogram.bins.begin(), histogram.bins.end())));
  const double full = left + width + right;
  const auto x_of = [&](double v) { return left + width * (v - histogram.low) / (histogram.high - histogram.low); };
  std::string svg = fmt::format(
      R"(<svg class="histogram" viewBox="0 0 {:.0f} {:.0f}" role="img" aria-label="Histogram of the deviations">)",
      full, top + height + bottom);
  for (const double count : ticks(0, most, 4)) {
    const double y = top + height * (1 - count / most);
    svg += fmt::format(R"(<line x1="{:.0f}" x2="{:.0f}" y1="{:.2f}" y2="{:.2f}" stroke="{}"/>)", left, left + width, y,
                       y, faint);
    svg +=
        fmt::format(R"(<text x="{:.0f}" y="{:.2f}" class="right">{}</text>)", left - 6, y + 4, with_thousands(count));
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (histogram.bins[i] == 0) continue;
    const double h = height * static_cast<double>(histogram.bins[i]) / most;
    const double middle =
        histogram.low + (histogram.high - histogram.low) * (static_cast<double>(i) + 0.5) / static_cast<double>(n);
    svg += fmt::format(
        R"(<rect x="{:.2f}" y="{:.2f}" width="{:.2f}" height="{:.2f}" fill="{}" stroke="{}" stroke-width="0.5"><title>{}: {}</title></rect>)",
        left + width * static_cast<double>(i) / static_cast<double>(n) + 0.5, top + height - h,
        width / static_cast<double>(n) - 1, h, css_color(deviation_color(middle, scale)), ink,
        signed_text(middle, decimals_for(histogram.high - histogram.low)),
        with_thousands(static_cast<double>(histogram.bins[i])));
  }
  svg += fmt::format(R"(<line x1="{0:.0f}" x2="{1:.0f}" y1="{2:.0f}" y2="{2:.0f}" stroke="{3}"/>)", left, left + width,
                     top + height, ink);
  std::vector<double> values;
  std::vector<std::string> texts;
  for (const int wanted : {7, 5, 3}) {  // as many as stand side by side
    constexpr double letter = 7, gap = 10;
    values = ticks(histogram.low, histogram.high, wanted);
    texts = tick_texts(values);
    std::size_t longest = 0;
    for (const std::string& text : texts) longest = std::max(longest, text.size());
    if ((letter * static_cast<double>(longest) + gap) * static_cast<double>(values.size()) <= width) break;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double v = values[i];
    svg += fmt::format(R"(<line x1="{0:.2f}" x2="{0:.2f}" y1="{1:.0f}" y2="{2:.0f}" stroke="{3}"/>)", x_of(v),
                       top + height, top + height + 4, ink);
    svg += fmt::format(R"(<text x="{:.2f}" y="{:.0f}" class="middle">{}</text>)", x_of(v), top + height + 17, texts[i]);
  }
  const auto mark = [&](double v, const char* color, const char* dash, const char* text) {
    if (v < histogram.low || v > histogram.high) return;
    svg += fmt::format(
        R"(<line x1="{0:.2f}" x2="{0:.2f}" y1="{1:.0f}" y2="{2:.0f}" stroke="{3}" stroke-dasharray="{4}"><title>{5}</title></line>)",
        x_of(v), top - 6, top + height, color, dash, text);
  };
  if (scale.tolerance) {
    mark(scale.low, "#b3141c", "5 3", "lower tolerance");
    mark(scale.high, "#b3141c", "5 3", "upper tolerance");
  }
  if (mean) mark(*mean, ink, "2 2", "mean");
  svg += fmt::format(R"(<text x="{:.0f}" y="{:.0f}" class="middle axis">deviation, {}</text>)", left + width / 2,
                     top + height + 36, html_escape(unit));
  if (histogram.below > 0)
    svg += fmt::format(R"(<text x="{:.0f}" y="{:.0f}" class="beyond">&#8592; {} below</text>)", left, top + height + 36,
                       with_thousands(static_cast<double>(histogram.below)));
  if (histogram.above > 0)
    svg += fmt::format(R"(<text x="{:.0f}" y="{:.0f}" class="beyond right">{} above &#8594;</text>)", left + width,
                       top + height + 36, with_thousands(static_cast<double>(histogram.above)));
  return svg + "</svg>";
}

}  // namespace tri
