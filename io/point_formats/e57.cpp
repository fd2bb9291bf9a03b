#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "io/point_formats/e57_pages.hpp"
#include "io/point_formats/e57_records.hpp"
#include "io/point_formats/e57_structure.hpp"
#include "io/point_formats/points_formats.hpp"

// E57: ASTM E2807-11, "Standard Specification for 3D Imaging Data Exchange, Version 1.0"; normals as in the extension
// "E57_EXT_surface_normals".
namespace tri::io_detail {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

using Three = std::array<std::size_t, 3>;

/// Which field of a scan is what; `none` where the scan has not got it.
struct Roles {
  Three cartesian{none, none, none}, spherical{none, none, none};
  Three color{none, none, none}, normal{none, none, none};
  std::size_t invalid = none, intensity = none, intensity_invalid = none, color_invalid = none;
  std::vector<std::size_t> scalars;  ///< what is carried along under its own name
};

class ScanParser {
 public:
  ScanParser(E57Pages& pages, const E57Scan& scan, std::size_t number, PointSet& set, PointsFileInfo& info)
      : pages_(pages), scan_(scan), number_(number), set_(set), info_(info), label_(label(scan, number)) {
    assign_roles();
  }

  /// @param earlier, total  records of the scans before this one, and of all
  void run(bool name_scans, std::uint64_t earlier, std::uint64_t total, Context& context) {
    const std::size_t before = set_.size();
    set_.points.reserve(total);
    begin(set_.normals, roles_.normal[0] != none, Vec3(0, 0, 0), total);
    begin(set_.intensity, roles_.intensity != none, unknown, total);
    begin(set_.colors, roles_.color[0] != none, {0, 0, 0}, total);
    for (const std::size_t field : roles_.scalars) {
      scalars_.push_back(&set_.scalars[scan_.fields[field].name]);
      begin(*scalars_.back(), true, unknown, total);
    }
    if (name_scans) {
      scalars_.push_back(&set_.scalars["scan"]);
      begin(*scalars_.back(), true, unknown, total);
    }
    std::vector<bool> wanted(scan_.fields.size(), false);
    for (const std::size_t field : used_) wanted[field] = true;
    E57Records records(pages_, scan_, wanted);
    std::uint64_t skipped = 0;
    while (records.next()) {
      context.checkpoint();
      context.progress("read", static_cast<double>(earlier + records.first()) / static_cast<double>(total));
      for (std::size_t i = 0; i < records.available(); ++i) skipped += !take(records, i);
    }
    const std::size_t after = set_.size();
    set_.normals.resize(set_.normals.empty() ? 0 : after, Vec3(0, 0, 0));
    set_.intensity.resize(set_.intensity.empty() ? 0 : after, unknown);
    set_.colors.resize(set_.colors.empty() ? 0 : after, {0, 0, 0});
    for (auto& scalar : set_.scalars) scalar.second.resize(after, unknown);
    info_.points_skipped += skipped;
    info_.scans.push_back(
        {scan_.name, scan_.sensor, after - before, skipped, scan_.has_pose, scan_.rotation, scan_.translation});
    write_notes(skipped);
  }

  static std::string label(const E57Scan& scan, std::size_t number) {
    return scan.name.empty() ? fmt::format("scan {}", number + 1)
                             : fmt::format("scan {} (\"{}\")", number + 1, scan.name);
  }

 private:
  template <class T>
  void begin(std::vector<T>& column, bool used, const T& missing, std::uint64_t total) const {
    if (!used) return;
    column.reserve(total);
    column.resize(set_.size(), missing);
  }

  std::size_t find(std::string_view name) {
    for (std::size_t k = 0; k < scan_.fields.size(); ++k)
      if (scan_.fields[k].name == name && scan_.fields[k].kind != E57Field::Kind::text) return k;
    return none;
  }
  /// All three, or none of them.
  Three find(const Three& parts) const {
    return std::find(parts.begin(), parts.end(), none) == parts.end() ? parts : Three{none, none, none};
  }
  void use(std::size_t field) {
    if (field != none) used_.insert(field);
  }

