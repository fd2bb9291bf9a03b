#include "io/pictures/render.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "io/pictures/palette.hpp"
#include "io/pictures/rasterizer.hpp"
#include "meshops/error.hpp"

namespace tri {
namespace {

constexpr int supersampling = 2;  // samples a pixel, in each direction
constexpr int tile = 64 * supersampling;
constexpr double dot_radius = 1.4 * supersampling;
constexpr double edge_half_width = 0.5 * supersampling;
constexpr double rim_width = 1.6 * supersampling;
const double smooth_cosine = std::cos(0.6);  // corners whose normal turns by more than 0.6 rad from the triangle's stay
                                             // sharp

const Vec3 front_color(0.66, 0.73, 0.81);
const Vec3 back_color(0.72, 0.50, 0.33);
const Vec3 edge_color(0.10, 0.12, 0.16);
const Vec3 rim_color(0.85, 0.08, 0.12);

template <class Body>
void for_each_index(std::size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
  });
}

void check_options(const RenderOptions& options) {
  const auto in_range = [](const char* name, double value, double low, double high) {
    if (!(value >= low && value <= high))
      throw InvalidInput(std::string(name) + " is " + std::to_string(value) + "; allowed are " + std::to_string(low) +
                         " to " + std::to_string(high));
  };
  in_range("width", options.width, 1, 8192);
  in_range("height", options.height, 1, 8192);
  in_range("zoom", options.zoom, 1e-3, 1e6);
  if (options.range && !(*options.range > 0 && std::isfinite(*options.range)))
    throw InvalidInput("range is " + std::to_string(*options.range) + "; it must be above 0");
}

// The scalar that gives the colours, and how.
class Coloring {
 public:
  Coloring(const Soup& soup, const RenderOptions& options) : soup_(soup) {
    if (options.by.empty() && !soup.vertex_colors.empty()) palette_ = Palette::colors;
    if (options.by.empty() || options.by == "none") return;
    const auto vertex = soup.vertex_scalars.find(options.by);
    const auto face = soup.face_scalars.find(options.by);
    if (vertex != soup.vertex_scalars.end()) {
      values_ = &vertex->second;
      per_vertex_ = true;
    } else if (face != soup.face_scalars.end()) {
      values_ = &face->second;
    } else {
      throw InvalidInput("no scalar is named \"" + options.by + "\"; " + names(soup));
    }
    zero_is_missing_ = options.by == "cad_face";
    choose_palette(options);
  }

  Vec3 at(const Sample& sample, bool is_triangle) const {
    if (palette_ == Palette::plain) return front_color;
    if (!is_triangle)
      return palette_ == Palette::colors ? color_of_vertex(sample.id)
             : per_vertex_               ? color_of((*values_)[sample.id])
                                         : front_color;
    const Triangle& corners = soup_.triangles[sample.id];
    const double* b = sample.barycentric;
    if (palette_ == Palette::colors)
      return color_of_vertex(corners[0]) * b[0] + color_of_vertex(corners[1]) * b[1] +
             color_of_vertex(corners[2]) * b[2];
    if (!per_vertex_) return color_of((*values_)[sample.id]);
    if (palette_ == Palette::categories) {
      // Numbers of categories have no mean: the nearest corner decides.
      const auto nearest = static_cast<std::size_t>(std::max_element(b, b + 3) - b);
      return color_of((*values_)[corners[nearest]]);
    }
    return color_of(b[0] * (*values_)[corners[0]] + b[1] * (*values_)[corners[1]] + b[2] * (*values_)[corners[2]]);
  }

  void describe(Rendering& result) const {
    result.palette = palette_;
    result.low = low_;
    result.high = high_;
    result.categories = categories_;
  }

 private:
  static std::string names(const Soup& soup) {
    std::string list;
    for (const auto* scalars : {&soup.vertex_scalars, &soup.face_scalars})
      for (const auto& [name, values] : *scalars) list += (list.empty() ? "" : ", ") + name;
    return list.empty() ? "the mesh has none" : "there are " + list;
  }

