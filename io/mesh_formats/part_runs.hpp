#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "meshops/soup.hpp"

namespace tri::io_detail {

/// Consecutive triangles with the same label; -1 for none.
struct PartRun {
  std::size_t begin, end;
  double label;
};

/// The name that a label of a face scalar stands for; null for none.
inline const std::string* label_name(const Soup& soup, const std::string& scalar, double label) {
  const auto labels = soup.face_labels.find(scalar);
  if (labels == soup.face_labels.end() || !(label >= 0) || label != std::floor(label)) return nullptr;
  return label < static_cast<double>(labels->second.size()) ? &labels->second[static_cast<std::size_t>(label)]
                                                            : nullptr;
}

/// Where the labels of a face scalar change, values without a name being none; one run over all without labels.
inline std::vector<PartRun> part_runs(const Soup& soup, const std::string& scalar) {
  std::vector<PartRun> runs;
  const auto values = soup.face_scalars.find(scalar);
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    double label = values == soup.face_scalars.end() ? -1 : values->second[i];
    if (!label_name(soup, scalar, label)) label = -1;
    if (runs.empty() || runs.back().label != label) runs.push_back({i, i, label});
    runs.back().end = i + 1;
  }
  return runs;
}

/// The labels of a face scalar are runs of triangles and of vertices: each label has its own of both, side by side and
/// in the same order, as in a file that holds one part after another. Vertices in no triangle belong to the part
/// before.
/// @param[out] first_vertex of each run
inline bool separate_parts(const Soup& soup, const std::vector<PartRun>& runs, std::vector<std::size_t>& first_vertex) {
  first_vertex.assign(1, 0);
  std::size_t largest = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    for (std::size_t s = 0; s < r && runs.size() <= 1000; ++s)
      if (runs[s].label == runs[r].label) return false;
    std::size_t low = soup.points.size(), high = 0;
    for (std::size_t i = runs[r].begin; i < runs[r].end; ++i)
      for (const std::size_t v : soup.triangles[i]) low = std::min(low, v), high = std::max(high, v);
    if (r > 0 && low <= largest) return false;
    if (r > 0) first_vertex.push_back(low);
    largest = high;
  }
  return runs.size() <= 1000;
}

}  // namespace tri::io_detail
