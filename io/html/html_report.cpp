#include "io/html/html_report.hpp"

#include <fmt/format.h>

#include <map>
#include <string_view>

#include "io/atomic_file.hpp"
#include "io/html/html_charts.hpp"
#include "io/html/html_resources.hpp"
#include "io/html/html_scene.hpp"
#include "io/html/html_text.hpp"
#include "meshops/error.hpp"
#include "meshops/version.hpp"

namespace tri {
namespace {

// Puts values in the place of {{names}}, once: what a value holds is not looked at again.
std::string filled(std::string_view text, const std::map<std::string_view, std::string>& values) {
  std::string result;
  for (;;) {
    const std::size_t begin = text.find("{{"), end = text.find("}}", begin);
    if (begin == std::string_view::npos || end == std::string_view::npos) break;
    result += text.substr(0, begin);
    result += values.at(text.substr(begin + 2, end - begin - 2));
    text.remove_prefix(end + 2);
  }
  return result += text;
}

std::string facts_html(const HtmlReport& report) {
  std::string html;
  for (const auto& [label, text] : report.facts)
    html += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>", html_escape(label), html_escape(text));
  return html;
}

std::string figures_html(const HtmlReport& report) {
  std::string html;
  for (const HtmlFigure& figure : report.figures)
    html += fmt::format(
        R"(<div class="card figure{}"><p class="label">{}</p><p class="value">{}</p><p class="detail">{}</p></div>)",
        figure.alarm ? " alarm" : "", html_escape(figure.label), html_escape(figure.value), html_escape(figure.detail));
  return html;
}

std::string head_html(const std::vector<HtmlTable::Column>& columns, bool sortable) {
  std::string html = "<thead><tr>";
  for (const HtmlTable::Column& column : columns)
    html += fmt::format("<th{}{}>{}</th>", column.number ? R"( class="number")" : "",
                        sortable ? R"( aria-sort="none")" : "", html_escape(column.title));
  return html + "</tr></thead>";
}

std::string cells_html(const std::vector<HtmlTable::Column>& columns, const std::vector<std::string>& cells) {
  if (cells.size() != columns.size())
    throw InvalidInput(fmt::format("a table row has {} cells, the table {} columns", cells.size(), columns.size()));
  std::string html;
  for (std::size_t i = 0; i < cells.size(); ++i)
    html += fmt::format("<td{}>{}</td>", columns[i].number ? R"( class="number")" : "", html_escape(cells[i]));
  return html;
}

std::string table_html(const HtmlTable& table) {
  std::string html = fmt::format(R"(<section class="card"><h2>{}</h2>)", html_escape(table.title));
  if (!table.caption.empty()) html += fmt::format(R"(<p class="caption">{}</p>)", html_escape(table.caption));
  html += R"(<div class="scroll"><table class="sortable">)" + head_html(table.columns, true) + "<tbody>";
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const int face = i < table.faces.size() ? table.faces[i] : 0;
    html += face > 0 ? fmt::format(R"(<tr data-face="{}">)", face) : "<tr>";
    html += cells_html(table.columns, table.rows[i]) + "</tr>";
  }
  return html + "</tbody></table></div></section>";
}

std::string spots_html(const HtmlReport& report) {
  if (report.spots.empty()) return "";
  std::vector<HtmlTable::Column> columns{{"", true}};
  columns.insert(columns.end(), report.spot_columns.begin(), report.spot_columns.end());
  std::string html =
      R"(<div class="card"><h2>Worst places</h2><table class="spots">)" + head_html(columns, false) + "<tbody>";
  for (std::size_t i = 0; i < report.spots.size(); ++i) {
    if (report.spots[i].cells.size() != report.spot_columns.size())
      throw InvalidInput("a spot has another number of cells than columns");
    html += fmt::format(R"(<tr data-spot="{}"><td class="number"><b class="badge">{}</b></td>)", i, i + 1) +
            cells_html(report.spot_columns, report.spots[i].cells) + "</tr>";
  }
  return html + "</tbody></table></div>";
}

std::string notes_html(const std::vector<std::string>& notes) {
  if (notes.empty()) return "";
  std::string html = R"(<section class="card notes"><h2>Notes</h2><ul>)";
  for (const std::string& note : notes) html += "<li>" + html_escape(note) + "</li>";
  return html + "</ul></section>";
}

std::string blocks_html(const HtmlReport& report) {
  std::string html;
  for (const auto& [title, text] : report.blocks)
    html += fmt::format(R"(<div class="card"><h2>{}</h2><pre>{}</pre></div>)", html_escape(title), html_escape(text));
  return html;
}

}  // namespace

bool html_can_turn() {
  return !html::three.empty();
}

std::string html_page(const HtmlReport& report, Context& context) {
  if (!(report.scale.low < report.scale.high)) throw InvalidInput("the scale of the colours has no width");
  const HtmlScene scene = html_scene(report, context);
  std::vector<std::string> notes = report.notes;
  notes.insert(notes.end(), scene.notes.begin(), scene.notes.end());
  std::string histogram, tables;
  if (report.histogram)
    histogram = R"(<div class="card"><h2>Distribution</h2>)" +
                histogram_svg(*report.histogram, report.scale, report.mean, report.unit) + "</div>";
  for (const HtmlTable& table : report.tables) tables += table_html(table);
  return filled(
      html::page,
      {{"version", html_escape(version)},
       {"kind", html_escape(report.kind)},
       {"title", html_escape(report.title)},
       {"style", std::string(html::style)},
       {"facts", facts_html(report)},
       {"figures", figures_html(report)},
       {"picture", scene.picture},
       {"legend", legend_svg(report.scale, report.unit)},
       {"still_note", html_can_turn()
                          ? "This picture does not turn: the browser runs no scripts or has no WebGL."
                          : "This picture does not turn: the program that made the page was built without three.js."},
       {"scale_note", html_escape(report.scale_note)},
       {"histogram", histogram},
       {"spots", spots_html(report)},
       {"notes", notes_html(notes)},
       {"tables", tables},
       {"blocks", blocks_html(report)},
       {"three_notice",
        html_can_turn() ? ". The 3D view is drawn by three.js, &copy; 2010-2019 three.js authors, MIT licence." : "."},
       {"scene", json_for_script(scene.json)},
       {"three", std::string(html::three)},
       {"script", std::string(html::script)}});
}

void write_html(const std::string& path, const HtmlReport& report, Context& context) {
  write_file(path, html_page(report, context));
}

}  // namespace tri
