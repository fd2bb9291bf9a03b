#include "meshops/crossings/arrangement/solid_boundary.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "meshops/crossings/arrangement/edge_rings.hpp"
#include "meshops/limits.hpp"
#include "meshops/pace.hpp"

namespace tri {
namespace {

/// One sheet at an edge: a triangle of the result and which of its corners the edge starts and ends at.
struct Sheet {
  std::uint32_t triangle;
  std::uint8_t low, high;  ///< corners at the edge's lower and higher vertex
  bool inside_after;       ///< what follows counter-clockwise
};

class Builder {
 public:
  Builder(const CrossingComplex& complex, const CellLabels& labels, const SolidBoundaryOptions& options,
          const Context& context)
      : c_(complex), labels_(labels), options_(options), pace_(context) {}

  SolidBoundary run(Context& context) {
    choose();
    context.checkpoint();
    const EdgeRings rings = edge_rings(c_, context);
    join(rings);
    context.checkpoint();
    number();
    halve_double_edges();
    return std::move(out_);
  }

 private:
  /// The triangles of the result: each face once where in and out meet, else twice or not at all.
  void choose() {
    at_front_.assign(c_.faces.size(), no_index);
    at_back_.assign(c_.faces.size(), no_index);
    for (std::uint32_t f = 0; f < c_.faces.size(); ++f) {
      pace_();
      const bool front = labels_.inside[f][0] != 0, back = labels_.inside[f][1] != 0;
      if (front != back) {
        at_front_[f] = at_back_[f] = add(f, front, 0);
      } else if (!options_.keep_walls.empty() && options_.keep_walls[f]) {
        // Outside, the sheet at the front looks out to the front; inside, it looks back into the gap.
        at_front_[f] = add(f, front, front ? -1 : 1);
        at_back_[f] = add(f, !back, back ? -1 : 1);
        ++out_.doubled;
      } else {
        ++out_.dropped_walls;
      }
    }
  }

  std::uint32_t add(std::uint32_t face, bool reversed, signed char sheet) {
    Triangle v = c_.faces[face].v;
    if (reversed) std::swap(v[1], v[2]);
    out_.triangles.push_back(v);
    out_.face.push_back(face);
    out_.sheet.push_back(sheet);
    return static_cast<std::uint32_t>(out_.triangles.size()) - 1;
  }

  Sheet sheet_at(std::uint32_t triangle, std::uint32_t low, std::uint32_t high, bool inside_after) const {
    Sheet s{triangle, 0, 0, inside_after};
    for (std::uint8_t k = 0; k < 3; ++k) {
      if (out_.triangles[triangle][k] == low) s.low = k;
      if (out_.triangles[triangle][k] == high) s.high = k;
    }
    return s;
  }

  std::vector<Sheet> sheets_at(const EdgeRings& rings, std::size_t edge) const {
    std::vector<Sheet> sheets;
    for (std::uint32_t i = rings.first[edge]; i < rings.first[edge + 1]; ++i) {
      const EdgeRings::Wing& w = rings.wings[i];
      if (at_front_[w.face] == no_index) continue;
      const Triangle& v = c_.faces[w.face].v;
      std::uint32_t low = v[w.side], high = v[(w.side + 1) % 3];
      if (!w.forward) std::swap(low, high);
      const bool front = labels_.inside[w.face][0] != 0, back = labels_.inside[w.face][1] != 0;
      const bool after = w.forward ? front : back;
      if (at_front_[w.face] == at_back_[w.face]) {
        sheets.push_back(sheet_at(at_front_[w.face], low, high, after));
      } else {
        // The first sheet met counter-clockwise lies on the clockwise side; between the two is what is not around them.
        const std::uint32_t first = w.forward ? at_back_[w.face] : at_front_[w.face];
        const std::uint32_t second = w.forward ? at_front_[w.face] : at_back_[w.face];
        sheets.push_back(sheet_at(first, low, high, !after));
        sheets.push_back(sheet_at(second, low, high, after));
      }
    }
    return sheets;
  }

