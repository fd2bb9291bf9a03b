#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/pictures/palette.hpp"
#include "meshops/checks/value_statistics.hpp"
#include "meshops/context.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// A number that a reader should see first.
struct HtmlFigure {
  std::string label;   ///< "standard deviation"
  std::string value;   ///< "0.021 mm"
  std::string detail;  ///< "of 3,400 points"; may be empty
  bool alarm = false;  ///< shown in red
};

/// Texts in rows and columns. Every row has as many cells as there are columns.
struct HtmlTable {
  std::string title;    ///< plain text
  std::string caption;  ///< below the title; may be empty
  /// What stands in a column.
  struct Column {
    std::string title;    ///< plain text
    bool number = false;  ///< flushed right, and sorted as a number
  };
  std::vector<Column> columns;                 ///< from left to right
  std::vector<std::vector<std::string>> rows;  ///< plain text, one entry for each column
  /// Face that a click on the row shows, per row, 1-based, 0 for none; or empty.
  std::vector<int> faces;
};

/// A place that is pointed out in the picture and in a table.
struct HtmlSpot {
  Vec3 position{0, 0, 0};          ///< in the coordinates of the scene
  Vec3 normal{0, 0, 0};            ///< outward; (0,0,0) if it is not known
  std::string text;                ///< what the pin says: "+0.123 mm, face 7"
  std::vector<std::string> cells;  ///< its row in the table of spots
};

/// A page about a measured part: what it shows.
struct HtmlReport {
  std::string title;                                       ///< of the page
  std::string kind = "Deviation report";                   ///< above the title
  std::vector<std::pair<std::string, std::string>> facts;  ///< below the title: label and text
  std::vector<HtmlFigure> figures;                         ///< shown large, in this order

  /// The part in colour: triangles, or points if it has none. Not null. Colours are by `vertex_scalars["deviation"]`
  /// (grey where that is missing or NaN); `vertex_scalars["cad_face"]` says which face a vertex lies on, if it is
  /// there.
  const Soup* scene = nullptr;
  const Soup* backdrop = nullptr;      ///< drawn in grey behind points; may be null
  DeviationScale scale;                ///< colours of the scene
  std::string scale_note;              ///< one sentence: where the ends of the scale come from
  std::string unit = "mm";             ///< of deviations, shown beside them
  std::optional<Histogram> histogram;  ///< of deviations; shown if given
  std::optional<double> mean;          ///< marked in the histogram

  std::vector<HtmlTable::Column> spot_columns;              ///< of the table of `spots`
  std::vector<HtmlSpot> spots;                              ///< pins 1, 2, … in this order
  std::vector<HtmlTable> tables;                            ///< shown after the spots
  std::vector<std::pair<std::string, std::string>> blocks;  ///< title and preformatted text, shown last: pose, options
  std::vector<std::string> notes;                           ///< what a reader must know, one sentence each

  std::size_t most_elements = 400'000;  ///< triangles or points embedded at most; a visible note says what was thinned
};

/// Whether the program was built with three.js, so that the part can be turned. Without it, a page holds its static
/// picture and says so.
bool html_can_turn();

/// The page as one string: HTML with its style, its scripts, three.js and all data inside; it refers to nothing
/// outside.
///
/// Numbers, charts and a static picture stand in the HTML itself; scripts only add the part that can be turned (WebGL),
/// pins and sorting. Every text is escaped. Equal reports give equal bytes. 8 bytes a vertex and 16 a triangle, and 0.9
/// MB.
/// @throws InvalidInput if `scene` is null or empty, a coordinate is not finite or a table is ragged; Cancelled
std::string html_page(const HtmlReport& report, Context& context);

/// Writes `html_page`; the file appears whole or not at all. @throws as `html_page`; IoError
void write_html(const std::string& path, const HtmlReport& report, Context& context);

}  // namespace tri