  void choose_palette(const RenderOptions& options) {
    std::vector<double> finite;
    std::copy_if(values_->begin(), values_->end(), std::back_inserter(finite),
                 [](double v) { return std::isfinite(v); });
    tbb::parallel_sort(finite.begin(), finite.end());
    const bool whole =
        std::all_of(finite.begin(), finite.end(), [](double v) { return v == std::floor(v) && std::abs(v) < 1e15; });
    const bool both_signs = !finite.empty() && finite.front() < 0 && finite.back() > 0;
    palette_ = options.palette.value_or(whole        ? Palette::categories
                                        : both_signs ? Palette::diverging
                                                     : Palette::sequential);
    if (palette_ == Palette::plain || palette_ == Palette::colors)
      throw InvalidInput(std::string("the palette \"") + name_of(palette_) + "\" does not show a scalar");
    if (palette_ == Palette::categories) {
      categories_ = static_cast<std::size_t>(std::unique(finite.begin(), finite.end()) - finite.begin());
      return;
    }
    const auto quantile = [](const std::vector<double>& sorted, double share) {
      return sorted.empty() ? 0.0 : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
    };
    if (palette_ == Palette::diverging) {
      if (options.range) {
        high_ = *options.range;
      } else {
        for (double& v : finite) v = std::abs(v);
        tbb::parallel_sort(finite.begin(), finite.end());
        high_ = quantile(finite, 0.98);
      }
      low_ = -high_;
    } else {
      low_ = options.range ? 0 : quantile(finite, 0.02);
      high_ = options.range ? *options.range : quantile(finite, 0.98);
    }
  }

  Vec3 color_of_vertex(std::uint32_t v) const {
    const Color& c = soup_.vertex_colors[v];
    return Vec3(c[0], c[1], c[2]) / 255.0;
  }

  Vec3 color_of(double value) const {
    if (std::isnan(value)) return missing_color();
    if (palette_ == Palette::categories) {
      if (value < 0 || (value == 0 && zero_is_missing_) || !(value < 1e15)) return missing_color();
      return category_color(static_cast<std::int64_t>(value));
    }
    const double length = high_ - low_;
    if (palette_ == Palette::diverging) return diverging_color(length > 0 ? value / high_ : 0);
    return sequential_color(length > 0 ? (value - low_) / length : 0.5);
  }

  const Soup& soup_;
  const std::vector<double>* values_ = nullptr;
  bool per_vertex_ = false;
  bool zero_is_missing_ = false;
  Palette palette_ = Palette::plain;
  double low_ = 0, high_ = 0;
  std::size_t categories_ = 0;
};

// For every vertex the first of those at the very same place, so that files without shared vertices have edges, too.
std::vector<std::uint32_t> places(const Soup& soup) {
  std::vector<std::uint32_t> order(soup.points.size()), place(soup.points.size());
  std::iota(order.begin(), order.end(), 0u);
  tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 &p = soup.points[a], &q = soup.points[b];
    for (int k = 0; k < 3; ++k)
      if (p[k] != q[k]) return p[k] < q[k];
    return a < b;
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && soup.points[order[i]] == soup.points[order[i - 1]];
    place[order[i]] = same ? place[order[i - 1]] : order[i];
  }
  return place;
}

// Bit k of an entry: the edge from corner k to the next belongs to no other triangle.
std::vector<std::uint8_t> find_rims(const Soup& soup, const std::vector<std::uint32_t>& place) {
  struct Edge {
    std::uint64_t key;
    std::uint32_t triangle;
    std::uint8_t corner;
  };
  std::vector<Edge> edges(soup.triangles.size() * 3);
  for_each_index(soup.triangles.size(), [&](std::size_t t) {
    for (std::uint8_t k = 0; k < 3; ++k) {
      std::uint64_t a = place[soup.triangles[t][k]], b = place[soup.triangles[t][(k + 1) % 3]];
      if (a > b) std::swap(a, b);
      edges[3 * t + k] = {a << 32 | b, static_cast<std::uint32_t>(t), k};
    }
  });
  tbb::parallel_sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.key < b.key; });
  std::vector<std::uint8_t> rims(soup.triangles.size(), 0);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool alone =
        (i == 0 || edges[i - 1].key != edges[i].key) && (i + 1 == edges.size() || edges[i + 1].key != edges[i].key);
    if (alone) rims[edges[i].triangle] |= static_cast<std::uint8_t>(1u << edges[i].corner);
  }
  return rims;
}

