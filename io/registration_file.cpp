#include "io/registration_file.hpp"

#include <fmt/format.h>

#include <bit>
#include <limits>

#include "io/atomic_file.hpp"
#include "io/input_file.hpp"
#include "io/point_formats/points_writer.hpp"
#include "io/text_number.hpp"
#include "meshops/error.hpp"
#include "meshops/points/point_soup.hpp"

namespace tri {
namespace {

constexpr std::size_t records_between_checkpoints = 1 << 13;

struct Record {
  std::int32_t face;  // 1-based; 0 for none
  double u, v, deviation;
  Vec3 foot;
  bool on_edge;
};

Record record_of(const Foot& foot, const CadModel& model) {
  if (foot.face < 0) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {0, nan, nan, nan, Vec3(nan, nan, nan), false};
  }
  return {model.faces[static_cast<std::size_t>(foot.face)].index,
          foot.uv[0],
          foot.uv[1],
          foot.deviation,
          foot.point,
          foot.edge >= 0};
}

// What is known of the points beside their place.
struct Extras {
  const PointSet& set;
  io_detail::NamedColumns columns;

  explicit Extras(const PointSet& points) : set(points) {
    static constexpr std::string_view taken[] = {
        "index", "point_index", "x",       "y",  "z",  "face", "cad_face",     "u",   "v",     "fx",  "fy",
        "fz",    "deviation",   "on_edge", "nx", "ny", "nz",   intensity_name, "red", "green", "blue"};
    columns = io_detail::numbers_of(points, taken);
  }
};

class CsvWriter {
 public:
  CsvWriter(AtomicFile& file, const Extras& extras) : text_(file), extras_(extras) {}
  void header() {
    text_ << "index,x,y,z,face,u,v,fx,fy,fz,deviation,on_edge";
    if (!extras_.set.normals.empty()) text_ << ",nx,ny,nz";
    if (!extras_.set.intensity.empty()) text_ << ',' << intensity_name;
    if (!extras_.set.colors.empty()) text_ << ",red,green,blue";
    for (const auto& column : extras_.columns) text_ << ',' << column.first;
    text_ << '\n';
  }
  void record(std::size_t index, const Record& r) {
    const PointSet& set = extras_.set;
    const Vec3& p = set.points[index];
    text_ << index;
    for (const double x : {p[0], p[1], p[2]}) text_ << ',' << x;
    text_ << ',' << r.face;
    for (const double x : {r.u, r.v, r.foot[0], r.foot[1], r.foot[2], r.deviation}) text_ << ',' << x;
    text_ << (r.on_edge ? ",1" : ",0");
    if (!set.normals.empty())
      for (int k = 0; k < 3; ++k) text_ << ',' << set.normals[index][k];
    if (!set.intensity.empty()) text_ << ',' << set.intensity[index];
    if (!set.colors.empty())
      for (const std::uint8_t c : set.colors[index]) text_ << ',' << static_cast<int>(c);
    for (const auto& column : extras_.columns) text_ << ',' << (*column.second)[index];
    text_ << '\n';
  }

 private:
  io_detail::TextWriter text_;
  const Extras& extras_;
};

class PlyWriter {
 public:
  PlyWriter(AtomicFile& file, const Extras& extras) : file_(file), extras_(extras) {}
  void header() {
    static_assert(std::endian::native == std::endian::little);
    const std::size_t count = extras_.set.size();
    wide_ = count > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
    file_.write(
        fmt::format("ply\nformat binary_little_endian 1.0\ncomment written by tri\nelement vertex {}\n"
                    "property double x\nproperty double y\nproperty double z\nproperty {} point_index\n"
                    "property int cad_face\nproperty double u\nproperty double v\nproperty double deviation\n"
                    "property double fx\nproperty double fy\nproperty double fz\nproperty uchar on_edge\n",
                    count, wide_ ? "double" : "int"));
    const auto declare = [this](std::string_view type, std::string_view name) {
      file_.write(fmt::format("property {} {}\n", type, name));
    };
    if (!extras_.set.normals.empty())
      for (const char* name : {"nx", "ny", "nz"}) declare("double", name);
    if (!extras_.set.intensity.empty()) declare("double", intensity_name);
    if (!extras_.set.colors.empty())
      for (const char* name : {"red", "green", "blue"}) declare("uchar", name);
    for (const auto& column : extras_.columns) declare("double", column.first);
    file_.write("end_header\n");
  }
  void record(std::size_t index, const Record& r) {
    const PointSet& set = extras_.set;
    const Vec3& p = set.points[index];
    for (const double x : {p[0], p[1], p[2]}) file_.write_value(x);
    if (wide_)
      file_.write_value(static_cast<double>(index));
    else
      file_.write_value(static_cast<std::int32_t>(index));
    file_.write_value(r.face);
    for (const double x : {r.u, r.v, r.deviation, r.foot[0], r.foot[1], r.foot[2]}) file_.write_value(x);
    file_.write_value(static_cast<std::uint8_t>(r.on_edge));
    if (!set.normals.empty())
      for (int k = 0; k < 3; ++k) file_.write_value(set.normals[index][k]);
    if (!set.intensity.empty()) file_.write_value(set.intensity[index]);
    if (!set.colors.empty())
      for (const std::uint8_t c : set.colors[index]) file_.write_value(c);
    for (const auto& column : extras_.columns) file_.write_value((*column.second)[index]);
  }

 private:
  AtomicFile& file_;
  const Extras& extras_;
  bool wide_ = false;
};

template <class Writer>
void write_with(AtomicFile& file, const PointSet& points, std::span<const Foot> feet, const CadModel& model,
                Context& context) {
  const Extras extras(points);
  Writer writer(file, extras);
  writer.header();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % records_between_checkpoints == 0) {
      context.checkpoint();
      context.progress("write", static_cast<double>(i) / static_cast<double>(points.size()));
    }
    writer.record(i, record_of(feet[i], model));
  }
  context.checkpoint();
  context.progress("write", 1);
}

}  // namespace

void write_registration(const std::string& path, const PointSet& points, std::span<const Foot> feet,
                        const CadModel& model, Context& context) {
  validate(points);
  if (points.size() != feet.size())
    throw InvalidInput(fmt::format("write_registration: {} feet for {} points", feet.size(), points.size()));
  const std::string extension = file_extension(path);
  if (extension != "csv" && extension != "ply")
    throw InvalidInput(fmt::format("write_registration: the extension of {} is neither .csv nor .ply", path));
  AtomicFile file(path);
  if (extension == "csv")
    write_with<CsvWriter>(file, points, feet, model, context);
  else
    write_with<PlyWriter>(file, points, feet, model, context);
  file.commit();
}

}  // namespace tri
