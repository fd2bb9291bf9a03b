#include "io/point_formats/points_dialect.hpp"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "io/text_scanner.hpp"
#include "meshops/points/point_soup.hpp"

namespace tri::io_detail {
namespace {

constexpr std::size_t sniffed_lines = 1000;
constexpr std::size_t max_header_lines = 1000;

// A carriage return before the line feed counts as blank.
bool blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

class Lines {
 public:
  Lines(std::string_view text, char end) : left_(text), end_(end) {}
  bool next(std::string_view& line) {
    if (left_.empty()) return false;
    const std::size_t size = std::min(left_.find(end_), left_.size());
    line = left_.substr(0, size);
    left_.remove_prefix(std::min(size + 1, left_.size()));
    return true;
  }

 private:
  std::string_view left_;
  char end_;
};

bool begins_as_number(std::string_view line) {
  std::size_t i = 0;
  while (i < line.size() && (blank(line[i]) || line[i] == ',' || line[i] == ';')) ++i;
  if (i < line.size() && (line[i] == '-' || line[i] == '+')) ++i;
  if (i < line.size() && (line[i] == '.' || line[i] == ',')) ++i;
  return i < line.size() && line[i] >= '0' && line[i] <= '9';
}

std::vector<std::string_view> fields_of(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  const char* p = line.data();
  const char* const end = p + line.size();
  while (true) {
    while (p < end && blank(*p)) ++p;
    if (p >= end) return fields;
    const char* first = p;
    while (p < end && !blank(*p) && !(separator && *p == separator)) ++p;
    fields.emplace_back(first, static_cast<std::size_t>(p - first));
    while (p < end && blank(*p)) ++p;
    if (p < end && separator && *p == separator) ++p;
  }
}

bool parse_field(std::string_view field, bool decimal_comma, double& value) {
  if (!field.empty() && field[0] == '+') field.remove_prefix(1);
  const fast_float::parse_options options(fast_float::chars_format::general, decimal_comma ? ',' : '.');
  const auto result = fast_float::from_chars_advanced(field.data(), field.data() + field.size(), value, options);
  return result.ec == std::errc() && result.ptr == field.data() + field.size();
}

// "1,5 2,5 3,5": each of the first three fields between blanks has at most one comma, and that inside.
bool commas_are_decimal(std::string_view line) {
  const auto fields = fields_of(line, 0);
  if (fields.size() < 3) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto field = fields[i];
    if (std::count(field.begin(), field.end(), ',') > 1 || field.front() == ',' || field.back() == ',') return false;
    if (field.find('.') != std::string_view::npos) return false;
  }
  return true;
}

bool has_digit(std::string_view line) {
  return std::any_of(line.begin(), line.end(), [](char c) { return c >= '0' && c <= '9'; });
}

// Decides by the lines that `votes` picks; false if there is none.
bool recognise_separator(std::string_view bytes, PointsDialect& dialect, bool (*votes)(std::string_view)) {
  Lines lines(bytes, dialect.line_end);
  std::string_view line;
  bool semicolons = false, commas = false, points = false, decimal_commas = true;
  std::size_t seen = 0;
  for (std::size_t all = 0; seen < sniffed_lines && all < sniffed_lines + max_header_lines && lines.next(line); ++all) {
    if (is_skipped_line(line) || !votes(line)) continue;
    ++seen;
    semicolons = semicolons || line.find(';') != std::string_view::npos;
    points = points || line.find('.') != std::string_view::npos;
    if (line.find(',') == std::string_view::npos) continue;
    commas = true;
    decimal_commas = decimal_commas && commas_are_decimal(line);
  }
  if (semicolons) {
    dialect.separator = ';';
    dialect.decimal_comma = commas && !points;
  } else if (commas) {
    dialect.decimal_comma = decimal_commas;
    dialect.separator = decimal_commas ? 0 : ',';
  }
  return seen > 0;
}

// "//X [mm]" -> "X"
std::string bare_name(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (c == '[' || c == '(') break;
    if (!std::strchr("#/%!\"'", c) && !blank(c)) out += c;
  }
  return out;
}