  std::uint32_t find(std::uint32_t a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

  /// Joins the sheets around each edge in pairs. Outside sheets are joined over what lies outside, so that they hang
  /// together; walls in the solid over what lies inside; where there is neither, solids that touch come apart.
  void join(const EdgeRings& rings) {
    parent_.resize(3 * out_.triangles.size());
    std::iota(parent_.begin(), parent_.end(), 0);
    for (std::size_t e = 0; e < rings.edges(); ++e) {
      pace_();
      const std::vector<Sheet> sheets = sheets_at(rings, e);
      if (sheets.empty()) continue;
      bool over_inside = true;
      for (const Sheet& s : sheets)
        if (out_.sheet[s.triangle] > 0) over_inside = false;
      std::vector<std::array<Sheet, 2>> pairs;
      for (std::size_t i = 0; i < sheets.size(); ++i)
        if (sheets[i].inside_after == over_inside) pairs.push_back({sheets[i], sheets[(i + 1) % sheets.size()]});
      for (const auto& [a, b] : pairs) {
        unite(3 * a.triangle + a.low, 3 * b.triangle + b.low);
        unite(3 * a.triangle + a.high, 3 * b.triangle + b.high);
      }
      if (pairs.size() > 1) crowded_.push_back({static_cast<std::uint32_t>(e), std::move(pairs)});
    }
  }

  /// One vertex for each fan; the first keeps the number of the point.
  void number() {
    const auto points = static_cast<std::uint32_t>(c_.points.size());
    for (std::uint32_t p = 0; p < points; ++p) pace_(), out_.vertices.push_back({p, c_.points[p]});
    std::vector<std::uint32_t> first(points, no_index), name(parent_.size(), no_index);
    for (std::uint32_t corner = 0; corner < parent_.size(); ++corner) {
      pace_();
      const std::uint32_t root = find(corner), point = out_.triangles[corner / 3][corner % 3];
      if (name[root] == no_index) {
        if (first[point] == no_index) {
          first[point] = root;
          name[root] = point;
        } else {
          name[root] = static_cast<std::uint32_t>(out_.vertices.size());
          out_.vertices.push_back({point, c_.points[point]});
        }
      }
    }
    for (std::uint32_t corner = 0; corner < parent_.size(); ++corner, pace_())
      out_.triangles[corner / 3][corner % 3] = name[find(corner)];
  }

  /// Two pairs of sheets at one edge whose ends are the same vertices need an edge each: every pair gets a vertex of
  /// its own in the middle.
  void halve_double_edges() {
    Middles middles;
    for (const auto& [edge, pairs] : crowded_) {
      std::vector<std::array<std::uint32_t, 2>> ends;
      for (const auto& [a, b] : pairs)
        ends.push_back({out_.triangles[a.triangle][a.low], out_.triangles[a.triangle][a.high]});
      std::sort(ends.begin(), ends.end());
      if (std::adjacent_find(ends.begin(), ends.end()) == ends.end()) continue;
      ++out_.edges_halved;
      for (const auto& pair : pairs) {
        const std::uint32_t middle = add_middle(pair[0].triangle, pair[0].low, pair[0].high);
        for (const Sheet& s : pair) at(middles, s.triangle)[(s.low + 1) % 3 == s.high ? s.low : s.high] = middle;
      }
    }
    if (middles.empty()) return;
    parent_.resize(out_.triangles.size());
    std::iota(parent_.begin(), parent_.end(), 0);
    const auto first_middle = static_cast<std::uint32_t>(out_.vertices.size() - count_middles_);
    for (const auto& [triangle, sides] : middles) cut_at(triangle, sides);
    // Two sheets with a middle in common were cut along the same edge: once more, each for itself.
    std::map<std::array<std::uint32_t, 2>, std::vector<std::array<std::uint32_t, 2>>> sides;  // triangle, side
    for (std::uint32_t t = 0; t < out_.triangles.size(); ++t, pace_())
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t a = out_.triangles[t][k], b = out_.triangles[t][(k + 1) % 3];
        if (std::max(a, b) >= first_middle) sides[{std::min(a, b), std::max(a, b)}].push_back({t, k});
      }
    middles.clear();
    for (auto& [edge, list] : sides) {
      if (list.size() <= 2) continue;
      std::stable_sort(list.begin(), list.end(),
                       [&](const auto& a, const auto& b) { return parent_[a[0]] < parent_[b[0]]; });
      for (std::size_t i = 0; i + 1 < list.size(); ++i) {
        if (parent_[list[i][0]] != parent_[list[i + 1][0]]) continue;
        const std::uint32_t middle = add_middle(list[i][0], list[i][1], (list[i][1] + 1) % 3);
        for (const std::size_t j : {i, i + 1}) at(middles, list[j][0])[list[j][1]] = middle;
        ++i;
      }
    }
    for (const auto& [triangle, of] : middles) cut_at(triangle, of);
  }