  void assign_roles() {
    roles_.cartesian = find({find("cartesianX"), find("cartesianY"), find("cartesianZ")});
    if (roles_.cartesian[0] == none) {
      roles_.spherical = find({find("sphericalRange"), find("sphericalAzimuth"), find("sphericalElevation")});
      if (roles_.spherical[0] == none)
        pages_.fail(fmt::format("{} has neither cartesian nor spherical coordinates", label_), scan_.node);
      for (const std::size_t field : roles_.spherical) use(field);
    } else {
      for (const std::size_t field : roles_.cartesian) use(field);
    }
    roles_.invalid = find(roles_.cartesian[0] != none ? "cartesianInvalidState" : "sphericalInvalidState");
    use(roles_.invalid);
    roles_.intensity = find("intensity");
    if (roles_.intensity != none) {
      use(roles_.intensity);
      use(roles_.intensity_invalid = find("isIntensityInvalid"));
    }
    roles_.color = find({find("colorRed"), find("colorGreen"), find("colorBlue")});
    if (roles_.color[0] != none) {
      for (std::size_t k = 0; k < 3; ++k) {
        use(roles_.color[k]);
        color_range_[k] = range_of_color(k);
      }
      use(roles_.color_invalid = find("isColorInvalid"));
    }
    roles_.normal = find({find("nor:normalX"), find("nor:normalY"), find("nor:normalZ")});
    for (const std::size_t field : roles_.normal) use(field);
    for (std::size_t k = 0; k < scan_.fields.size(); ++k) {
      const std::string& name = scan_.fields[k].name;
      if (used_.contains(k)) continue;
      // A second description of the same place, and what cannot be a number.
      const bool coordinates = name.starts_with("cartesian") || name.starts_with("spherical");
      if (coordinates || scan_.fields[k].kind == E57Field::Kind::text || find(name) != k || name == "scan") {
        if (!ignored_.empty()) ignored_ += ", ";
        ignored_ += name;
      } else {
        roles_.scalars.push_back(k);
        use(k);
      }
    }
  }

  /// Where the darkest and the brightest value of a channel are.
  E57Range range_of_color(std::size_t channel) const {
    const E57Field& field = scan_.fields[roles_.color[channel]];
    std::optional<E57Range> range = scan_.color_limits[channel];
    if (!range && field.declared_low && field.declared_high) range = {*field.declared_low, *field.declared_high};
    if (range && range->high > range->low) return *range;
    return {0, field.kind == E57Field::Kind::integer ? 255.0 : 1.0};
  }

  /// False for a record without a valid place.
  bool take(const E57Records& records, std::size_t i) {
    if (roles_.invalid != none && records.value(roles_.invalid, i) != 0) return false;
    Vec3 p;
    if (roles_.cartesian[0] != none) {
      p = three(records, roles_.cartesian, i);
    } else {
      const Vec3 s = three(records, roles_.spherical, i);
      p = s[0] * Vec3(std::cos(s[2]) * std::cos(s[1]), std::cos(s[2]) * std::sin(s[1]), std::sin(s[2]));
    }
    if (scan_.has_pose) p = turned(p) + scan_.translation;
    if (!finite(p))
      pages_.fail(fmt::format("record {} of {}: ({} {} {}) is not finite, and not marked as invalid",
                              records.first() + i, label_, p[0], p[1], p[2]),
                  records.packet());
    set_.points.push_back(p);
    if (roles_.normal[0] != none) {
      const Vec3 n = turned(three(records, roles_.normal, i));
      unknown_normals_ += !finite(n);
      set_.normals.push_back(finite(n) ? n : Vec3(0, 0, 0));
    }
    if (roles_.intensity != none)
      set_.intensity.push_back(is_marked(records, roles_.intensity_invalid, i) ? unknown
                                                                               : records.value(roles_.intensity, i));
    if (roles_.color[0] != none) {
      std::array<std::uint8_t, 3> color{0, 0, 0};
      if (!is_marked(records, roles_.color_invalid, i))
        for (std::size_t k = 0; k < 3; ++k) color[k] = level(records.value(roles_.color[k], i), color_range_[k]);
      set_.colors.push_back(color);
    }
    for (std::size_t k = 0; k < roles_.scalars.size(); ++k) scalars_[k]->push_back(records.value(roles_.scalars[k], i));
    if (scalars_.size() > roles_.scalars.size()) scalars_.back()->push_back(static_cast<double>(number_ + 1));
    return true;
  }

