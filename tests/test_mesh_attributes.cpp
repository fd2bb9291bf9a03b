// Every kind of attribute through every format, alone and together: what the format can hold comes back bit for bit,
// and what it cannot is named in the notes of writing, once.

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <functional>
#include <random>

#include "mesh_io_helpers.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

/// One attribute that a soup can have.
struct Attribute {
  std::string word;  ///< by which a note names it
  std::function<void(Soup&)> add;
  std::function<bool(const Soup&, const Soup&)> same;
};

using Scalars = std::map<std::string, std::vector<double>>;

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y) || (std::isnan(x) && std::isnan(y));
  });
}

bool same_scalar(const Scalars& a, const Scalars& b, const std::string& name) {
  return a.contains(name) && b.contains(name) && same_bits(a.at(name), b.at(name));
}

/// The names that the triangles have by a label; "" for none.
std::vector<std::string> named(const Soup& soup, const std::string& scalar) {
  std::vector<std::string> result;
  if (!soup.face_scalars.contains(scalar) || !soup.face_labels.contains(scalar)) return result;
  for (const double label : soup.face_scalars.at(scalar))
    result.push_back(label >= 0 ? soup.face_labels.at(scalar)[static_cast<std::size_t>(label)] : "");
  return result;
}

Attribute labelled(const std::string& name, std::vector<std::string> names,
                   const std::function<double(std::size_t, std::size_t)>& label) {
  return {name,
          [=](Soup& soup) {
            for (std::size_t i = 0; i < soup.triangles.size(); ++i)
              soup.face_scalars[name].push_back(label(i, soup.triangles.size()));
            soup.face_labels[name] = names;
          },
          [name](const Soup& a, const Soup& b) { return named(a, name) == named(b, name); }};
}

Attribute corner(const std::string& name, const std::function<double(const Soup&, std::size_t)>& value) {
  return {name,
          [=](Soup& soup) {
            for (std::size_t i = 0; i < 3 * soup.triangles.size(); ++i)
              soup.corner_scalars[name].push_back(value(soup, i));
          },
          [name](const Soup& a, const Soup& b) { return same_scalar(a.corner_scalars, b.corner_scalars, name); }};
}

Attribute face(const std::string& name, const std::function<double(std::size_t)>& value) {
  return {name,
          [=](Soup& soup) {
            for (std::size_t i = 0; i < soup.triangles.size(); ++i) soup.face_scalars[name].push_back(value(i));
          },
          [name](const Soup& a, const Soup& b) { return same_scalar(a.face_scalars, b.face_scalars, name); }};
}

std::uint32_t vertex_of(const Soup& soup, std::size_t c) {
  return soup.triangles[c / 3][c % 3];
}

/// In groups: what only exists together is added together. All numbers are floats, so that every format could hold
/// them.
std::vector<std::vector<Attribute>> attributes() {
  const auto by_vertex = [](double factor) {
    return [factor](const Soup& soup, std::size_t c) { return static_cast<double>(vertex_of(soup, c) % 64) * factor; };
  };
  std::vector<std::vector<Attribute>> all;
  all.push_back({{"normals",
                  [](Soup& soup) {
                    for (std::size_t i = 0; i < soup.points.size(); ++i)
                      soup.vertex_normals.push_back(i % 2 ? Vec3(0, 0, -1) : Vec3(0, 1, 0));
                  },
                  [](const Soup& a, const Soup& b) { return a.vertex_normals == b.vertex_normals; }}});
  all.push_back(
      {{"colours",
        [](Soup& soup) {
          for (std::size_t i = 0; i < soup.points.size(); ++i)
            soup.vertex_colors.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(255 - i), 1});
        },
        [](const Soup& a, const Soup& b) { return a.vertex_colors == b.vertex_colors; }}});
  all.push_back(
      {{"deviation",
        [](Soup& soup) {
          for (std::size_t i = 0; i < soup.points.size(); ++i)
            soup.vertex_scalars["deviation"].push_back(static_cast<double>(i) / 8 - 1);
        },
        [](const Soup& a, const Soup& b) { return same_scalar(a.vertex_scalars, b.vertex_scalars, "deviation"); }}});
  all.push_back({face("quality", [](std::size_t i) { return static_cast<double>(i) / 3; })});
  all.push_back({face("attribute", [](std::size_t i) { return static_cast<double>(40000 + i); })});
  all.push_back(
      {labelled("group", {"low", "high"}, [](std::size_t i, std::size_t) { return static_cast<double>(i % 2); })});
  all.push_back(
      {labelled("object", {"left", "right"}, [](std::size_t i, std::size_t n) { return i < n / 2 ? 0.0 : 1.0; })});
  all.push_back({labelled("material", {"steel", "brass"},
                          [](std::size_t i, std::size_t) { return static_cast<double>(i / 5 % 2); })});
  std::vector<Attribute> face_color;
  for (const char* name : {"red", "green", "blue"})
    face_color.push_back(face(name, [=](std::size_t i) { return static_cast<double>((i * 7 + *name) % 256); }));
  all.push_back(face_color);
  all.push_back({corner("s", by_vertex(1.0 / 64)), corner("t", by_vertex(1.0 / 128))});
  all.push_back({corner("nx", [](const Soup&, std::size_t c) { return c % 2 ? 1.0 : 0.0; }),
                 corner("ny", [](const Soup&, std::size_t c) { return c % 2 ? 0.0 : 1.0; }),
                 corner("nz", [](const Soup&, std::size_t) { return 0.0; })});
  all.push_back({corner("weight", [](const Soup&, std::size_t c) { return static_cast<double>(c); })});
  return all;
}