std::vector<std::string> names_of(std::string_view line, char separator) {
  std::vector<std::string> names;
  if (separator && line.find(separator) != std::string_view::npos) {
    // Strictly by the separator: a name may hold blanks.
    while (true) {
      const std::size_t size = line.find(separator);
      names.push_back(bare_name(line.substr(0, size)));
      if (size == std::string_view::npos) break;
      line.remove_prefix(size + 1);
    }
  } else {
    for (const char* other : {"", ",", ";"}) {
      names.clear();
      for (const auto field : fields_of(line, *other))
        if (std::string name = bare_name(field); !name.empty()) names.push_back(std::move(name));
      if (names.size() >= 3) break;
    }
  }
  return names;
}

/// The column that has one of these names, in any case; -1 if there is none.
int find_name(const std::vector<std::string>& names, const std::vector<std::string>& known) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string lower = names[i];
    for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    if (std::find(known.begin(), known.end(), lower) != known.end()) return static_cast<int>(i);
  }
  return -1;
}

int find_axis(const std::vector<std::string>& names, char axis, bool normal) {
  const std::string a(1, axis);
  if (normal) return find_name(names, {"n" + a, "normal_" + a, "normal" + a, "n_" + a});
  return find_name(names, {a, "p" + a, "pos_" + a, a + "_mm", a + "_coord", "coord_" + a, "cartesian" + a});
}

std::array<int, 3> find_colors(const std::vector<std::string>& names) {
  for (const auto& [red, green, blue] : {std::array{"red", "green", "blue"}, std::array{"r", "g", "b"}}) {
    const std::array<int, 3> found{find_name(names, {red}), find_name(names, {green}), find_name(names, {blue})};
    if (found[0] >= 0 && found[1] >= 0 && found[2] >= 0) return found;
  }
  return {-1, -1, -1};
}

/// The columns of a file that has no names: the first three, and the next three if they are normals.
void take_first_columns(PointsDialect& dialect, bool normals) {
  dialect.target = normals ? std::vector<int>{0, 1, 2, 3, 4, 5} : std::vector<int>{0, 1, 2};
  dialect.normals = normals;
  dialect.normals_named = dialect.intensity = dialect.colors = false;
  dialect.scalars.clear();
}

bool is_level(std::string_view field, bool decimal_comma) {
  double value = 0;
  return parse_field(field, decimal_comma, value) && value >= 0 && value <= 255 && value == std::floor(value);
}

// True if the names tell where x, y and z are; then `dialect` knows every column that is a number in the first line.
bool take_names(const std::vector<std::string>& names, const std::vector<std::string_view>& first_line,
                PointsDialect& dialect) {
  std::array<int, 3> point, normal;
  for (std::size_t k = 0; k < 3; ++k) {
    point[k] = find_axis(names, static_cast<char>('x' + k), false);
    normal[k] = find_axis(names, static_cast<char>('x' + k), true);
    if (point[k] < 0) return false;
  }
  take_first_columns(dialect, false);
  dialect.normals = dialect.normals_named = normal[0] >= 0 && normal[1] >= 0 && normal[2] >= 0;
  std::vector<int> target(names.size(), PointsDialect::ignored);
  const auto put = [&target](const std::array<int, 3>& columns, int at) {
    for (std::size_t k = 0; k < 3; ++k) target[static_cast<std::size_t>(columns[k])] = at + static_cast<int>(k);
  };
  put(point, 0);
  if (dialect.normals) put(normal, 3);
  for (std::size_t i = 0; i < names.size() && !dialect.intensity; ++i) {
    if (target[i] != PointsDialect::ignored || !names_intensity(names[i])) continue;
    dialect.intensity = true;
    target[i] = dialect.intensity_at();
  }
  const std::array<int, 3> color = find_colors(names);
  dialect.colors = std::all_of(color.begin(), color.end(), [&](int c) {
    return c >= 0 && target[static_cast<std::size_t>(c)] == PointsDialect::ignored &&
           is_level(first_line[static_cast<std::size_t>(c)], dialect.decimal_comma);
  });
  if (dialect.colors) put(color, dialect.colors_at());
  for (std::size_t i = 0; i < names.size(); ++i) {
    double number = 0;
    const bool taken = target[i] != PointsDialect::ignored || names[i].empty() ||
                       std::find(dialect.scalars.begin(), dialect.scalars.end(), names[i]) != dialect.scalars.end();
    if (taken || !parse_field(first_line[i], dialect.decimal_comma, number)) continue;
    target[i] = dialect.values();
    dialect.scalars.push_back(names[i]);
  }
  while (target.back() == PointsDialect::ignored) target.pop_back();
  dialect.target = target;
  return true;
}

