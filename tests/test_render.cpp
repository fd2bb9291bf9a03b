#include <doctest/doctest.h>
#include <png.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "io/pictures/palette.hpp"
#include "io/pictures/render.hpp"
#include "meshops/error.hpp"

using namespace tri;

namespace {

// The unit square in z = 0, seen from +z as counter-clockwise, as four triangles about its middle.
Soup square_soup() {
  Soup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}};
  soup.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  return soup;
}

Soup sphere(int rings) {
  Soup soup;
  const int around = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int k = 0; k < around; ++k) {
      const double a = std::numbers::pi * i / rings, b = 2 * std::numbers::pi * k / around;
      soup.points.push_back({std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)});
    }
  const auto at = [&](int i, int k) { return static_cast<std::uint32_t>(i * around + k % around); };
  for (int i = 0; i < rings; ++i)
    for (int k = 0; k < around; ++k) {
      soup.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      soup.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  return soup;
}

RenderOptions from_above() {
  RenderOptions options;
  options.width = 120;
  options.height = 100;
  options.view = {0, 0, 1};
  return options;
}

double distance(const Color& color, const Vec3& expected) {
  const Vec3 d = Vec3(color[0], color[1], color[2]) / 255.0 - expected;
  return d.norm();
}

const Color white{255, 255, 255};

}  // namespace

TEST_CASE("render: frames the part whole, in the middle and with a margin") {
  Context context;
  const Rendering r = render(square_soup(), from_above(), context);
  REQUIRE(r.picture.pixels.size() == 120 * 100);
  CHECK(r.picture.at(60, 50) != white);
  for (int x = 0; x < 120; ++x) CHECK((r.picture.at(x, 0) == white && r.picture.at(x, 99) == white));
  for (int y = 0; y < 100; ++y) CHECK((r.picture.at(0, y) == white && r.picture.at(119, y) == white));
  // The square fills the height but for 4% on each side, so 92 x 92 of 120 x 100 pixels.
  CHECK(r.covered == doctest::Approx(92.0 * 92.0 / (120 * 100)).epsilon(0.01));
}

TEST_CASE("render: zoom 2 shows twice the size about the centre") {
  Context context;
  RenderOptions options = from_above();
  options.zoom = 2;
  CHECK(render(square_soup(), options, context).covered == 1);
  options.zoom = 1;
  options.center = Vec3(0, 0, 0);  // the square's corner comes to the middle: it covers the upper right quarter
  const Rendering r = render(square_soup(), options, context);
  CHECK(r.picture.at(75, 30) != white);
  CHECK(r.picture.at(75, 70) == white);
  CHECK(r.picture.at(45, 30) == white);
  CHECK(r.picture.at(45, 70) == white);
}

TEST_CASE("render: the front and the back of a patch have different colours") {
  Context context;
  RenderOptions options = from_above();
  const Rendering front = render(square_soup(), options, context);
  options.view = {0, 0, -1};
  const Rendering back = render(square_soup(), options, context);
  CHECK(front.back == 0);
  CHECK(back.back == 1);
  CHECK(front.picture.at(60, 50)[2] > front.picture.at(60, 50)[0]);  // bluish
  CHECK(back.picture.at(60, 50)[0] > back.picture.at(60, 50)[2]);    // brownish
}

TEST_CASE("render: the nearer of two sheets hides the other, whatever their order in the file") {
  Context context;
  Soup soup = square_soup();
  const auto n = static_cast<std::uint32_t>(soup.points.size());
  for (std::uint32_t i = 0; i < n; ++i) soup.points.push_back(soup.points[i] + Vec3(0, 0, 1));
  for (int i = 0; i < 4; ++i)
    soup.triangles.push_back({soup.triangles[i][0] + n, soup.triangles[i][2] + n, soup.triangles[i][1] + n});
  for (const bool perspective : {false, true}) {
    RenderOptions options = from_above();
    options.perspective = perspective;
    CHECK(render(soup, options, context).back == 1);  // the upper sheet is upside down
    options.view = {0, 0, -1};
    CHECK(render(soup, options, context).back == 1);  // and so is the lower, seen from below
    std::swap(soup.triangles.front(), soup.triangles.back());
  }
}

