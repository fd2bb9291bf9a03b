#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <iostream>

#include "io/cad/cad_file.hpp"
#include "libtri/model/cad_model.hpp"
#include "libtri/model/cad_topology.hpp"
#include "libtri/model/shape_occt.hpp"
#include "meshops/error.hpp"
#include "occt_parts.hpp"
#include "temporary_folder.hpp"

using namespace tri;
using test::KnownSolid;
using test::TemporaryFolder;

namespace {

double total_area(const CadModel& model) {
  double sum = 0;
  for (const CadFace& face : model.faces) sum += face.area;
  return sum;
}

std::string replaced(std::string text, const std::string& what, const std::string& by, bool all = false) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = all ? text.find(what, at + by.size()) : std::string::npos)
    text.replace(at, what.size(), by);
  return text;
}

std::string box_file(const TemporaryFolder& folder, const std::string& name) {
  write_cad(folder / name, make_shape(BRepPrimAPI_MakeBox(20, 30, 10).Shape()));
  return folder / name;
}

/// What `action` wrote to the process's standard output and error, by whatever way.
template <class Action>
std::string printed_by(const TemporaryFolder& folder, Action action) {
  std::fflush(stdout), std::fflush(stderr);
  std::cout.flush(), std::cerr.flush();
  const int out = dup(1), err = dup(2);
  const int file = open((folder / "printed").c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
  dup2(file, 1), dup2(file, 2);
  try {
    action();
  } catch (const Error&) {
  }
  std::fflush(stdout), std::fflush(stderr);
  std::cout.flush(), std::cerr.flush();
  dup2(out, 1), dup2(err, 2);
  close(out), close(err), close(file);
  return test::file_bytes(folder / "printed");
}

}  // namespace

TEST_CASE("write_cad, read_cad: solids come back from every format with their faces, area and topology") {
  const TemporaryFolder folder;
  for (const KnownSolid& solid : test::known_solids())
    for (const std::string extension : {"igs", "step", "brep"}) {
      CAPTURE(solid.name);
      CAPTURE(extension);
      const std::string path = folder / ("part." + extension);
      write_cad(path, make_shape(solid.shape));
      Context context;
      const CadFile file = read_cad(path, context);
      CHECK(file.format == (extension == "igs" ? "IGES" : extension == "step" ? "STEP" : "BREP"));
      CHECK(file.faces == solid.faces);
      CHECK(file.solids == (extension == "igs" ? 0 : 1));
      CHECK(file.failed.empty());
      CHECK(file.unit_mm == 1);
      const CadModel model = make_cad_model(file.shape);
      CHECK(model.unusable_faces.empty());
      CHECK(total_area(model) == doctest::Approx(solid.area).epsilon(1e-5));
      const CadTopology topology = cad_topology(model);
      CHECK(topology.components == 1);
      CHECK(topology.loops == 0);
      CHECK(topology.euler == solid.euler);
    }
}

TEST_CASE("write_cad: IGES holds trimmed NURBS only, and nothing but the file is left in the folder") {
  const TemporaryFolder folder;
  write_cad(folder / "part.iges", make_shape(test::box_with_hole()));
  const std::string text = test::file_bytes(folder / "part.iges");
  std::size_t surfaces = 0, trimmed = 0;
  for (std::size_t line = 0; line < text.size(); line = text.find('\n', line) + 1) {
    if (text.size() < line + 73 || text[line + 72] != 'D') continue;
    const int type = std::stoi(text.substr(line, 8));
    const bool allowed =
        type == 128 || type == 126 || type == 144 || type == 142 || type == 102 || type == 402 || type == 314;
    CHECK_MESSAGE(allowed, "entity type ", type);
    surfaces += type == 128, trimmed += type == 144;
  }
  CHECK(surfaces == 14);  // two directory lines each
  CHECK(trimmed == 14);
  CHECK(folder.entries().size() == 1);
}

