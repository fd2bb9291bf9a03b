#include "io/point_formats/e57_structure.hpp"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <pugixml.hpp>

namespace tri::io_detail {
namespace {

constexpr int deepest_structure = 16;
constexpr std::size_t most_fields = 1000;

std::string_view without_blanks(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

class StructureReader {
 public:
  explicit StructureReader(E57Pages& pages) : pages_(pages) {}

  E57Structure run() {
    std::string xml(pages_.xml_size(), '\0');
    pages_.read(pages_.xml_offset(), xml.size(), xml.data(), "the XML section");
    pugi::xml_document document;
    const pugi::xml_parse_result result =
        document.load_buffer_inplace(xml.data(), xml.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!result)
      pages_.fail(
          fmt::format("the XML section is not well-formed: {}", result.description()),
          pages_.advanced(pages_.xml_offset(), static_cast<std::uint64_t>(std::max<ptrdiff_t>(result.offset, 0))));
    const pugi::xml_node root = document.child("e57Root");
    if (!root) pages_.fail("the XML section has no element e57Root", pages_.xml_offset());
    E57Structure structure;
    structure.library = text_of(root.child("e57LibraryVersion"));
    for (const pugi::xml_node& scan : root.child("data3D").children())
      if (scan.type() == pugi::node_element) structure.scans.push_back(read_scan(scan));
    for (const pugi::xml_node& picture : root.child("images2D").children())
      structure.pictures += picture.type() == pugi::node_element;
    return structure;
  }

 private:
  std::uint64_t place(const pugi::xml_node& node) const {
    return pages_.advanced(pages_.xml_offset(),
                           static_cast<std::uint64_t>(std::max<ptrdiff_t>(node.offset_debug(), 0)));
  }
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& message) const {
    pages_.fail(message, place(node));
  }

  static std::string text_of(const pugi::xml_node& node) { return std::string(without_blanks(node.child_value())); }

  double real(const pugi::xml_node& node, std::string_view text, const char* what) const {
    text = without_blanks(text);
    if (text.empty()) return 0;  // "If the element is empty, the value is 0."
    if (text.front() == '+') text.remove_prefix(1);
    double value = 0;
    const auto parsed = fast_float::from_chars(text.data(), text.data() + text.size(), value);
    if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size() || !std::isfinite(value))
      fail(node, fmt::format("{} of {} is no finite number: \"{}\"", what, node.name(), text.substr(0, 40)));
    return value;
  }
  double real(const pugi::xml_node& node) const { return node ? real(node, node.child_value(), "the value") : 0; }

  std::int64_t integer(const pugi::xml_node& node, std::string_view text, const char* what) const {
    text = without_blanks(text);
    if (text.empty()) return 0;
    if (text.front() == '+') text.remove_prefix(1);
    std::int64_t value = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
    if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
      fail(node, fmt::format("{} of {} is no integer: \"{}\"", what, node.name(), text.substr(0, 40)));
    return value;
  }
  std::uint64_t count(const pugi::xml_node& node, const char* attribute) const {
    if (!node.attribute(attribute)) fail(node, fmt::format("{} has no attribute {}", node.name(), attribute));
    const std::int64_t value = integer(node, node.attribute(attribute).value(), attribute);
    if (value < 0) fail(node, fmt::format("{} of {} is {}", attribute, node.name(), value));
    return static_cast<std::uint64_t>(value);
  }

  E57Scan read_scan(const pugi::xml_node& node) const {
    E57Scan scan;
    scan.node = place(node);
    scan.name = text_of(node.child("name"));
    for (const char* part : {"sensorVendor", "sensorModel", "sensorSerialNumber"})
      if (const std::string text = text_of(node.child(part)); !text.empty())
        scan.sensor += (scan.sensor.empty() ? "" : " ") + text;
    read_pose(node.child("pose"), scan);
    if (const pugi::xml_node limits = node.child("intensityLimits"))
      scan.intensity_limits = {real(limits.child("intensityMinimum")), real(limits.child("intensityMaximum"))};
    if (const pugi::xml_node limits = node.child("colorLimits")) {
      const std::array<std::array<const char*, 2>, 3> names{{{"colorRedMinimum", "colorRedMaximum"},
                                                             {"colorGreenMinimum", "colorGreenMaximum"},
                                                             {"colorBlueMinimum", "colorBlueMaximum"}}};
      for (std::size_t k = 0; k < 3; ++k)
        if (limits.child(names[k][1]))
          scan.color_limits[k] = {real(limits.child(names[k][0])), real(limits.child(names[k][1]))};
    }
    const pugi::xml_node points = node.child("points");
    if (!points) fail(node, "a scan has no element points");
    scan.records = count(points, "recordCount");
    scan.section = count(points, "fileOffset");
    const pugi::xml_node prototype = points.child("prototype");
    if (!prototype) fail(points, "the element points has no prototype");
    read_fields(prototype, "", 0, scan.fields);
    for (const pugi::xml_node& codec : points.child("codecs").children())
      if (codec.type() == pugi::node_element)
        for (const pugi::xml_node& kind : codec.children())
          if (const std::string name = kind.name(); name.ends_with("Codec") && name != "bitPackCodec")
            fail(kind, fmt::format("records in the codec {} are not read", name));
    return scan;
  }