TEST_CASE("render: a closed sphere shows no back and the area of its disc") {
  Context context;
  RenderOptions options = from_above();
  options.view = {1, -2, 0.5};
  const Rendering r = render(sphere(60), options, context);
  CHECK(r.back == 0);
  CHECK(r.covered == doctest::Approx(std::numbers::pi * 46 * 46 / (120 * 100)).epsilon(0.01));
}

TEST_CASE("render: chooses the palette by the scalar's values") {
  Context context;
  Soup soup = square_soup();
  soup.vertex_scalars["cad_face"] = {1, 1, 1, 2, 7};
  soup.vertex_scalars["deviation"] = {-0.1, 0.1, 0.05, 0, 0.02};
  soup.vertex_scalars["thickness"] = {1.5, 1, 1, 1, 1};
  soup.face_scalars["quality"] = {0.1, 0.2, 0.3, 0.4};
  RenderOptions options = from_above();
  const auto by = [&](const char* name) {
    options.by = name;
    return render(soup, options, context);
  };
  CHECK(by("cad_face").palette == Palette::categories);
  CHECK(by("cad_face").categories == 3);
  CHECK(by("deviation").palette == Palette::diverging);
  CHECK(by("deviation").low == -by("deviation").high);
  CHECK(by("thickness").palette == Palette::sequential);
  CHECK(by("quality").palette == Palette::sequential);
  CHECK(by("none").palette == Palette::plain);
  CHECK(by("").palette == Palette::plain);
  options.palette = Palette::sequential;
  CHECK(by("cad_face").palette == Palette::sequential);
}

TEST_CASE("render: a category colours the places nearest to its vertices, never with a mean of two") {
  Context context;
  Soup soup = square_soup();
  soup.vertex_scalars["cad_face"] = {1, 1, 1, 1, 3};  // the mean of 1 and 3 would be the colour of 2
  RenderOptions options = from_above();
  options.by = "cad_face";
  const Picture picture = render(soup, options, context).picture;
  const double light = distance(picture.at(60, 50), {0, 0, 0}) / category_color(3).norm();
  int others = 0;
  for (int x = 20; x < 100; ++x) {
    const Color& c = picture.at(x, 50);
    if (std::min(distance(c, category_color(1) * light), distance(c, category_color(3) * light)) > 0.05) ++others;
  }
  CHECK(others <= 2);  // the pixels on the two borders between the colours
  CHECK(distance(picture.at(60, 50), category_color(3) * light) < 0.05);
  CHECK(distance(picture.at(18, 50), category_color(1) * light) < 0.05);
}

TEST_CASE("render: positive deviation is red, negative blue") {
  Context context;
  Soup soup = square_soup();
  RenderOptions options = from_above();
  options.by = "deviation";
  options.range = 0.1;
  soup.vertex_scalars["deviation"].assign(5, 0.1);
  const Rendering red = render(soup, options, context);
  CHECK(red.palette == Palette::sequential);  // of one sign
  options.palette = Palette::diverging;
  const Color plus = render(soup, options, context).picture.at(60, 50);
  soup.vertex_scalars["deviation"].assign(5, -0.1);
  const Color minus = render(soup, options, context).picture.at(60, 50);
  CHECK(plus[0] > plus[2] + 60);
  CHECK(minus[2] > minus[0] + 60);
}

TEST_CASE("render: vertex colours are shown when the file has them") {
  Context context;
  Soup soup = square_soup();
  soup.vertex_colors.assign(5, {0, 200, 0});
  const Rendering r = render(soup, from_above(), context);
  CHECK(r.palette == Palette::colors);
  CHECK(r.picture.at(60, 50)[1] > 100);
  CHECK(r.picture.at(60, 50)[0] < 60);
}

