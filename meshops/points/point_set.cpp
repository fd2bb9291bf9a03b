#include "meshops/points/point_set.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "meshops/error.hpp"

namespace tri {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

bool finite(const Vec3& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

/// Calls `function` for each column that may be absent, `points` aside.
template <class Set, class Function>
void for_each_optional(Set& set, const Function& function) {
  function("normals", set.normals);
  function("intensity", set.intensity);
  function("colors", set.colors);
  for (auto& [name, values] : set.scalars) function(name, values);
}

template <class Function>
void for_each_column(PointSet& set, const Function& function) {
  function(set.points);
  for_each_optional(set, [&](const std::string&, auto& column) {
    if (!column.empty()) function(column);
  });
}

template <class T>
void join(std::vector<T>& column, const std::vector<T>& more, std::size_t before, std::size_t after, const T& missing) {
  if (column.empty() && more.empty()) return;
  column.resize(before, missing);
  column.insert(column.end(), more.begin(), more.end());
  column.resize(after, missing);
}

}  // namespace

void validate(const PointSet& set) {
  for_each_optional(set, [&](const std::string& name, const auto& column) {
    if (!column.empty() && column.size() != set.size())
      throw InvalidInput(fmt::format("{} {} for {} points", column.size(), name, set.size()));
  });
  for (const auto& [name, values] : set.scalars)
    if (values.size() != set.size())
      throw InvalidInput(fmt::format("{} values of {} for {} points", values.size(), name, set.size()));
  for (std::size_t i = 0; i < set.size(); ++i)
    if (!finite(set.points[i]) || (!set.normals.empty() && !finite(set.normals[i])))
      throw InvalidInput(fmt::format("point {} or its normal is not finite", i));
}

std::vector<std::string> column_names(const PointSet& set) {
  std::vector<std::string> names;
  for_each_optional(set, [&](const std::string& name, const auto& column) {
    if (!column.empty()) names.push_back(name);
  });
  return names;
}

std::vector<std::string> append(PointSet& set, const PointSet& more) {
  if (&set == &more) {
    const PointSet copy = more;
    return append(set, copy);
  }
  std::vector<std::string> one_sided;
  if (more.empty()) return one_sided;
  const std::size_t before = set.size(), after = before + more.size();
  const auto note = [&](const std::string& name, std::size_t own, std::size_t other) {
    if (before > 0 && (own == 0) != (other == 0)) one_sided.push_back(name);
  };
  note("normals", set.normals.size(), more.normals.size());
  note("intensity", set.intensity.size(), more.intensity.size());
  note("colors", set.colors.size(), more.colors.size());
  for (const auto& [name, values] : set.scalars) note(name, values.size(), more.scalars.contains(name));
  for (const auto& [name, values] : more.scalars)
    if (before > 0 && !set.scalars.contains(name)) one_sided.push_back(name);

  try {
    join(set.normals, more.normals, before, after, Vec3(0, 0, 0));
    join(set.intensity, more.intensity, before, after, unknown);
    join(set.colors, more.colors, before, after, {0, 0, 0});
    for (const auto& [name, values] : more.scalars) join(set.scalars[name], values, before, after, unknown);
    static const std::vector<double> none;
    for (auto& [name, values] : set.scalars)
      if (!more.scalars.contains(name)) join(values, none, before, after, unknown);
    set.points.insert(set.points.end(), more.points.begin(), more.points.end());
  } catch (const std::bad_alloc&) {
    for_each_optional(set, [&](const std::string&, auto& column) {
      if (column.size() > before) column.resize(before);
    });
    std::erase_if(set.scalars, [](const auto& scalar) { return scalar.second.empty(); });
    throw;
  }
  return one_sided;
}

PointSet subset(const PointSet& set, std::span<const std::uint32_t> indices) {
  for (const std::uint32_t i : indices)
    if (i >= set.size()) throw InvalidInput(fmt::format("point {} of {} was asked for", i, set.size()));
  const auto gather = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(indices.size());
    for (const std::uint32_t i : indices) to.push_back(from[i]);
  };
  PointSet result;
  gather(set.points, result.points);
  gather(set.normals, result.normals);
  gather(set.intensity, result.intensity);
  gather(set.colors, result.colors);
  for (const auto& [name, values] : set.scalars) gather(values, result.scalars[name]);
  return result;
}

void keep(PointSet& set, std::span<const std::uint32_t> indices) {
  for (std::size_t k = 0; k < indices.size(); ++k)
    if (indices[k] >= set.size() || (k > 0 && indices[k] <= indices[k - 1]))
      throw InvalidInput(fmt::format("indices to keep are not ascending below {} at {}", set.size(), indices[k]));
  for_each_column(set, [&](auto& column) {
    for (std::size_t k = 0; k < indices.size(); ++k) column[k] = column[indices[k]];
    column.resize(indices.size());
    column.shrink_to_fit();
  });
}

void permute(PointSet& set, std::span<const std::uint32_t> order) {
  if (order.size() != set.size())
    throw InvalidInput(fmt::format("an order of {} for {} points", order.size(), set.size()));
  std::vector<bool> seen(order.size(), false);
  for (const std::uint32_t i : order) {
    if (i >= order.size() || seen[i]) throw InvalidInput(fmt::format("the order is no permutation: index {}", i));
    seen[i] = true;
  }
  for_each_column(set, [&](auto& column) {
    auto sorted = column;
    for (std::size_t k = 0; k < order.size(); ++k) sorted[k] = column[order[k]];
    column.swap(sorted);
  });
}

void scale(PointSet& set, double factor) {
  if (!(factor > 0 && std::isfinite(factor))) throw InvalidInput(fmt::format("scale factor {} is not above 0", factor));
  if (factor == 1) return;
  for (Vec3& p : set.points) p *= factor;
}

}  // namespace tri
