#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "e57_writer.hpp"
#include "io/point_formats/crc32c.hpp"
#include "io/points_file.hpp"
#include "mesh_io_helpers.hpp"

using namespace tri;
using namespace tri::test;

namespace {

PointSet read_e57(const std::string& bytes, PointsFileInfo* info = nullptr) {
  Context context;
  PointSet set = parse_points(bytes, "a.e57", context, info);
  CHECK_NOTHROW(validate(set));
  return set;
}

IoError refused_e57(const std::string& bytes) {
  Context context;
  try {
    parse_points(bytes, "a.e57", context);
  } catch (const IoError& error) {
    return error;
  }
  FAIL("accepted");
  return {"", ""};
}

bool says(const IoError& error, const std::string& word) {
  CAPTURE(error.what());
  return std::string(error.what()).find(word) != std::string::npos;
}

std::vector<double> random_values(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-10, 10);
  std::vector<double> values(n);
  for (double& v : values) v = value(random);
  return values;
}

std::vector<std::int64_t> random_integers(std::size_t n, std::int64_t low, std::int64_t high, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int64_t> value(low, high);
  std::vector<std::int64_t> values(n);
  for (std::int64_t& v : values) v = value(random);
  return values;
}

/// Three columns of doubles.
std::vector<E57TestField> xyz(const std::vector<double>& x, const std::vector<double>& y,
                              const std::vector<double>& z) {
  return {E57TestField::doubles("cartesianX", x), E57TestField::doubles("cartesianY", y),
          E57TestField::doubles("cartesianZ", z)};
}

std::string file_of(const E57TestScan& scan) {
  E57TestFile file;
  file.add(scan);
  return file.bytes();
}

const std::vector<double> one_to_three{1, 2, 3};

}  // namespace