TEST_CASE("render: edges are dark, rims red, also where triangles share no vertex index") {
  Context context;
  Soup soup;  // the square again, with three vertices of its own for every triangle, as STL brings them
  const Soup shared = square_soup();
  for (const Triangle& t : shared.triangles) {
    const auto n = static_cast<std::uint32_t>(soup.points.size());
    for (const std::uint32_t v : t) soup.points.push_back(shared.points[v]);
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  RenderOptions options = from_above();
  options.edges = true;
  const Picture picture = render(soup, options, context).picture;
  const Color inside = picture.at(60, 30), middle = picture.at(60, 50), rim = picture.at(60, 95);
  CHECK(middle[2] + 60 < inside[2]);
  CHECK(rim[0] > 150);
  CHECK(rim[2] < 90);
}

TEST_CASE("render: a cloud without triangles is drawn as dots") {
  Context context;
  Soup soup = square_soup();
  soup.triangles.clear();
  const Rendering r = render(soup, from_above(), context);
  CHECK(r.picture.at(60, 50) != white);
  CHECK(r.picture.at(60, 30) == white);
  CHECK(r.covered > 0);
  CHECK(r.covered < 0.01);
}

TEST_CASE("render: gives the same picture on any number of threads") {
  const Soup soup = sphere(40);
  RenderOptions options;
  options.width = 300;
  options.height = 200;
  options.edges = options.smooth = options.perspective = true;
  Context one, many;
  one.threads = 1;
  CHECK(render(soup, options, one).picture.pixels == render(soup, options, many).picture.pixels);
}

TEST_CASE("render: refuses what cannot be drawn, and names the reason") {
  Context context;
  RenderOptions options = from_above();
  CHECK_THROWS_WITH_AS(render(Soup{}, options, context), "there is nothing to draw", InvalidInput);
  options.by = "deviaton";
  Soup soup = square_soup();
  soup.vertex_scalars["deviation"] = {0, 0, 0, 0, 0};
  CHECK_THROWS_WITH_AS(render(soup, options, context), "no scalar is named \"deviaton\"; there are deviation",
                       InvalidInput);
  options.by = "";
  options.view = {0, 0, 0};
  CHECK_THROWS_AS(render(soup, options, context), InvalidInput);
  options.view = {0, 0, 1};
  options.width = 0;
  CHECK_THROWS_AS(render(soup, options, context), InvalidInput);
  options.width = 10;
  options.zoom = -1;
  CHECK_THROWS_AS(render(soup, options, context), InvalidInput);
  options.zoom = 1;
  soup.points[2][1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(render(soup, options, context), InvalidInput);
}

TEST_CASE("render: draws what has no extent without failing") {
  Context context;
  Soup soup;
  soup.points = {{1e6, 2, 3}, {1e6, 2, 3}, {1e6, 2, 3}};
  soup.triangles = {{0, 1, 2}};
  CHECK(render(soup, from_above(), context).covered == 0);
  soup.triangles.clear();
  CHECK(render(soup, from_above(), context).covered > 0);
}

TEST_CASE("render: stops when cancelled") {
  Context context;
  context.cancel();
  CHECK_THROWS_AS(render(square_soup(), RenderOptions{}, context), Cancelled);
}

TEST_CASE("encode_png: libpng reads back every pixel") {
  Picture picture;
  picture.width = 37;
  picture.height = 23;
  for (int i = 0; i < 37 * 23; ++i)
    picture.pixels.push_back({std::uint8_t(i % 251), std::uint8_t(i % 7 * 36), std::uint8_t(i / 4)});
  const std::string bytes = encode_png(picture);
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) != 0);
  image.format = PNG_FORMAT_RGB;
  REQUIRE(image.width == 37);
  REQUIRE(image.height == 23);
  std::vector<Color> read(37 * 23);
  REQUIRE(png_image_finish_read(&image, nullptr, read.data(), 0, nullptr) != 0);
  CHECK(read == picture.pixels);
}

TEST_CASE("encode_png: refuses a picture whose size is not that of its pixels") {
  Picture picture;
  CHECK_THROWS_AS(encode_png(picture), InvalidInput);
  picture.width = picture.height = 3;
  CHECK_THROWS_AS(encode_png(picture), InvalidInput);
}
