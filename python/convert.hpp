#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "meshops/soup.hpp"
#include "meshops/vec.hpp"

namespace tri::python {

namespace py = pybind11;
using Json = nlohmann::ordered_json;

/// Dicts, lists, numbers, strings and None, both ways. The order of keys is kept; infinity is the float inf in Python
/// and the text "inf" in JSON. @throws py::type_error for anything else
py::object to_python(const Json& json);
Json to_json(const py::handle& object);

/// Rows of three numbers, copied. @param what  names the array in messages
/// @throws InvalidInput unless the shape is (n, 3)
std::vector<Vec3> to_points(const py::handle& array, const char* what);
/// Rows of three whole numbers, copied. @throws InvalidInput unless the shape is (m, 3) and every index is in [0,
/// points)
std::vector<Triangle> to_triangles(const py::handle& array, std::size_t points);
/// One number a row. @throws InvalidInput unless the shape is (n,)
std::vector<double> to_numbers(const py::handle& array, const char* what);
/// A row-major 4x4 matrix. @throws InvalidInput for another shape
std::array<std::array<double, 4>, 4> to_matrix(const py::handle& array);

/// An array over memory that `owner` keeps; writable, without a copy. `columns` numbers of type T a row; 0 for shape
/// (n,).
template <class T>
py::array_t<T> view_of_rows(const std::shared_ptr<const void>& owner, const void* data, std::size_t rows,
                            std::size_t columns) {
  auto* kept = new std::shared_ptr<const void>(owner);
  const py::capsule base(kept, [](void* p) { delete static_cast<std::shared_ptr<const void>*>(p); });
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(rows)};
  if (columns > 0) shape.push_back(static_cast<py::ssize_t>(columns));
  return py::array_t<T>(shape, static_cast<const T*>(data), base);
}

/// A copy, for what the library does not hold as rows of numbers.
template <class T>
py::array_t<T> copy_of_rows(std::span<const T> values, std::size_t columns) {
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(columns > 0 ? values.size() / columns : values.size())};
  if (columns > 0) shape.push_back(static_cast<py::ssize_t>(columns));
  return py::array_t<T>(shape, values.data());
}
py::array_t<double> copy_of_points(std::span<const Vec3> points);

}  // namespace tri::python
