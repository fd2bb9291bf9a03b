#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "io/mesh_formats/mesh_formats.hpp"
#include "io/mesh_formats/mesh_losses.hpp"
#include "io/mesh_formats/polygon.hpp"
#include "io/pictures/face_color.hpp"
#include "io/text_number.hpp"
#include "io/text_scanner.hpp"

// OFF as Geomview's manual describes it: [ST][C][N][4][n]OFF, three counts, vertices with normal, colour and texture
// coordinates as the header's letters say, faces with an optional colour; "#" begins a comment anywhere.
namespace tri::io_detail {
namespace {

struct OffHeader {
  bool known = false;  // the word is one an OFF file can begin with
  bool texture = false, color = false, normal = false, other_dimension = false;
};

OffHeader parse_keyword(std::string_view word) {
  OffHeader header;
  const auto take = [&word](std::string_view prefix) {
    if (!word.starts_with(prefix)) return false;
    word.remove_prefix(prefix.size());
    return true;
  };
  header.texture = take("ST");
  header.color = take("C");
  header.normal = take("N");
  header.other_dimension = take("4") || take("n");
  header.known = word == "OFF";
  return header;
}

class OffParser {
 public:
  OffParser(std::string_view bytes, const std::string& file, MeshFileInfo& info)
      : scanner_(bytes, file), info_(info), size_(bytes.size()) {}

  Soup run(Context& context) {
    info_.encoding = MeshEncoding::ascii;
    info_.parts.emplace_back();
    header();
    vertices(context);
    faces(context);
    if (scanner_.next_filled_line('#'))
      info_.notes.push_back(
          fmt::format("what follows the last face was left out, from {}", quoted(scanner_.rest_of_line())));
    collector_.finish(soup_, info_, context);
    if (extra_ > 0)
      info_.notes.push_back(
          fmt::format("further values of {} vertices, which the header does not name, are not kept", extra_));
    if (header_.texture)
      for (const char* name : {"s", "t"}) {
        std::vector<double>& values = soup_.corner_scalars[name];
        for (const Triangle& t : soup_.triangles)
          for (const std::uint32_t v : t) values.push_back(textures_[v][*name == 't']);
      }
    keep_face_colors();
    if (transparent_ > 0)
      info_.notes.push_back(fmt::format("the transparency of {} colours is not kept", transparent_));
    return std::move(soup_);
  }

 private:
  void header() {
    if (!scanner_.next_filled_line('#')) scanner_.fail("not an OFF file: there is no line that is no comment");
    const char* first = scanner_.position();
    const std::string_view word = scanner_.token();
    header_ = parse_keyword(word);
    if (!header_.known) {
      header_ = {};
      scanner_.move_to(first);  // the word is optional
      if (word.find_first_not_of("0123456789") != std::string_view::npos)
        scanner_.fail("not an OFF file: it begins with " + quoted(word));
    } else {
      if (header_.other_dimension) scanner_.fail(quoted(word) + ": only OFF files of three dimensions are read", first);
      if (!scanner_.at_line_end('#')) {
        const char* next = scanner_.position();
        if (scanner_.token() == "BINARY") scanner_.fail("binary OFF is not read", next);
        scanner_.move_to(next);
      }
    }
    if (scanner_.at_line_end('#')) {
      scanner_.next_line();
      if (!scanner_.next_filled_line('#')) scanner_.fail("truncated: the file ends before the counts");
    }
    vertex_count_ = count("the number of vertices");
    face_count_ = count("the number of faces");
    if (!scanner_.at_line_end('#')) count("the number of edges");
    finish_line("the counts");
    // A vertex takes at least "0 0 0", a face "0", both with a line end.
    if (vertex_count_ > (scanner_.remaining() + 1) / 6 || face_count_ > (scanner_.remaining() + 1) / 2)
      scanner_.fail(fmt::format("truncated or absurd: {} vertices and {} faces in the header, {} bytes left",
                                vertex_count_, face_count_, scanner_.remaining()),
                    first);
  }

  std::uint64_t count(const char* what) {
    const std::int64_t value = scanner_.integer(what);
    if (value < 0 || value > 0xFFFFFFFE) scanner_.fail(fmt::format("{} is {}", what, value));
    return static_cast<std::uint64_t>(value);
  }

  void finish_line(const char* what) {
    if (!scanner_.at_line_end('#'))
      scanner_.fail(fmt::format("{} where the line of {} should end", quoted(scanner_.token()), what));
    scanner_.next_line();
  }