TEST_CASE("write_cad: refuses an empty shape, an unknown extension and a missing folder, leaving nothing behind") {
  const TemporaryFolder folder;
  const Shape box = make_shape(BRepPrimAPI_MakeBox(1, 1, 1).Shape());
  CHECK_THROWS_AS(write_cad(folder / "a.step", Shape()), InvalidInput);
  CHECK_THROWS_AS(write_cad(folder / "a.stl", box), InvalidInput);
  CHECK_THROWS_AS(write_cad(folder / "none/a.step", box), IoError);
  CHECK(folder.entries().empty());
}

TEST_CASE("read_cad: the content tells the format, whatever the extension") {
  const TemporaryFolder folder;
  Context context;
  for (const std::string extension : {"igs", "step", "brep"}) {
    const std::string misnamed = folder / ("misnamed." + std::string(extension == "step" ? "igs" : "step"));
    std::filesystem::rename(box_file(folder, "box." + extension), misnamed);
    CHECK(read_cad(misnamed, context).faces == 6);
  }
}

TEST_CASE("read_cad: what is no CAD file is one clear IoError") {
  const TemporaryFolder folder;
  Context context;
  const auto message_of = [&](const std::string& path) -> std::string {
    try {
      read_cad(path, context);
    } catch (const IoError& error) {
      CHECK(error.file() == path);
      return error.what();
    }
    return "no error";
  };
  const auto has = [](const std::string& message, const char* part) {
    CHECK_MESSAGE(message.find(part) != std::string::npos, message);
  };
  has(message_of(folder / "none.step"), "no such file");
  has(message_of(folder.path()), "folder");
  has(message_of(folder.make("empty.igs", "")), "empty");
  std::string garbage;
  for (unsigned i = 0, x = 1; i < 5000; ++i) garbage += static_cast<char>((x = x * 1664525u + 1013904223u) >> 24);
  for (const std::string name : {"g.igs", "g.step", "g.brep", "g"}) has(message_of(folder.make(name, garbage)), "no ");

  const std::string step = test::file_bytes(box_file(folder, "box.step"));
  const std::string iges = test::file_bytes(box_file(folder, "box.igs"));
  const std::string brep = test::file_bytes(box_file(folder, "box.brep"));
  for (const double share : {0.2, 0.5, 0.9}) {
    const auto cut = [&](const std::string& text) {
      return text.substr(0, static_cast<std::size_t>(share * static_cast<double>(text.size())));
    };
    has(message_of(folder.make("cut.step", cut(step))), "truncated");
    has(message_of(folder.make("cut.igs", cut(iges))), "truncated");
    has(message_of(folder.make("cut.brep", cut(brep))), "BREP");
  }
  has(message_of(folder.make("star.brep", replaced(brep, "\nCurves 12\n", "\nCurves *\n"))), "BREP");
  has(message_of(folder.make("data.step", step.substr(0, 300) + garbage + "\nEND-ISO-10303-21;\n")), "STEP");
  has(message_of(folder.make("none.step", "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n")),
      "STEP");
}

TEST_CASE("read_cad: a file without any face is a CadError that says so") {
  const TemporaryFolder folder;
  Context context;
  write_cad(folder / "edge.brep",
            make_shape(TopExp_Explorer(BRepPrimAPI_MakeBox(1, 1, 1).Shape(), TopAbs_EDGE).Current()));
  CHECK_THROWS_WITH_AS(read_cad(folder / "edge.brep", context), doctest::Contains("no face"), CadError);
}

TEST_CASE("read_cad: STEP without product structure is taken solid by solid") {
  const TemporaryFolder folder;
  const std::string whole = test::file_bytes(box_file(folder, "box.step"));
  std::string text;
  // Entities may span lines; drop everything that makes a product of the solid.
  for (std::size_t begin = 0; begin < whole.size();) {
    std::size_t end = whole.find(";\n", begin);
    end = end == std::string::npos ? whole.size() : end + 2;
    const std::string entity = whole.substr(begin, end - begin);
    const bool product = entity.find("PRODUCT") != std::string::npos ||
                         entity.find("SHAPE_DEFINITION_REPR") != std::string::npos ||
                         entity.find("SHAPE_REPRESENTATION") != std::string::npos;
    if (!product || entity[0] != '#') text += entity;
    begin = end;
  }
  CHECK(text.size() < whole.size());
  Context context;
  const CadFile file = read_cad(folder.make("bare.step", text), context);
  CHECK(file.faces == 6);
  CHECK(file.solids == 1);
}