  using Middles = std::map<std::uint32_t, std::array<std::uint32_t, 3>>;  ///< of triangles: at each side

  static std::array<std::uint32_t, 3>& at(Middles& middles, std::uint32_t triangle) {
    return middles.try_emplace(triangle, std::array<std::uint32_t, 3>{no_index, no_index, no_index}).first->second;
  }

  /// A vertex in the middle between two corners of a triangle.
  std::uint32_t add_middle(std::uint32_t triangle, std::size_t from, std::size_t to) {
    const GridPoint &a = out_.vertices[out_.triangles[triangle][from]].place,
                    &b = out_.vertices[out_.triangles[triangle][to]].place;
    GridPoint middle;
    for (int k = 0; k < 3; ++k) middle[k] = (a[k] + b[k]) / 2;
    out_.vertices.push_back({no_index, middle});
    ++count_middles_;
    return static_cast<std::uint32_t>(out_.vertices.size()) - 1;
  }

  void cut_at(std::uint32_t triangle, const std::array<std::uint32_t, 3>& at) {
    std::vector<std::uint32_t> ring;
    const Triangle v = out_.triangles[triangle];
    int count = 0, lone = 0;
    for (int k = 0; k < 3; ++k) {
      ring.push_back(v[k]);
      if (at[k] != no_index) ring.push_back(at[k]), ++count, lone = k;
    }
    const auto put = [&](bool first, const Triangle& t) {
      if (first) {
        out_.triangles[triangle] = t;
        return;
      }
      out_.triangles.push_back(t);
      out_.face.push_back(out_.face[triangle]);
      out_.sheet.push_back(out_.sheet[triangle]);
      parent_.push_back(parent_[triangle]);
    };
    if (count == 1) {
      put(true, {v[lone], at[lone], v[(lone + 2) % 3]});
      put(false, {at[lone], v[(lone + 1) % 3], v[(lone + 2) % 3]});
    } else if (count == 2) {
      int k = 0;  // the side without
      while (at[k] != no_index) ++k;
      const std::uint32_t a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3], bc = at[(k + 1) % 3], ca = at[(k + 2) % 3];
      // The same diagonal in both of two sheets, which run opposite ways.
      if (out_.vertices[a].place < out_.vertices[b].place) {
        put(true, {a, b, bc});
        put(false, {a, bc, ca});
      } else {
        put(true, {a, b, ca});
        put(false, {b, bc, ca});
      }
      put(false, {ca, bc, c});
    } else {
      put(true, {at[0], at[1], at[2]});
      for (int k = 0; k < 3; ++k) put(false, {v[k], at[k], at[(k + 2) % 3]});
    }
  }

  const CrossingComplex& c_;
  const CellLabels& labels_;
  const SolidBoundaryOptions& options_;
  Pace pace_;
  SolidBoundary out_;
  std::vector<std::uint32_t> at_front_, at_back_;  ///< of faces: the triangle that is met from there
  std::vector<std::uint32_t> parent_;  ///< of corners: towards the root of their fan; later of triangles: what they
                                       ///< were cut from
  std::size_t count_middles_ = 0;
  struct Crowded {
    std::uint32_t edge;
    std::vector<std::array<Sheet, 2>> pairs;
  };
  std::vector<Crowded> crowded_;
};

}  // namespace

SolidBoundary solid_boundary(const CrossingComplex& complex, const CellLabels& labels,
                             const SolidBoundaryOptions& options, Context& context) {
  return Builder(complex, labels, options, context).run(context);
}

}  // namespace tri
