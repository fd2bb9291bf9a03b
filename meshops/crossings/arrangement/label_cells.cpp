#include <algorithm>
#include <numeric>

#include "meshops/crossings/arrangement/edge_rings.hpp"
#include "meshops/crossings/arrangement/solid_boundary.hpp"
#include "meshops/pace.hpp"

namespace tri {
namespace {

class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::uint32_t find(std::uint32_t a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

CellLabels label_cells(const CrossingComplex& complex, std::span<const char> cavity, Context& context) {
  const std::size_t n = complex.faces.size();
  Pace pace(context);
  const EdgeRings rings = edge_rings(complex, context);
  context.checkpoint();
  // Side 2 f is the front of face f, 2 f + 1 its back; sides that look into the same wedge at an edge belong to one
  // cell.
  Sets shells(2 * n), parts(n);
  for (std::size_t e = 0; e < rings.edges(); ++e) {
    pace();
    const std::uint32_t begin = rings.first[e], end = rings.first[e + 1];
    for (std::uint32_t i = begin; i < end; ++i) {
      const EdgeRings::Wing &a = rings.wings[i], &b = rings.wings[i + 1 < end ? i + 1 : begin];
      shells.join(2 * a.face + (a.forward ? 0 : 1), 2 * b.face + (b.forward ? 1 : 0));
      parts.join(a.face, b.face);
    }
  }
  CellLabels labels;
  labels.part.resize(n);
  labels.inside.resize(n);
  // Six times the volume that a cell's rim encloses: above 0 for a bounded cell, the opposite sum for the outer one.
  std::vector<double> volume(2 * n, 0), whole(n, 0);
  std::vector<char> may_be_cavity(n, 0);
  for (std::uint32_t f = 0; f < n; ++f) {
    pace();
    const std::uint32_t part = labels.part[f] = parts.find(f);
    const Triangle &v = complex.faces[f].v, &o = complex.faces[part].v;
    const double v6 = static_cast<double>(
        volume6(complex.points[o[0]], complex.points[v[0]], complex.points[v[1]], complex.points[v[2]]));
    volume[shells.find(2 * f)] -= v6;
    volume[shells.find(2 * f + 1)] += v6;
    whole[part] += v6 * complex.faces[f].net;
    may_be_cavity[part] |= cavity[complex.faces[f].source];
  }
  std::vector<std::uint32_t> outer(n, 0xffffffffu);
  for (std::uint32_t s = 0; s < 2 * n; ++s) {
    pace();
    if (shells.find(s) != s) continue;
    std::uint32_t& best = outer[labels.part[s / 2]];
    if (best == 0xffffffffu || volume[s] < volume[best]) best = s;
  }
  // Winding numbers from the outer shell inwards, over the faces between shells.
  std::vector<std::vector<std::uint32_t>> faces_of(2 * n);
  for (std::uint32_t f = 0; f < n; ++f) {
    pace();
    const std::uint32_t front = shells.find(2 * f), back = shells.find(2 * f + 1);
    if (front == back) continue;
    faces_of[front].push_back(f);
    faces_of[back].push_back(f);
  }
  std::vector<std::int64_t> winding(2 * n, 0);
  std::vector<char> known(2 * n, 0);
  std::vector<std::uint32_t> queue;
  for (std::uint32_t f = 0; f < n; ++f) {
    if (labels.part[f] != f) continue;
    queue.assign(1, outer[f]);
    known[outer[f]] = 1;
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const std::uint32_t s = queue[i];
      for (const std::uint32_t g : faces_of[s]) {
        pace();
        const std::uint32_t front = shells.find(2 * g), back = shells.find(2 * g + 1);
        const std::uint32_t other = front == s ? back : front;
        if (known[other]) continue;
        known[other] = 1;
        winding[other] = other == back ? winding[s] + complex.faces[g].net : winding[s] - complex.faces[g].net;
        queue.push_back(other);
      }
    }
  }
  for (std::uint32_t f = 0; f < n; ++f) {
    pace();
    const bool hollow = may_be_cavity[labels.part[f]] && whole[labels.part[f]] < 0;
    for (std::uint32_t k = 0; k < 2; ++k)
      labels.inside[f][k] = static_cast<char>((winding[shells.find(2 * f + k)] != 0) != hollow);
  }
  return labels;
}

}  // namespace tri