TEST_CASE("read_cad: lengths of another declared unit are converted to millimetres") {
  const TemporaryFolder folder;
  const std::string text = test::file_bytes(box_file(folder, "box.step"));
  Context context;
  const CadFile file = read_cad(folder.make("cm.step", replaced(text, ".MILLI.,.METRE.", ".CENTI.,.METRE.")), context);
  CHECK(file.unit == "centimetre");
  CHECK(file.unit_mm == 10);
  const CadModel model = make_cad_model(file.shape);
  CHECK((model.box_max - model.box_min - Vec3(200, 300, 100)).norm() < 1e-6);
}

TEST_CASE("read_cad: names of faces and products reach the model") {
  const TemporaryFolder folder;
  std::string text = test::file_bytes(box_file(folder, "box.step"));
  text = replaced(text, "ADVANCED_FACE(''", "ADVANCED_FACE('left wall'");
  Context context;
  const CadFile file = read_cad(folder.make("named.step", text), context);
  CHECK(file.products.size() == 1);
  const CadModel model = make_cad_model(file.shape);
  int named = 0;
  for (const CadFace& face : model.faces) named += face.name == "left wall";
  CHECK(named == 1);
}

TEST_CASE("read_cad: an IGES face that cannot be read is named, the others are kept") {
  const TemporaryFolder folder;
  std::string text = test::file_bytes(box_file(folder, "box.igs"));
  // The first parameter line of one B-spline surface: 128,K1,K2,... becomes a surface of absurd size.
  const std::size_t at = text.find("\n128,1,1,1,1,") + 1;
  REQUIRE(at != std::string::npos + 1);
  text.replace(at, 8, "128,9,9,");
  Context context;
  const CadFile file = read_cad(folder.make("broken.igs", text), context);
  CHECK(file.faces == 5);
  REQUIRE(file.failed.size() == 1);
  CHECK(file.failed[0].entity.find("144") != std::string::npos);
  CHECK(!file.failed[0].reason.empty());
}

TEST_CASE("read_cad: a broken corner of a STEP solid costs the faces around it, by name, and no other") {
  const TemporaryFolder folder;
  const std::string text = test::file_bytes(box_file(folder, "box.step"));
  const std::size_t at = text.find("VERTEX_POINT('',#");
  REQUIRE(at != std::string::npos);
  const std::string broken = text.substr(0, at) + "VERTEX_POINT('',$" + text.substr(text.find(')', at));
  Context context;
  const CadFile file = read_cad(folder.make("corner.step", broken), context);
  CHECK(file.faces == 3);
  CHECK(file.failed.size() == 3);
  CHECK(make_cad_model(file.shape).faces.size() == 3);
}

TEST_CASE("read_cad, write_cad: nothing is printed and signal handlers stay as they were") {
  const TemporaryFolder folder;
  struct sigaction before, after;
  const std::string brep = test::file_bytes(box_file(folder, "box.brep"));
  folder.make("cut.brep", brep.substr(0, brep.size() / 2));
  for (const int signal : {SIGSEGV, SIGFPE, SIGINT}) {
    sigaction(signal, nullptr, &before);
    Context context;
    for (const char* name : {"box.step", "box.igs", "box.brep", "cut.brep"})
      CHECK(printed_by(folder, [&] {
              if (std::string(name) != "cut.brep") box_file(folder, name);
              read_cad(folder / name, context);
            }) == "");
    sigaction(signal, nullptr, &after);
    CHECK((before.sa_handler == after.sa_handler));
  }
}

TEST_CASE("read_cad: reports progress and stops when cancelled") {
  const TemporaryFolder folder;
  const std::string path = box_file(folder, "box.step");
  Context context;
  double last = -1;
  context.on_progress = [&](std::string_view, double share) {
    CHECK(share >= last);
    last = share;
  };
  read_cad(path, context);
  CHECK(last == 1);
  context.cancel();
  CHECK_THROWS_AS(read_cad(path, context), Cancelled);
}