  void read_pose(const pugi::xml_node& pose, E57Scan& scan) const {
    if (!pose) return;
    const pugi::xml_node shift = pose.child("translation");
    scan.translation = Vec3(real(shift.child("x")), real(shift.child("y")), real(shift.child("z")));
    const pugi::xml_node turn = pose.child("rotation");
    double w = 1, x = 0, y = 0, z = 0;
    if (turn) {
      w = real(turn.child("w")), x = real(turn.child("x")), y = real(turn.child("y")), z = real(turn.child("z"));
      const double norm = std::sqrt(w * w + x * x + y * y + z * z);
      // A unit quaternion, written with a few digits at least.
      if (!(std::abs(norm - 1) < 1e-3))
        fail(turn, fmt::format("the rotation ({}, {}, {}, {}) is no unit quaternion", w, x, y, z));
      w /= norm, x /= norm, y /= norm, z /= norm;
    }
    scan.rotation = {Vec3(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
                     Vec3(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
                     Vec3(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y))};
    scan.has_pose = scan.translation != Vec3(0, 0, 0) || x != 0 || y != 0 || z != 0;
  }

  void read_fields(const pugi::xml_node& structure, const std::string& prefix, int depth,
                   std::vector<E57Field>& fields) const {
    for (const pugi::xml_node& node : structure.children()) {
      if (node.type() != pugi::node_element) continue;
      const std::string type = node.attribute("type").value();
      if (type == "Structure" || type == "Vector") {
        if (depth >= deepest_structure) fail(node, "the prototype is nested too deeply");
        read_fields(node, prefix + node.name() + "/", depth + 1, fields);
        continue;
      }
      if (fields.size() >= most_fields) fail(node, fmt::format("more than {} fields", most_fields));
      fields.push_back(read_field(node, type));
      fields.back().name = prefix + node.name();
    }
  }

  E57Field read_field(const pugi::xml_node& node, const std::string& type) const {
    E57Field field;
    const auto bound = [&node](const char* name) { return node.attribute(name); };
    if (type == "Integer" || type == "ScaledInteger") {
      field.kind = type == "Integer" ? E57Field::Kind::integer : E57Field::Kind::scaled_integer;
      if (bound("minimum")) field.minimum = integer(node, bound("minimum").value(), "minimum");
      if (bound("maximum")) field.maximum = integer(node, bound("maximum").value(), "maximum");
      if (field.minimum > field.maximum)
        fail(node, fmt::format("{} goes from {} to {}", node.name(), field.minimum, field.maximum));
      if (type == "ScaledInteger") {
        if (bound("scale")) field.scale = real(node, bound("scale").value(), "scale");
        if (bound("offset")) field.offset = real(node, bound("offset").value(), "offset");
      }
      const auto value = [&field](std::int64_t v) { return static_cast<double>(v) * field.scale + field.offset; };
      if (bound("minimum")) field.declared_low = value(field.minimum);
      if (bound("maximum")) field.declared_high = value(field.maximum);
    } else if (type == "Float") {
      const std::string precision = bound("precision").as_string("double");
      if (precision != "double" && precision != "single")
        fail(node, fmt::format("{} has the unknown precision \"{}\"", node.name(), precision));
      field.kind = precision == "single" ? E57Field::Kind::single_real : E57Field::Kind::double_real;
      if (bound("minimum")) field.declared_low = real(node, bound("minimum").value(), "minimum");
      if (bound("maximum")) field.declared_high = real(node, bound("maximum").value(), "maximum");
    } else if (type == "String") {
      field.kind = E57Field::Kind::text;
    } else {
      fail(node, fmt::format("{} has the unknown type \"{}\"", node.name(), type));
    }
    return field;
  }

  E57Pages& pages_;
};

}  // namespace

unsigned E57Field::bits() const {
  switch (kind) {
    case Kind::integer:
    case Kind::scaled_integer:
      return static_cast<unsigned>(
          std::bit_width(static_cast<std::uint64_t>(maximum) - static_cast<std::uint64_t>(minimum)));
    case Kind::single_real:
      return 32;
    case Kind::double_real:
      return 64;
    case Kind::text:
      break;
  }
  return 0;
}

E57Structure read_e57_structure(E57Pages& pages) {
  return StructureReader(pages).run();
}

}  // namespace tri::io_detail