  void report(Context& context, std::size_t i) const {
    if (i % (checkpoint_interval / 4) != 0) return;
    context.checkpoint();
    context.progress("read", static_cast<double>(scanner_.offset()) / static_cast<double>(size_));
  }

  void vertices(Context& context) {
    soup_.points.reserve(vertex_count_);
    if (header_.normal) soup_.vertex_normals.reserve(vertex_count_);
    Colors colors;
    std::vector<double> values;
    std::vector<char> pointed;  // written with a point or an exponent
    for (std::uint64_t i = 0; i < vertex_count_; ++i) {
      report(context, i);
      if (!scanner_.next_filled_line('#')) scanner_.fail(fmt::format("truncated: {} of {} vertices", i, vertex_count_));
      const double x = scanner_.coordinate("x");
      const double y = scanner_.coordinate("y");
      const double z = scanner_.coordinate("z");
      soup_.points.emplace_back(x, y, z);
      if (header_.normal) {
        const double nx = scanner_.coordinate("normal x");
        const double ny = scanner_.coordinate("normal y");
        const double nz = scanner_.coordinate("normal z");
        soup_.vertex_normals.emplace_back(nx, ny, nz);
      }
      rest_of_line(values, pointed, "a colour or texture coordinate");
      if (header_.texture && values.size() < 2) scanner_.fail(fmt::format("vertex {} has no texture coordinates", i));
      const std::size_t color_values = values.size() - (header_.texture ? 2 : 0);
      if (header_.texture) textures_.push_back({values[color_values], values[color_values + 1]});
      if (header_.color) {
        if (color_values != 3 && color_values != 4)
          scanner_.fail(fmt::format("vertex {} has {} colour values, not 3 or 4", i, color_values));
        add_color(colors, values, pointed, color_values, "vertex", i);
      } else {
        extra_ += color_values > 0;
      }
      scanner_.next_line();
    }
    soup_.vertex_colors = levels(colors);
  }

  /// The numbers up to the end of the line.
  void rest_of_line(std::vector<double>& values, std::vector<char>& pointed, const char* what) {
    values.clear();
    pointed.clear();
    while (!scanner_.at_line_end('#')) {
      const char* first = scanner_.position();
      values.push_back(scanner_.number(what));
      const std::string_view text(first, static_cast<std::size_t>(scanner_.position() - first));
      pointed.push_back(text.find_first_of(".eE") != std::string_view::npos);
    }
  }

  /// Colours before it is known whether they count to 1 or to 255.
  struct Colors {
    std::vector<std::array<double, 3>> list;
    std::vector<double> alphas;
    bool fractions = false;
    double largest = 0;
  };

  void add_color(Colors& colors, const std::vector<double>& values, const std::vector<char>& pointed, std::size_t count,
                 const char* element, std::uint64_t i) {
    for (std::size_t k = 0; k < count; ++k) {
      if (!(values[k] >= 0 && values[k] <= 255))
        scanner_.fail(fmt::format("colour value {} of {} {} is outside of 0 to 255", values[k], element, i));
      colors.largest = std::max(colors.largest, values[k]);
      colors.fractions = colors.fractions || pointed[k];
    }
    colors.list.push_back({values[0], values[1], values[2]});
    if (count == 4) colors.alphas.push_back(values[3]);
  }

  std::vector<std::array<std::uint8_t, 3>> levels(const Colors& colors) {
    // Integers count to 255 and fractions to 1; a file of ones without a point can only be meant as fractions if no
    // value, alpha included, is larger.
    const double scale = colors.largest <= 1 ? 255 : 1;
    if (colors.fractions && colors.largest > 1)
      info_.notes.emplace_back("colours with a fraction above 1 were taken as 0 to 255");
    for (const double alpha : colors.alphas) transparent_ += alpha * scale != 255;
    std::vector<std::array<std::uint8_t, 3>> result;
    result.reserve(colors.list.size());
    for (const auto& c : colors.list) {
      const auto level = [scale](double value) { return static_cast<std::uint8_t>(std::lround(value * scale)); };
      result.push_back({level(c[0]), level(c[1]), level(c[2])});
    }
    return result;
  }

  void keep_face_colors() {
    if (map_indices_ > 0)
      info_.notes.push_back(
          fmt::format("the colours of {} faces, places in a colour map or no colours, are not kept", map_indices_));
    if (face_colors_.list.empty()) return;
    const auto colors = levels(face_colors_);
    static constexpr const char* names[] = {"red", "green", "blue"};
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<double>& values = soup_.face_scalars[names[k]];
      values.assign(soup_.triangles.size(), std::numeric_limits<double>::quiet_NaN());
      for (std::size_t i = 0; i < colors.size(); ++i)
        for (std::size_t t = 0; t < colored_[i].count; ++t) values[colored_[i].first + t] = colors[i][k];
    }
  }