  static bool finite(const Vec3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }
  static bool is_marked(const E57Records& records, std::size_t field, std::size_t i) {
    return field != none && records.value(field, i) != 0;
  }
  static Vec3 three(const E57Records& records, const Three& fields, std::size_t i) {
    return {records.value(fields[0], i), records.value(fields[1], i), records.value(fields[2], i)};
  }
  Vec3 turned(const Vec3& v) const {
    if (!scan_.has_pose) return v;
    return {scan_.rotation[0] | v, scan_.rotation[1] | v, scan_.rotation[2] | v};
  }
  std::uint8_t level(double value, const E57Range& range) {
    const double share = (value - range.low) / (range.high - range.low);
    if (!(share >= 0 && share <= 1)) {
      ++colors_beyond_;
      return share > 1 ? 255 : 0;
    }
    return static_cast<std::uint8_t>(std::lround(255 * share));
  }

  void write_notes(std::uint64_t skipped) {
    const auto note = [this](const std::string& text) { info_.notes.push_back(fmt::format("{}: {}", label_, text)); };
    if (skipped > 0)
      note(fmt::format("{} of {} records have no valid coordinates and were skipped", skipped, scan_.records));
    if (roles_.intensity != none && scan_.intensity_limits)
      note(fmt::format("the scanner's intensity goes from {} to {}", scan_.intensity_limits->low,
                       scan_.intensity_limits->high));
    if (!ignored_.empty()) note("fields ignored: " + ignored_);
    if (unknown_normals_ > 0) note(fmt::format("{} points have no normal: it is given as 0 0 0", unknown_normals_));
    if (colors_beyond_ > 0)
      note(fmt::format("{} colour values are beyond the limits that the file states, and were set to them",
                       colors_beyond_));
  }

  E57Pages& pages_;
  const E57Scan& scan_;
  std::size_t number_;
  PointSet& set_;
  PointsFileInfo& info_;
  std::string label_;
  Roles roles_;
  std::set<std::size_t> used_;
  std::array<E57Range, 3> color_range_{};
  std::vector<std::vector<double>*> scalars_;
  std::string ignored_;
  std::uint64_t unknown_normals_ = 0, colors_beyond_ = 0;
};

/// All records together need no more bits than the file has; so no count in it can ask for memory that it does not
/// fill.
void check_counts(const E57Pages& pages, const std::vector<E57Scan>& scans, std::size_t bytes) {
  double bits = 0;
  for (const E57Scan& scan : scans)
    for (const E57Field& field : scan.fields) bits += field.bits() * static_cast<double>(scan.records);
  if (bits > 8.0 * static_cast<double>(bytes))
    pages.fail(fmt::format("truncated or absurd: the records of all scans need {:.0f} bytes, the file has {}", bits / 8,
                           bytes),
               pages.xml_offset());
}

}  // namespace

PointSet parse_e57(std::string_view bytes, const std::string& file, Context& context, PointsFileInfo& info) {
  info.format = PointsFormat::e57;
  info.unit = std::string(1, 'm');
  E57Pages pages(bytes, file);
  const E57Structure structure = read_e57_structure(pages);
  if (structure.scans.empty()) pages.fail("the file holds no scan", pages.xml_offset());
  check_counts(pages, structure.scans, bytes.size());
  std::uint64_t total = 0;
  for (const E57Scan& scan : structure.scans) total += scan.records;
  PointSet set;
  std::uint64_t earlier = 0;
  for (std::size_t k = 0; k < structure.scans.size(); ++k) {
    const E57Scan& scan = structure.scans[k];
    if (scan.records == 0) {
      info.scans.push_back({scan.name, scan.sensor, 0, 0, scan.has_pose, scan.rotation, scan.translation});
      info.notes.push_back(fmt::format("{} holds no record", ScanParser::label(scan, k)));
      continue;
    }
    ScanParser(pages, scan, k, set, info).run(structure.scans.size() > 1, earlier, total, context);
    earlier += scan.records;
  }
  if (structure.pictures > 0) info.notes.push_back(fmt::format("{} pictures are not read", structure.pictures));
  return set;
}

}  // namespace tri::io_detail