TEST_CASE("crc32c: the check value of the standard, and the bit by bit definition for any length") {
  CHECK(io_detail::crc32c("123456789") == 0xE3069283);
  CHECK(io_detail::crc32c("") == 0);
  CHECK(io_detail::crc32c(std::string(32, '\0')) == 0x8A9136AA);  // RFC 3720, B.4
  CHECK(io_detail::crc32c(std::string(32, '\xFF')) == 0x62A8AB43);
  std::mt19937 random(3);
  for (std::size_t size = 0; size < 70; ++size) {
    std::string bytes(size, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    CHECK(io_detail::crc32c(bytes) == slow_crc32c(bytes));
  }
}

TEST_CASE("e57: doubles over many packets and pages come back exactly, in metres") {
  const std::size_t n = 5000;
  const auto x = random_values(n, 1), y = random_values(n, 2), z = random_values(n, 3);
  PointsFileInfo info;
  const PointSet set = read_e57(file_of({xyz(x, y, z), "<name type=\"String\"><![CDATA[hall]]></name>"}), &info);
  REQUIRE(set.size() == n);
  for (std::size_t i = 0; i < n; ++i) REQUIRE(set.points[i] == Vec3(x[i], y[i], z[i]));
  CHECK(info.format == PointsFormat::e57);
  CHECK(info.unit == "m");
  REQUIRE(info.scans.size() == 1);
  CHECK(info.scans[0].name == "hall");
  CHECK(info.scans[0].points == n);
  CHECK_FALSE(info.scans[0].has_pose);
  CHECK(info.notes.empty());
  CHECK(column_names(set).empty());
}

TEST_CASE("e57: integers of every width, scaled integers and floats are unpacked across packets") {
  const std::size_t n = 500;
  for (unsigned bits = 1; bits <= 64; ++bits) {
    CAPTURE(bits);
    const std::int64_t low = bits == 64 ? std::numeric_limits<std::int64_t>::min() : -5;
    const std::int64_t high =
        bits == 64 ? std::numeric_limits<std::int64_t>::max()
                   : static_cast<std::int64_t>(static_cast<std::uint64_t>(low) + ((std::uint64_t{1} << bits) - 1));
    const auto x = random_integers(n, low, high, bits), y = random_integers(n, 0, 1000, bits + 100);
    std::vector<float> z;
    for (std::size_t i = 0; i < n; ++i) z.push_back(static_cast<float>(i) / 7);
    E57TestScan scan{{E57TestField::integers("cartesianX", low, high, x),
                      E57TestField::integers("cartesianY", 0, 1000, y, "scale=\"0.001\" offset=\"2.5\""),
                      E57TestField::floats("cartesianZ", z)}};
    scan.bytes_per_packet = 61;
    const PointSet set = read_e57(file_of(scan));
    REQUIRE(set.size() == n);
    for (std::size_t i = 0; i < n; ++i)
      REQUIRE(set.points[i] ==
              Vec3(static_cast<double>(x[i]), static_cast<double>(y[i]) * 0.001 + 2.5, static_cast<double>(z[i])));
  }
}

TEST_CASE("e57: a field without bits is constant") {
  E57TestScan scan{xyz(one_to_three, one_to_three, one_to_three)};
  scan.fields[2] = E57TestField::integers("cartesianZ", 40, 40, {40, 40, 40}, "scale=\"0.1\" offset=\"1\"");
  const PointSet set = read_e57(file_of(scan));
  REQUIRE(set.size() == 3);
  CHECK(set.points[1] == Vec3(2, 2, 5));
  for (E57TestField& field : scan.fields) field = E57TestField::integers(field.name, 1, 1, {1, 1, 1});
  CHECK(says(refused_e57(file_of(scan)), "no bits"));
}

TEST_CASE("e57: records with an invalid state are skipped and counted, whatever they hold") {
  const double nan = std::nan("");
  E57TestScan scan{xyz({1, nan, 3, 4}, {1, nan, 3, 4}, {1, nan, 3, 4})};
  scan.fields.push_back(E57TestField::integers("cartesianInvalidState", 0, 2, {0, 2, 0, 1}));
  scan.fields.push_back(E57TestField::floats("intensity", {0.5f, 0.25f, 0.75f, 1.f}));
  scan.fields.push_back(E57TestField::integers("isIntensityInvalid", 0, 1, {0, 0, 1, 0}));
  PointsFileInfo info;
  const PointSet set = read_e57(file_of(scan), &info);
  CHECK(set.points == std::vector<Vec3>{{1, 1, 1}, {3, 3, 3}});
  REQUIRE(set.intensity.size() == 2);
  CHECK(set.intensity[0] == 0.5);
  CHECK(std::isnan(set.intensity[1]));
  CHECK(info.points_skipped == 2);
  CHECK(info.scans.at(0).skipped == 2);
  CHECK(has_note(info.notes, "2 of 4 records"));
  CHECK_FALSE(set.scalars.contains("cartesianInvalidState"));

  scan.fields[3] = E57TestField::integers("cartesianInvalidState", 0, 2, {0, 0, 0, 1});
  CHECK(says(refused_e57(file_of(scan)), "record 1 of scan 1"));
  scan.fields[3] = E57TestField::integers("cartesianInvalidState", 0, 2, {2, 2, 2, 1});
  CHECK(says(refused_e57(file_of(scan)), "no point"));
}

TEST_CASE("e57: several scans, each with its pose applied to points and normals") {
  E57TestFile file;
  // A quarter turn about z, then about x, as unit quaternions.
  const std::string half = "0.70710678118654757";
  const auto pose = [&](const char* axis, const char* x) {
    return "<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">" + half + "</w><" + axis +
           " type=\"Float\">" + half + "</" + axis + "></rotation><translation type=\"Structure\"><x type=\"Float\">" +
           x + "</x><y type=\"Float\"/><z type=\"Float\">-2</z></translation></pose>";
  };
  E57TestScan first{xyz({1, 0}, {0, 1}, {0, 0}), pose("z", "10")};
  for (const auto& [name, v] : {std::pair{"nor:normalX", 1.0}, {"nor:normalY", 0.0}, {"nor:normalZ", 0.0}})
    first.fields.push_back(E57TestField::doubles(name, {v, v}));
  E57TestScan second{xyz({0}, {1}, {0}), pose("x", "0")};
  second.fields.push_back(E57TestField::doubles("intensity", {7}));
  file.add(first);
  file.add(second);
  file.add({xyz({5}, {6}, {7})});
  PointsFileInfo info;
  const PointSet set = read_e57(file.bytes(), &info);
  const std::vector<Vec3> expected{{10, 1, -2}, {9, 0, -2}, {0, 0, -1}, {5, 6, 7}};
  REQUIRE(set.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) CHECK((set.points[i] - expected[i]).norm() < 1e-14);
  CHECK(set.points[3] == expected[3]);
  CHECK((set.normals[0] - Vec3(0, 1, 0)).norm() < 1e-14);
  CHECK(set.normals[2] == Vec3(0, 0, 0));  // not known
  CHECK(std::isnan(set.intensity[0]));
  CHECK(set.intensity[2] == 7);
  CHECK(std::isnan(set.intensity[3]));
  CHECK(set.scalars.at("scan") == std::vector<double>{1, 1, 2, 3});
  REQUIRE(info.scans.size() == 3);
  CHECK(info.scans[0].has_pose);
  CHECK(info.scans[0].translation == Vec3(10, 0, -2));
  CHECK(info.scans[1].points == 1);
  CHECK_FALSE(info.scans[2].has_pose);
}

TEST_CASE("e57: spherical coordinates are turned into cartesian ones") {
  const double pi = std::acos(-1);
  const E57TestScan scan{{E57TestField::doubles("sphericalRange", {2, 2, 3}),
                          E57TestField::doubles("sphericalAzimuth", {0, pi / 2, -pi / 6}),
                          E57TestField::doubles("sphericalElevation", {0, 0, pi / 3}),
                          E57TestField::integers("sphericalInvalidState", 0, 2, {0, 0, 0})}};
  const PointSet set = read_e57(file_of(scan));
  REQUIRE(set.size() == 3);
  CHECK((set.points[0] - Vec3(2, 0, 0)).norm() < 1e-15);
  CHECK((set.points[1] - Vec3(0, 2, 0)).norm() < 1e-15);
  CHECK((set.points[2] - Vec3(1.5 * std::sqrt(3) / 2, -0.75, 1.5 * std::sqrt(3))).norm() < 1e-14);
  // Beside cartesian coordinates they are a second telling of the same.
  E57TestScan both{xyz(one_to_three, one_to_three, one_to_three)};
  both.fields.push_back(scan.fields[0]);
  PointsFileInfo info;
  CHECK(read_e57(file_of(both), &info).points[2] == Vec3(3, 3, 3));
  CHECK(has_note(info.notes, "fields ignored: sphericalRange"));
}

TEST_CASE("e57: colours are brought to 0 to 255 by the limits of the file") {
  E57TestScan scan{xyz(one_to_three, one_to_three, one_to_three)};
  const auto colors = [](std::int64_t most, const std::vector<std::int64_t>& values) {
    std::vector<E57TestField> fields;
    for (const char* name : {"colorRed", "colorGreen", "colorBlue"})
      fields.push_back(E57TestField::integers(name, 0, most, values));
    return fields;
  };
  const auto with = [&](std::vector<E57TestField> more, const std::string& xml) {
    E57TestScan all = scan;
    all.fields.insert(all.fields.end(), more.begin(), more.end());
    all.more_xml = xml;
    return file_of(all);
  };
  const auto red = [](const PointSet& set) {
    return std::vector<int>{set.colors.at(0)[0], set.colors.at(1)[0], set.colors.at(2)[0]};
  };
  CHECK(red(read_e57(with(colors(255, {0, 7, 255}), ""))) == std::vector<int>{0, 7, 255});
  CHECK(red(read_e57(with(colors(65535, {0, 257 * 9, 65535}), ""))) == std::vector<int>{0, 9, 255});
  std::string limits = "<colorLimits type=\"Structure\">";
  for (const char* name : {"Red", "Green", "Blue"})
    limits += std::string("<color") + name + "Minimum type=\"Integer\"/><color" + name +
              "Maximum type=\"Integer\">1020</color" + name + "Maximum>";
  limits += "</colorLimits>";
  CHECK(red(read_e57(with(colors(65535, {0, 4, 1020}), limits))) == std::vector<int>{0, 1, 255});
  PointsFileInfo info;
  CHECK(red(read_e57(with(colors(65535, {0, 4, 1021}), limits), &info)) == std::vector<int>{0, 1, 255});
  CHECK(has_note(info.notes, "3 colour values are beyond"));
  auto marked = colors(255, {10, 20, 30});
  marked.push_back(E57TestField::integers("isColorInvalid", 0, 1, {0, 1, 0}));
  CHECK(red(read_e57(with(marked, ""))) == std::vector<int>{10, 0, 30});
}

TEST_CASE("e57: further fields are carried under their names, and what cannot be is named") {
  E57TestScan scan{xyz(one_to_three, one_to_three, one_to_three)};
  scan.fields.push_back(E57TestField::integers("rowIndex", 0, 100, {7, 8, 9}));
  scan.fields.push_back(E57TestField::floats("intensity", {1, 2, 3}));
  scan.more_xml =
      "<intensityLimits><intensityMinimum type=\"Float\"/><intensityMaximum>4095</intensityMaximum></intensityLimits>";
  scan.fields.push_back(E57TestField::doubles("timeStamp", {0.5, 0.25, 0.125}));
  scan.fields.push_back({"remark", "type=\"String\"", 8, {65, 66, 67}});
  scan.fields.push_back(E57TestField::integers("columnIndex", -3, 4, {-3, 0, 4}));
  PointsFileInfo info;
  const PointSet set = read_e57(file_of(scan), &info);
  CHECK(set.scalars.at("rowIndex") == std::vector<double>{7, 8, 9});
  CHECK(set.scalars.at("timeStamp") == std::vector<double>{0.5, 0.25, 0.125});
  CHECK(set.scalars.at("columnIndex") == std::vector<double>{-3, 0, 4});
  CHECK(set.scalars.size() == 3);
  CHECK(set.intensity == std::vector<double>{1, 2, 3});
  CHECK(has_note(info.notes, "intensity goes from 0 to 4095"));
  CHECK(has_note(info.notes, "fields ignored: remark"));
}

TEST_CASE("e57: every damaged byte is found by the checksums, with the page") {
  const std::string good = file_of({xyz(random_values(100, 1), random_values(100, 2), random_values(100, 3))});
  REQUIRE(good.size() >= 3 * 1024);
  for (std::size_t at = 48; at < good.size(); at += 37) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    const IoError error = refused_e57(bad);
    CHECK(says(error, "checksum"));
    CHECK(error.unit() == IoError::Unit::byte);
    CHECK(error.position() == at / 1024 * 1024);
  }
  for (std::size_t size = 0; size < good.size(); size += 53) {
    if (size < 8) continue;
    CHECK(says(refused_e57(good.substr(0, size)), "truncated"));
  }
}