  void faces(Context& context) {
    std::vector<std::uint32_t> corners;
    std::vector<double> values;
    std::vector<char> pointed;
    for (std::uint64_t i = 0; i < face_count_; ++i) {
      report(context, i);
      if (!scanner_.next_filled_line('#')) scanner_.fail(fmt::format("truncated: {} of {} faces", i, face_count_));
      const std::int64_t size = scanner_.integer("the number of corners");
      if (size < 0 || static_cast<std::uint64_t>(size) > scanner_.remaining())
        scanner_.fail(fmt::format("a face of {} corners", size));
      corners.clear();
      for (std::int64_t k = 0; k < size; ++k) {
        const std::int64_t v = scanner_.integer("a vertex index");
        if (v < 0 || static_cast<std::uint64_t>(v) >= vertex_count_)
          scanner_.fail(
              fmt::format("vertex index {} is not within 0 to {}", v, static_cast<std::int64_t>(vertex_count_) - 1));
        corners.push_back(static_cast<std::uint32_t>(v));
      }
      const std::size_t first = collector_.triangles(), count = collector_.add(corners);
      if (!scanner_.at_line_end('#')) {
        rest_of_line(values, pointed, "a colour");
        if (values.size() == 3 || values.size() == 4) {
          add_color(face_colors_, values, pointed, values.size(), "face", i);
          colored_.push_back({first, count});
        } else {
          ++map_indices_;
        }
      }
      scanner_.next_line();
    }
  }

  TextScanner scanner_;
  MeshFileInfo& info_;
  std::size_t size_;
  OffHeader header_;
  std::uint64_t vertex_count_ = 0;
  std::uint64_t face_count_ = 0;
  std::uint64_t extra_ = 0;
  std::vector<std::array<double, 2>> textures_;  // of vertices
  struct Triangles {
    std::size_t first, count;
  };
  std::vector<Triangles> colored_;  // made of the faces that have a colour
  Colors face_colors_;
  std::uint64_t map_indices_ = 0, transparent_ = 0;
  Soup soup_;
  PolygonCollector collector_;
};

}  // namespace

bool has_off_header(std::string_view bytes) {
  const std::string file;
  TextScanner scanner(bytes.substr(0, 1 << 16), file);
  return scanner.next_filled_line('#') && parse_keyword(scanner.token()).known;
}

Soup parse_off(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info) {
  info.format = MeshFormat::off;
  return OffParser(bytes, file, info).run(context);
}

void write_off(AtomicFile& file, const Soup& soup, Context& context) {
  TextWriter out(file);
  const bool colors = !soup.vertex_colors.empty();
  const bool normals = !soup.vertex_normals.empty();
  const auto textures = vertex_textures(soup);
  const bool face_colors = has_face_colors(soup);
  out << (textures.empty() ? "" : "ST") << (colors ? "C" : "") << (normals ? "N" : "") << "OFF\n"
      << soup.points.size() << ' ' << soup.triangles.size() << " 0\n";
  for (std::size_t i = 0; i < soup.points.size(); ++i) {
    if (i % checkpoint_interval == 0) context.checkpoint();
    const Vec3& p = soup.points[i];
    out << p[0] << ' ' << p[1] << ' ' << p[2];
    if (normals)
      out << ' ' << soup.vertex_normals[i][0] << ' ' << soup.vertex_normals[i][1] << ' ' << soup.vertex_normals[i][2];
    if (colors) {
      // With an opaque alpha of 255 no reader can take the values for fractions of 1.
      for (const std::uint8_t c : soup.vertex_colors[i]) out << ' ' << static_cast<int>(c);
      out << " 255";
    }
    if (!textures.empty()) out << ' ' << textures[i][0] << ' ' << textures[i][1];
    out << '\n';
  }
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    if (i % checkpoint_interval == 0) {
      context.checkpoint();
      context.progress("write", static_cast<double>(i) / static_cast<double>(soup.triangles.size()));
    }
    const Triangle& t = soup.triangles[i];
    out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2];
    if (std::array<std::uint8_t, 3> color{}; face_colors && face_color(soup, i, color)) {
      for (const std::uint8_t c : color) out << ' ' << static_cast<int>(c);
      out << " 255";
    }
    out << '\n';
  }
}

}  // namespace tri::io_detail