std::vector<Vec3> smooth_normals(const Soup& soup, const std::vector<std::uint32_t>& place) {
  std::vector<Vec3> normals(soup.points.size(), Vec3(0, 0, 0));
  for (const Triangle& t : soup.triangles) {
    const Vec3 n = (soup.points[t[1]] - soup.points[t[0]]) % (soup.points[t[2]] - soup.points[t[0]]);
    for (const std::uint32_t v : t) normals[place[v]] += n;
  }
  for_each_index(normals.size(), [&](std::size_t v) {
    const double length = normals[v].norm();
    if (length > 0) normals[v] /= length;
  });
  return normals;
}

// Colours one sample from what the rasterizer found there.
class Shader {
 public:
  Shader(const Soup& soup, const RenderOptions& options, const Camera& camera, const Coloring& coloring,
         const std::vector<ScreenPoint>& screen)
      : soup_(soup), camera_(camera), coloring_(coloring), screen_(screen),
        edges_(options.edges && !soup.triangles.empty()), smooth_(options.smooth && !soup.triangles.empty()) {
    if (edges_ || smooth_) place_ = places(soup);
    if (edges_) rims_ = find_rims(soup, place_);
    if (smooth_) normals_ = smooth_normals(soup, place_);
  }

  bool is_back(std::uint32_t triangle) const { return signed_area(triangle) > 0; }

  Vec3 color(const Sample& sample) const {
    if (soup_.triangles.empty()) return coloring_.at(sample, false) * 0.85;
    const bool back = is_back(sample.id);
    Vec3 color = coloring_.at(sample, true);
    if (back) color = color == front_color ? back_color : color * 0.35 + back_color * 0.5;
    const Vec3 eye = camera_.toward_camera(soup_.points[soup_.triangles[sample.id][0]]);
    const Vec3 light = (eye + camera_.upward() * 0.25 - camera_.right() * 0.2).normalized();
    Vec3 normal = normal_at(sample);
    if (back) normal = -normal;
    const double facing = std::max(0.0, normal | light);
    const double glance = std::pow(std::max(0.0, normal | (light + eye).normalized()), 40.0);
    color = color * (0.30 + 0.75 * facing) + Vec3(1, 1, 1) * (0.10 * glance);
    return edges_ ? with_edges(color, sample) : color;
  }

 private:
  // Twice the area on the screen, whose y runs downward: positive for backs.
  double signed_area(std::uint32_t triangle) const {
    const Triangle& t = soup_.triangles[triangle];
    const ScreenPoint &a = screen_[t[0]], &b = screen_[t[1]], &c = screen_[t[2]];
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }

  Vec3 normal_at(const Sample& sample) const {
    const Triangle& t = soup_.triangles[sample.id];
    Vec3 flat = (soup_.points[t[1]] - soup_.points[t[0]]) % (soup_.points[t[2]] - soup_.points[t[0]]);
    const double length = flat.norm();
    if (!(length > 0)) return camera_.toward_camera(soup_.points[t[0]]);
    flat /= length;
    if (!smooth_) return flat;
    Vec3 sum(0, 0, 0);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& corner = normals_[place_[t[k]]];
      sum += ((corner | flat) < smooth_cosine ? flat : corner) * sample.barycentric[k];
    }
    return sum.norm() > 0 ? sum.normalized() : flat;
  }

  Vec3 with_edges(Vec3 color, const Sample& sample) const {
    const Triangle& t = soup_.triangles[sample.id];
    const double area = std::abs(signed_area(sample.id));
    double nearest = edge_half_width, longest = 0;
    bool rim = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const ScreenPoint &a = screen_[t[k]], &b = screen_[t[(k + 1) % 3]];
      const double dx = b.x - a.x, dy = b.y - a.y, length = std::hypot(dx, dy);
      longest = std::max(longest, length);
      if (length == 0) continue;
      const double distance = std::abs(dx * (sample.y - a.y) - dy * (sample.x - a.x)) / length;
      nearest = std::min(nearest, distance);
      if ((rims_[sample.id] >> k & 1) && distance < rim_width) rim = true;
    }
    if (rim) return rim_color;
    if (nearest >= edge_half_width) return color;
    // Triangles of few pixels would drown in their edges.
    const double opacity = 0.8 * std::min(1.0, longest > 0 ? area / longest / (6.0 * supersampling) : 0.0);
    return color * (1 - opacity) + edge_color * opacity;
  }

  const Soup& soup_;
  const Camera& camera_;
  const Coloring& coloring_;
  const std::vector<ScreenPoint>& screen_;
  bool edges_, smooth_;
  std::vector<std::uint32_t> place_;
  std::vector<std::uint8_t> rims_;
  std::vector<Vec3> normals_;
};