bool looks_like_normals(std::string_view from_first_point, PointsDialect dialect) {
  take_first_columns(dialect, true);
  Lines lines(from_first_point, dialect.line_end);
  std::string_view line;
  for (std::size_t seen = 0; seen < sniffed_lines && lines.next(line);) {
    if (is_skipped_line(line)) continue;
    ++seen;
    double v[6];
    PointsLineError error;
    parse_points_line(line, dialect, v, error);
    if (error.where || !(std::abs(v[3] * v[3] + v[4] * v[4] + v[5] * v[5] - 1) <= unit_tolerance)) return false;
  }
  return true;
}

void note_columns(const PointsDialect& dialect, PointsFileInfo& info) {
  std::string ignored;
  std::size_t count = 0;
  for (std::size_t i = 0; i < dialect.columns; ++i) {
    if (i < dialect.target.size() && dialect.target[i] != PointsDialect::ignored) continue;
    ignored += fmt::format("{}{}", ignored.empty() ? "" : ", ", i + 1);
    ++count;
  }
  if (count > 0)
    info.notes.push_back(fmt::format("column{} {} of {} ignored", count > 1 ? "s" : "", ignored, dialect.columns));
}

}  // namespace

bool is_skipped_line(std::string_view line) {
  std::size_t i = 0;
  while (i < line.size() && blank(line[i])) ++i;
  if (i == line.size()) return true;
  const char c = line[i];
  return c == '#' || c == '%' || c == '!' || (c == '/' && i + 1 < line.size() && line[i + 1] == '/');
}

void parse_points_line(std::string_view line, const PointsDialect& dialect, double* values, PointsLineError& error) {
  const fast_float::parse_options options(fast_float::chars_format::general, dialect.decimal_comma ? ',' : '.');
  const char* p = line.data();
  const char* const end = p + line.size();
  const int required = dialect.required();
  const auto ends_field = [&](const char* q) {
    return q >= end || blank(*q) || (dialect.separator && *q == dialect.separator);
  };
  for (int k = required; k < dialect.values(); ++k) values[k] = std::numeric_limits<double>::quiet_NaN();
  int found = 0;
  std::size_t column = 0;
  for (; column < dialect.target.size(); ++column) {
    while (p < end && blank(*p)) ++p;
    if (p >= end) break;
    const int target = dialect.target[column];
    const char* first = p;
    if (target >= 0) {
      if (*p == '+' && p + 1 < end && p[1] != '-') ++p;
      double value = 0;
      const auto result = fast_float::from_chars_advanced(p, end, value, options);
      const bool number = result.ec == std::errc() && ends_field(result.ptr);
      if (target < required) {
        if (!number) {
          const auto rest = fields_of({first, static_cast<std::size_t>(end - first)}, dialect.separator);
          error = {first, rest[0].empty()
                              ? fmt::format("column {} is empty", column + 1)
                              : fmt::format("{} in column {} is not a number{}", quoted(rest[0]), column + 1,
                                            dialect.decimal_comma ? " (with a decimal comma)" : "")};
          return;
        }
        if (!std::isfinite(value) && (target < 3 || dialect.normals_named)) {
          error = {first, fmt::format("{} in column {} is not finite",
                                      quoted({first, static_cast<std::size_t>(result.ptr - first)}), column + 1)};
          return;
        }
        ++found;
      }
      if (number) {
        values[target] = value;
        p = result.ptr;
      }
    }
    while (!ends_field(p)) ++p;
    while (p < end && blank(*p)) ++p;
    if (p < end && dialect.separator && *p == dialect.separator) ++p;
  }
  if (found == required) return;
  std::size_t last = 0;
  for (std::size_t k = 0; k < dialect.target.size(); ++k)
    if (dialect.target[k] >= 0 && dialect.target[k] < required) last = k;
  error = {line.data(),
           fmt::format("the line has {} column{}, {} are needed", column, column == 1 ? "" : "s", last + 1)};
}

