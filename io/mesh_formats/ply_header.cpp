#include "io/mesh_formats/ply_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "io/text_scanner.hpp"

namespace tri::io_detail {
namespace {

std::optional<PlyType> type_named(std::string_view name) {
  if (name == "char" || name == "int8") return PlyType::i8;
  if (name == "uchar" || name == "uint8") return PlyType::u8;
  if (name == "short" || name == "int16") return PlyType::i16;
  if (name == "ushort" || name == "uint16") return PlyType::u16;
  if (name == "int" || name == "int32") return PlyType::i32;
  if (name == "uint" || name == "uint32") return PlyType::u32;
  if (name == "float" || name == "float32") return PlyType::f32;
  if (name == "double" || name == "float64") return PlyType::f64;
  return std::nullopt;
}

PlyType type(TextScanner& scanner) {
  const char* first = scanner.position();
  const std::string_view name = scanner.token();
  const auto found = type_named(name);
  if (!found) scanner.fail(quoted(name) + " is not a type of PLY", first);
  return *found;
}

void parse_format(TextScanner& scanner, PlyHeader& header) {
  const char* first = scanner.position();
  const std::string_view name = scanner.token();
  if (name == "ascii")
    header.encoding = MeshEncoding::ascii;
  else if (name == "binary_little_endian")
    header.encoding = MeshEncoding::binary_little_endian;
  else if (name == "binary_big_endian")
    header.encoding = MeshEncoding::binary_big_endian;
  else
    scanner.fail("unknown PLY format " + quoted(name), first);
  if (const auto version = scanner.token(); version != "1.0")
    scanner.fail("unknown PLY version " + quoted(version), first);
}

void parse_element(TextScanner& scanner, PlyHeader& header) {
  const char* first = scanner.position();
  PlyElement element;
  element.name = scanner.token();
  const std::int64_t count = scanner.integer("the number of elements");
  if (count < 0) scanner.fail(fmt::format("{} elements {}", count, element.name), first);
  element.count = static_cast<std::uint64_t>(count);
  for (const PlyElement& other : header.elements)
    if (other.name == element.name) scanner.fail(fmt::format("element {} is declared twice", element.name), first);
  header.elements.push_back(std::move(element));
}

void parse_property(TextScanner& scanner, PlyHeader& header) {
  const char* first = scanner.position();
  if (header.elements.empty()) scanner.fail("a property before any element", first);
  PlyElement& element = header.elements.back();
  PlyProperty property;
  const char* type_at = scanner.position();
  if (scanner.token() == "list") {
    property.is_list = true;
    property.count_type = type(scanner);
  } else {
    scanner.move_to(type_at);
  }
  property.type = type(scanner);
  property.name = scanner.token();
  if (property.name.empty()) scanner.fail("a property without a name", first);
  if (element.find(property.name)) scanner.fail(fmt::format("property {} is declared twice", property.name), first);
  element.properties.push_back(std::move(property));
}

/// Letters to insert, leave out or exchange that make one word the other [Levenshtein 1966].
std::size_t letters_apart(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t exchanged = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({exchanged, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

bool is_integer(std::string_view token) {
  std::int64_t value = 0;
  const auto result = std::from_chars(token.data(), token.data() + token.size(), value);
  return result.ec == std::errc() && result.ptr == token.data() + token.size();
}

/// Whether a line that is none of PLY may have been one, so that what it said would be lost.
bool may_be_damaged(std::string_view line, const std::string& file) {
  constexpr std::size_t nearly = 2;
  if (std::ranges::any_of(line, [](char c) { return (static_cast<unsigned char>(c) < 32 && c != '\t') || c == 127; }))
    return true;
  TextScanner scanner(line, file);
  std::array<std::string_view, 4> word;
  for (std::string_view& w : word) w = scanner.token();
  if (type_named(word[1]) || word[1] == "list") return true;
  if (word[3].empty() && is_integer(word[2])) return true;
  // Words much longer than those of PLY are none of them, and would only cost time.
  return word[0].size() < 20 &&
         std::ranges::any_of(std::array{"format", "element", "property", "end_header"},
                             [&](const char* of_ply) { return letters_apart(word[0], of_ply) <= nearly; });
}

void skip_unknown(TextScanner& scanner, const char* first, std::string_view bytes, const std::string& file,
                  PlyHeader& header) {
  constexpr std::size_t most_notes = 10;
  scanner.move_to(first);
  const std::string_view line = scanner.rest_of_line();
  if (may_be_damaged(line, file)) {
    scanner.move_to(first);
    scanner.fail("unknown keyword " + quoted(scanner.token()) + " in the header", first);
  }
  if (header.notes.size() > most_notes) return;
  header.notes.push_back(header.notes.size() < most_notes
                             ? fmt::format("line {} of the header is no line of PLY and was skipped: {}",
                                           line_of(bytes, first), quoted(line))
                             : "further lines of the header that are none of PLY were skipped");
}

}  // namespace

std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::i8:
    case PlyType::u8:
      return 1;
    case PlyType::i16:
    case PlyType::u16:
      return 2;
    case PlyType::i32:
    case PlyType::u32:
    case PlyType::f32:
      return 4;
    case PlyType::f64:
      break;
  }
  return 8;
}

const PlyProperty* PlyElement::find(std::string_view property) const {
  const auto found = std::find_if(properties.begin(), properties.end(),
                                  [property](const PlyProperty& p) { return p.name == property; });
  return found == properties.end() ? nullptr : &*found;
}

PlyHeader parse_ply_header(std::string_view bytes, const std::string& file) {
  TextScanner scanner(bytes, file);
  if (scanner.token() != "ply" || !scanner.at_line_end())
    scanner.fail("not a PLY file: it does not begin with a line \"ply\"", bytes.data());
  // A body may begin with any byte, also with one that looks like half a line end: the first line tells how lines end.
  const bool lone_returns =
      bytes.substr(scanner.offset(), 2).starts_with('\r') && !bytes.substr(scanner.offset(), 2).ends_with('\n');
  PlyHeader header;
  bool has_format = false;
  while (true) {
    if (scanner.at_end()) scanner.fail("truncated: the file ends within the header");
    scanner.next_line();
    scanner.skip_blanks();
    const char* first = scanner.position();
    const std::string_view keyword = scanner.token();
    if (keyword == "end_header") break;
    scanner.skip_blanks();
    if (keyword == "format") {
      parse_format(scanner, header);
      has_format = true;
    } else if (keyword == "element") {
      parse_element(scanner, header);
    } else if (keyword == "property") {
      parse_property(scanner, header);
    } else if (keyword == "comment" || keyword == "obj_info") {
      scanner.rest_of_line();
    } else if (!keyword.empty()) {
      skip_unknown(scanner, first, bytes, file, header);
    }
    if (!scanner.at_line_end()) scanner.fail(quoted(scanner.token()) + " where the line should end");
  }
  if (!has_format) scanner.fail("the header names no format");
  if (!scanner.at_line_end()) scanner.fail(quoted(scanner.token()) + " where the line should end");
  header.size = scanner.offset();
  header.lines = line_of(bytes, scanner.position());
  const std::string_view rest = bytes.substr(header.size);
  if (rest.starts_with("\r\n") && !lone_returns)
    header.size += 2;
  else if (!rest.empty())
    header.size += 1;
  return header;
}

}  // namespace tri::io_detail