/// How often the notes name a word.
int times_named(const std::vector<std::string>& notes, const std::string& word) {
  int count = 0;
  for (const std::string& note : notes)
    for (std::size_t at = note.find(word); at != note.npos; at = note.find(word, at + 1)) {
      const auto letter = [&](std::size_t i) {
        return i < note.size() && std::isalpha(static_cast<unsigned char>(note[i]));
      };
      count += !(at > 0 && letter(at - 1)) && !letter(at + word.size());
    }
  return count;
}

/// Two parts that share no vertex, floats, vertices in the order in which triangles name them: every format could hold
/// it.
Soup base() {
  const Soup parts = joined(sphere(5, 3, 2), cube({4, 0.25, 0}));
  Soup soup;
  std::vector<std::int64_t> number(parts.points.size(), -1);
  for (const Triangle& t : parts.triangles) {
    Triangle renumbered{};
    for (std::size_t k = 0; k < 3; ++k) {
      if (number[t[k]] < 0) {
        number[t[k]] = static_cast<std::int64_t>(soup.points.size());
        const Vec3& p = parts.points[t[k]];
        soup.points.emplace_back(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
      }
      renumbered[k] = static_cast<std::uint32_t>(number[t[k]]);
    }
    soup.triangles.push_back(renumbered);
  }
  return soup;
}

void check_format(const char* name, bool ascii, const std::vector<std::vector<Attribute>>& chosen) {
  Soup soup = base();
  for (const auto& group : chosen)
    for (const Attribute& attribute : group) attribute.add(soup);
  TemporaryFolder folder;
  Context context;
  const MeshWriteReport report = write_mesh(folder / name, soup, {.ascii = ascii}, context);
  const Soup back = read_mesh(folder / name, context);
  check_same_geometry(back, soup);
  std::string notes;
  for (const std::string& note : report.notes) notes += note + "; ";
  CAPTURE(notes);
  for (const auto& group : chosen)
    for (const Attribute& attribute : group) {
      CAPTURE(attribute.word);
      CHECK(attribute.same(soup, back) == (times_named(report.notes, attribute.word) == 0));
      CHECK(times_named(report.notes, attribute.word) <= 1);
    }
}

}  // namespace

TEST_CASE("formats: each attribute alone and all together come back bit for bit or are named once") {
  const auto all = attributes();
  std::vector<std::pair<const char*, bool>> formats{{"a.stl", false}, {"a.stl", true},  {"a.obj", false},
                                                    {"a.ply", false}, {"a.ply", true},  {"a.off", false},
                                                    {"a.glb", false}, {"a.gltf", false}};
#ifdef TRI_WITH_3MF
  formats.emplace_back("a.3mf", false);
#endif
  for (const auto& format : formats) {
    const char* const name = format.first;
    const bool ascii = format.second;
    CAPTURE(name);
    CAPTURE(ascii);
    check_format(name, ascii, {});
    check_format(name, ascii, all);
    for (const auto& attribute : all) check_format(name, ascii, {attribute});
  }
}

TEST_CASE("formats: each two attributes, in formats where one may take the place of the other") {
  const auto all = attributes();
  for (const char* name : {"a.obj", "a.off",
#ifdef TRI_WITH_3MF
                           "a.3mf",
#endif
                           "a.glb"}) {
    CAPTURE(name);
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) check_format(name, false, {all[k], all[i]});
  }
}

TEST_CASE("formats: text holds any double, bit for bit") {
  std::mt19937_64 random(7);
  Soup soup;
  while (soup.points.size() < 300) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
      do p[k] = std::bit_cast<double>(random());
      while (!std::isfinite(p[k]));
    }
    soup.points.push_back(p);
  }
  for (std::uint32_t i = 0; i + 2 < 300; i += 3) soup.triangles.push_back({i, i + 1, i + 2});
  std::vector<std::pair<const char*, bool>> formats{
      {"a.stl", true}, {"a.obj", false}, {"a.ply", true}, {"a.ply", false}, {"a.off", false}};
#ifdef TRI_WITH_3MF
  formats.emplace_back("a.3mf", false);
#endif
  for (const auto& format : formats) {
    CAPTURE(format.first);
    check_same_geometry(round_trip(soup, format.first, format.second), soup);
  }
}
