#include "io/points_dialect.hpp"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "io/text_scanner.hpp"

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

// "//X [mm]" -> "x"
std::string normalised_name(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (c == '[' || c == '(') break;
    if (std::strchr("#/%!\"'", c) || blank(c)) continue;
    out += c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  }
  return out;
}

std::vector<std::string> names_of(std::string_view line, char separator) {
  std::vector<std::string> names;
  if (separator && line.find(separator) != std::string_view::npos) {
    // Strictly by the separator: a name may hold blanks.
    while (true) {
      const std::size_t size = line.find(separator);
      names.push_back(normalised_name(line.substr(0, size)));
      if (size == std::string_view::npos) break;
      line.remove_prefix(size + 1);
    }
  } else {
    for (const char* other : {"", ",", ";"}) {
      names.clear();
      for (const auto field : fields_of(line, *other))
        if (std::string name = normalised_name(field); !name.empty()) names.push_back(std::move(name));
      if (names.size() >= 3) break;
    }
  }
  return names;
}

int find_name(const std::vector<std::string>& names, char axis, bool normal) {
  const std::string a(1, axis);
  const std::vector<std::string> known =
      normal ? std::vector<std::string>{"n" + a, "normal_" + a, "normal" + a, "n_" + a}
             : std::vector<std::string>{a, "p" + a, "pos_" + a, a + "_mm", a + "_coord", "coord_" + a, "cartesian" + a};
  for (std::size_t i = 0; i < names.size(); ++i)
    if (std::find(known.begin(), known.end(), names[i]) != known.end()) return static_cast<int>(i);
  return -1;
}

// True if the names tell where x, y and z are.
bool take_names(const std::vector<std::string>& names, PointsDialect& dialect) {
  std::array<int, 6> column;
  for (int k = 0; k < 3; ++k) {
    column[k] = find_name(names, static_cast<char>('x' + k), false);
    column[k + 3] = find_name(names, static_cast<char>('x' + k), true);
  }
  if (column[0] < 0 || column[1] < 0 || column[2] < 0) return false;
  dialect.column = column;
  dialect.normals = dialect.normals_named = column[3] >= 0 && column[4] >= 0 && column[5] >= 0;
  return true;
}

bool looks_like_normals(std::string_view from_first_point, PointsDialect dialect) {
  dialect.column = {0, 1, 2, 3, 4, 5};
  dialect.normals = true;
  Lines lines(from_first_point, dialect.line_end);
  std::string_view line;
  for (std::size_t seen = 0; seen < sniffed_lines && lines.next(line);) {
    if (is_skipped_line(line)) continue;
    ++seen;
    PointsLine v;
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
    const auto used = dialect.column.begin() + (dialect.normals ? 6 : 3);
    if (std::find(dialect.column.begin(), used, static_cast<int>(i)) != used) continue;
    ignored += (ignored.empty() ? "" : ", ") + std::to_string(i + 1);
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

void parse_points_line(std::string_view line, const PointsDialect& dialect, PointsLine& values,
                       PointsLineError& error) {
  const fast_float::parse_options options(fast_float::chars_format::general, dialect.decimal_comma ? ',' : '.');
  const char* p = line.data();
  const char* const end = p + line.size();
  const int wanted = dialect.normals ? 6 : 3;
  for (int column = 0, found = 0; found < wanted; ++column) {
    while (p < end && blank(*p)) ++p;
    if (p >= end) {
      error = {line.data(),
               fmt::format("the line has {} column{}, {} are needed", column, column == 1 ? "" : "s",
                           *std::max_element(dialect.column.begin(), dialect.column.begin() + wanted) + 1)};
      return;
    }
    int target = column < wanted && dialect.column[static_cast<std::size_t>(column)] == column ? column : -1;
    for (int k = 0; k < wanted && target < 0; ++k)
      if (dialect.column[static_cast<std::size_t>(k)] == column) target = k;
    if (target >= 0) {
      const char* first = p;
      if (*p == '+' && p + 1 < end && p[1] != '-') ++p;
      double value = 0;
      const auto result = fast_float::from_chars_advanced(p, end, value, options);
      if (result.ec != std::errc() ||
          (result.ptr < end && !blank(*result.ptr) && !(dialect.separator && *result.ptr == dialect.separator))) {
        const auto rest = fields_of({first, static_cast<std::size_t>(end - first)}, dialect.separator);
        error = {first, rest[0].empty() ? fmt::format("column {} is empty", column + 1)
                                        : fmt::format("{} in column {} is not a number{}", quoted(rest[0]), column + 1,
                                                      dialect.decimal_comma ? " (with a decimal comma)" : "")};
        return;
      }
      if (!std::isfinite(value) && (target < 3 || dialect.normals_named)) {
        error = {first, fmt::format("{} in column {} is not finite",
                                    quoted({first, static_cast<std::size_t>(result.ptr - first)}), column + 1)};
        return;
      }
      values[static_cast<std::size_t>(target)] = value;
      p = result.ptr;
      ++found;
    } else {
      while (p < end && !blank(*p) && !(dialect.separator && *p == dialect.separator)) ++p;
    }
    while (p < end && blank(*p)) ++p;
    if (p < end && dialect.separator && *p == dialect.separator) ++p;
  }
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
      named = n->size() == fields.size() && take_names(*n, dialect);
    // A first column that is no coordinate (a name of the point) may hold anything.
    PointsLine values;
    PointsLineError error;
    parse_points_line(line, dialect, values, error);
    const bool count = numeric && fields.size() == 1 && number >= 0 && number == std::floor(number);
    if (error.where && numeric && !count) fail(error.message, error.where);
    if (!error.where) {
      dialect.first_point = line.data();
      dialect.columns = fields.size();
      if (!named && fields.size() >= 6 &&
          looks_like_normals(bytes.substr(static_cast<std::size_t>(line.data() - bytes.data())), dialect)) {
        dialect.column = {0, 1, 2, 3, 4, 5};
        dialect.normals = true;
      }
      break;
    }
    if (header_lines++ == 0) first_header = line;
    if (header_lines > max_header_lines) break;
    names.push_back(names_of(line, dialect.separator));
    dialect.column = {0, 1, 2, -1, -1, -1};
    dialect.normals = dialect.normals_named = false;
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