std::vector<std::uint32_t> drawn_vertices(const Soup& soup) {
  std::vector<std::uint32_t> drawn;
  if (soup.triangles.empty()) {
    drawn.resize(soup.points.size());
    std::iota(drawn.begin(), drawn.end(), 0u);
    return drawn;
  }
  std::vector<bool> used(soup.points.size(), false);
  for (const Triangle& t : soup.triangles)
    for (const std::uint32_t v : t) used[v] = true;
  for (std::uint32_t v = 0; v < used.size(); ++v)
    if (used[v]) drawn.push_back(v);
  return drawn;
}

Rendering draw(const Soup& soup, const RenderOptions& options, Context& context) {
  for (std::size_t i = 0; i < soup.points.size(); ++i)
    if (!std::isfinite(soup.points[i].norm()))
      throw InvalidInput("vertex " + std::to_string(i) + " has a coordinate that is not finite or too large to draw");
  const int width = options.width * supersampling, height = options.height * supersampling;
  const Coloring coloring(soup, options);
  const Camera camera({width, height, options.view, options.up, options.perspective, options.zoom, options.center},
                      soup.points, drawn_vertices(soup));
  std::vector<ScreenPoint> screen(soup.points.size());
  for_each_index(screen.size(), [&](std::size_t i) { screen[i] = camera.project(soup.points[i]); });
  const Shader shader(soup, options, camera, coloring, screen);

  Rendering result;
  coloring.describe(result);
  result.picture.width = options.width;
  result.picture.height = options.height;
  const std::size_t pixels = std::size_t(options.width) * std::size_t(options.height);
  // Sums of the samples of each pixel; a pixel lies in one tile, so no two threads write to it.
  std::vector<std::array<float, 3>> sum(pixels, {0, 0, 0});
  std::vector<std::uint8_t> covered(pixels, 0), back(pixels, 0);
  rasterize(screen, soup.triangles, width, height, tile, dot_radius, context,
            [&](int column, int row, const Sample& sample) {
              const std::size_t pixel =
                  std::size_t(row / supersampling) * std::size_t(options.width) + std::size_t(column / supersampling);
              const Vec3 color = shader.color(sample);
              for (int k = 0; k < 3; ++k)
                sum[pixel][std::size_t(k)] += static_cast<float>(std::clamp(color[k], 0.0, 1.0));
              ++covered[pixel];
              if (!soup.triangles.empty() && shader.is_back(sample.id)) ++back[pixel];
            });

  constexpr int samples = supersampling * supersampling;
  result.picture.pixels.resize(pixels);
  for_each_index(pixels, [&](std::size_t i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double mean = (255.0 * sum[i][k] + double(options.background[k]) * (samples - covered[i])) / samples;
      result.picture.pixels[i][k] = static_cast<std::uint8_t>(std::lround(mean));
    }
  });
  const double shown = std::accumulate(covered.begin(), covered.end(), 0.0);
  result.covered = shown / (static_cast<double>(pixels) * samples);
  if (shown > 0) result.back = std::accumulate(back.begin(), back.end(), 0.0) / shown;
  return result;
}

}  // namespace

const char* name_of(Palette palette) {
  switch (palette) {
    case Palette::plain:
      return "plain";
    case Palette::colors:
      return "colors";
    case Palette::categories:
      return "categories";
    case Palette::diverging:
      return "diverging";
    case Palette::sequential:
      return "sequential";
  }
  return "";
}

Rendering render(const Soup& soup, const RenderOptions& options, Context& context) {
  check_options(options);
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  return arena.execute([&] { return draw(soup, options, context); });
}

}  // namespace tri