TEST_CASE("e57: absurd counts and broken structures are refused with a position") {
  E57TestScan scan{xyz(one_to_three, one_to_three, one_to_three)};
  for (const std::int64_t count : {std::int64_t{4}, std::int64_t{1} << 40, std::numeric_limits<std::int64_t>::max()}) {
    scan.claimed_records = count;
    CHECK(says(refused_e57(file_of(scan)), "truncated"));
  }
  scan.claimed_records = 2;  // fewer than there are: the rest is not asked for
  CHECK(read_e57(file_of(scan)).size() == 2);
  scan.claimed_records = -1;
  scan.fields.pop_back();
  CHECK(says(refused_e57(file_of(scan)), "neither cartesian nor spherical"));

  const E57TestFile empty;
  const std::string root = "<e57Root type=\"Structure\">";
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"<e57Root", "not well-formed"},
      {"<other/>", "no element e57Root"},
      {root + "</e57Root>", "no scan"},
      {root + "<data3D><vectorChild/></data3D></e57Root>", "no element points"},
      {root + "<data3D><vectorChild><points fileOffset=\"48\"/></vectorChild></data3D></e57Root>", "recordCount"},
      {root + "<data3D><vectorChild><points fileOffset=\"x\" recordCount=\"1\"/></vectorChild></data3D></e57Root>",
       "no integer"},
      {root + "<data3D><vectorChild><points fileOffset=\"-1\" recordCount=\"1\"/></vectorChild></data3D></e57Root>",
       "is -1"},
      {root + "<data3D><vectorChild><points fileOffset=\"9999\" recordCount=\"1\"><prototype><cartesianX "
              "type=\"Float\"/><cartesianY type=\"Float\"/><cartesianZ type=\"Float\"/></prototype></points>"
              "</vectorChild></data3D></e57Root>",
       "9999"},
      {root + "<data3D><vectorChild><pose><rotation><w>1</w><x>1</x></rotation></pose><points fileOffset=\"48\" "
              "recordCount=\"0\"><prototype/></points></vectorChild></data3D></e57Root>",
       "no unit quaternion"},
      {root + "<data3D><vectorChild><points fileOffset=\"48\" recordCount=\"1\"><prototype><cartesianX "
              "type=\"Blob\"/></prototype></points></vectorChild></data3D></e57Root>",
       "unknown type"}};
  for (const auto& entry : wrong) {
    CAPTURE(entry.first);
    const IoError error = refused_e57(empty.bytes_with_xml(entry.first));
    CHECK(says(error, entry.second));
    CHECK(error.unit() == IoError::Unit::byte);
  }
}

TEST_CASE("e57: reading can be cancelled") {
  const std::string bytes = file_of({xyz(random_values(4000, 1), random_values(4000, 2), random_values(4000, 3))});
  Context context;
  context.on_checkpoint = [&context, seen = 0]() mutable {
    if (++seen == 3) context.cancel();
  };
  CHECK_THROWS_AS(parse_points(bytes, "a.e57", context), Cancelled);
}