PointsDialect recognise_points_dialect(std::string_view bytes, const std::string& file, PointsFileInfo& info) {
  PointsDialect dialect;
  if (bytes.find('\n') == std::string_view::npos && bytes.find('\r') != std::string_view::npos) dialect.line_end = '\r';
  // Where each point begins with its name, no line begins with a number.
  if (!recognise_separator(bytes, dialect, begins_as_number)) recognise_separator(bytes, dialect, has_digit);

  const auto fail = [&](const std::string& message, const char* where) {
    throw IoError(file, message, IoError::Unit::line, line_of(bytes, where));
  };
  Lines lines(bytes, dialect.line_end);
  std::string_view line;
  std::vector<std::vector<std::string>> names;  // of every line before the first point, as far as they are words
  std::size_t header_lines = 0;
  std::string_view first_header;
  while (lines.next(line)) {
    if (trimmed(line).empty()) continue;
    if (is_skipped_line(line)) {
      if (names.size() < max_header_lines) names.push_back(names_of(line, dialect.separator));
      continue;
    }
    const auto fields = fields_of(line, dialect.separator);
    double number = 0;
    const bool numeric = parse_field(fields[0], dialect.decimal_comma, number);
    bool named = false;
    for (auto n = names.rbegin(); n != names.rend() && !named; ++n)
      named = n->size() == fields.size() && take_names(*n, fields, dialect);
    // A first column that is no coordinate (a name of the point) may hold anything.
    std::vector<double> values(static_cast<std::size_t>(dialect.values()));
    PointsLineError error;
    parse_points_line(line, dialect, values.data(), error);
    const bool count = numeric && fields.size() == 1 && number >= 0 && number == std::floor(number);
    if (error.where && numeric && !count) fail(error.message, error.where);
    if (!error.where) {
      dialect.first_point = line.data();
      dialect.columns = fields.size();
      if (!named && fields.size() >= 6 &&
          looks_like_normals(bytes.substr(static_cast<std::size_t>(line.data() - bytes.data())), dialect)) {
        take_first_columns(dialect, true);
      }
      break;
    }
    if (header_lines++ == 0) first_header = line;
    if (header_lines > max_header_lines) break;
    names.push_back(names_of(line, dialect.separator));
    take_first_columns(dialect, false);
  }
  if (!dialect.first_point) {
    if (header_lines > 0)
      fail(fmt::format("no points: {} is no line of three numbers, nor is any of {} that follow",
                       quoted(trimmed(first_header)), header_lines - 1),
           first_header.data());
    throw IoError(file, "no points: the file holds only blank lines and comments");
  }
  if (header_lines > 0)
    info.notes.push_back(fmt::format("{} header line{} skipped, beginning with {}", header_lines,
                                     header_lines > 1 ? "s" : "", quoted(trimmed(first_header))));
  if (dialect.decimal_comma) info.notes.emplace_back("commas were read as decimal points");
  note_columns(dialect, info);
  return dialect;
}

}  // namespace tri::io_detail
