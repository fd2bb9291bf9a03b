#include "io/registration_file.hpp"

#include <fmt/format.h>

#include <bit>
#include <limits>

#include "io/atomic_file.hpp"
#include "io/input_file.hpp"
#include "io/text_number.hpp"
#include "meshops/error.hpp"

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

class CsvWriter {
 public:
  explicit CsvWriter(AtomicFile& file) : text_(file) {}
  void header(std::size_t) { text_ << "index,x,y,z,face,u,v,fx,fy,fz,deviation,on_edge\n"; }
  void record(std::size_t index, const Vec3& p, const Record& r) {
    text_ << index;
    for (const double x : {p[0], p[1], p[2]}) text_ << ',' << x;
    text_ << ',' << r.face;
    for (const double x : {r.u, r.v, r.foot[0], r.foot[1], r.foot[2], r.deviation}) text_ << ',' << x;
    text_ << (r.on_edge ? ",1\n" : ",0\n");
  }

 private:
  io_detail::TextWriter text_;
};

class PlyWriter {
 public:
  explicit PlyWriter(AtomicFile& file) : file_(file) {}
  void header(std::size_t count) {
    static_assert(std::endian::native == std::endian::little);
    wide_ = count > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
    file_.write(
        fmt::format("ply\nformat binary_little_endian 1.0\ncomment written by tri\nelement vertex {}\n"
                    "property double x\nproperty double y\nproperty double z\nproperty {} point_index\n"
                    "property int cad_face\nproperty double u\nproperty double v\nproperty double deviation\n"
                    "property double fx\nproperty double fy\nproperty double fz\nproperty uchar on_edge\nend_header\n",
                    count, wide_ ? "double" : "int"));
  }
  void record(std::size_t index, const Vec3& p, const Record& r) {
    for (const double x : {p[0], p[1], p[2]}) file_.write_value(x);
    if (wide_)
      file_.write_value(static_cast<double>(index));
    else
      file_.write_value(static_cast<std::int32_t>(index));
    file_.write_value(r.face);
    for (const double x : {r.u, r.v, r.deviation, r.foot[0], r.foot[1], r.foot[2]}) file_.write_value(x);
    file_.write_value(static_cast<std::uint8_t>(r.on_edge));
  }

 private:
  AtomicFile& file_;
  bool wide_ = false;
};

template <class Writer>
void write_with(AtomicFile& file, std::span<const Vec3> points, std::span<const Foot> feet, const CadModel& model,
                Context& context) {
  Writer writer(file);
  writer.header(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % records_between_checkpoints == 0) {
      context.checkpoint();
      context.progress("write", static_cast<double>(i) / static_cast<double>(points.size()));
    }
    writer.record(i, points[i], record_of(feet[i], model));
  }
  context.checkpoint();
  context.progress("write", 1);
}

}  // namespace

void write_registration(const std::string& path, std::span<const Vec3> points, std::span<const Foot> feet,
                        const CadModel& model, Context& context) {
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
