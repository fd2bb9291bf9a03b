#include "python/convert.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "meshops/error.hpp"

namespace tri::python {
namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::uint32_t));

[[noreturn]] void wrong_shape(const char* what, const char* wanted, const py::array& array) {
  throw InvalidInput(std::string(what) + ": an array of shape " + wanted + " is needed, and this has shape " +
                     py::str(array.attr("shape")).cast<std::string>());
}

Doubles doubles(const py::handle& object, const char* what) {
  Doubles array = Doubles::ensure(object);  // clears Python's own error
  if (!array) throw InvalidInput(std::string(what) + ": not an array of numbers");
  return array;
}

}  // namespace

py::object to_python(const Json& json) {
  switch (json.type()) {
    case Json::value_t::object: {
      py::dict dict;
      for (const auto& [key, value] : json.items()) dict[py::str(key)] = to_python(value);
      return dict;
    }
    case Json::value_t::array: {
      py::list list;
      for (const Json& value : json) list.append(to_python(value));
      return list;
    }
    case Json::value_t::string:
      // File names and names in files may be no UTF-8.
      return py::reinterpret_steal<py::object>(
          PyUnicode_DecodeUTF8(json.get_ref<const std::string&>().data(),
                               static_cast<py::ssize_t>(json.get_ref<const std::string&>().size()), "replace"));
    case Json::value_t::boolean:
      return py::bool_(json.get<bool>());
    case Json::value_t::number_integer:
      return py::int_(json.get<std::int64_t>());
    case Json::value_t::number_unsigned:
      return py::int_(json.get<std::uint64_t>());
    case Json::value_t::number_float:
      return py::float_(json.get<double>());
    default:
      return py::none();
  }
}

Json to_json(const py::handle& object) {
  if (object.is_none()) return nullptr;
  if (py::isinstance<py::bool_>(object)) return object.cast<bool>();
  if (py::isinstance<py::int_>(object)) {
    int overflow = 0;
    const long long value = PyLong_AsLongLongAndOverflow(object.ptr(), &overflow);
    if (overflow != 0) throw InvalidInput("the whole number " + py::str(object).cast<std::string>() + " is too large");
    return value;
  }
  if (py::isinstance<py::str>(object)) return object.cast<std::string>();
  if (py::isinstance<py::dict>(object)) {
    Json json = Json::object();
    for (const auto& [key, value] : py::reinterpret_borrow<py::dict>(object))
      json[key.cast<std::string>()] = to_json(value);
    return json;
  }
  if (PyFloat_Check(object.ptr()) || PyNumber_Check(object.ptr())) {
    if (PyIndex_Check(object.ptr()) && !PyFloat_Check(object.ptr()))  // numpy's whole numbers
      return to_json(py::reinterpret_steal<py::object>(PyNumber_Index(object.ptr())));
    const double value = PyFloat_AsDouble(object.ptr());
    if (PyErr_Occurred()) throw py::error_already_set();
    if (std::isnan(value)) throw InvalidInput("a number is NaN");
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
    return value;
  }
  if (py::isinstance<py::sequence>(object) || py::isinstance<py::array>(object)) {
    Json json = Json::array();
    for (const py::handle& value : object) json.push_back(to_json(value));
    return json;
  }
  throw py::type_error("a number, text, list or dict is needed, not " +
                       py::str(py::type::handle_of(object).attr("__name__")).cast<std::string>());
}

std::vector<Vec3> to_points(const py::handle& object, const char* what) {
  const Doubles array = doubles(object, what);
  if (array.size() == 0) return {};
  if (array.ndim() != 2 || array.shape(1) != 3) wrong_shape(what, "(n, 3)", array);
  std::vector<Vec3> points(static_cast<std::size_t>(array.shape(0)));
  std::memcpy(static_cast<void*>(points.data()), array.data(), points.size() * sizeof(Vec3));
  return points;
}

std::vector<Triangle> to_triangles(const py::handle& object, std::size_t points) {
  const py::array any = py::array::ensure(object);
  if (!any) throw InvalidInput("triangles: not an array of whole numbers");
  if (any.size() == 0) return {};
  const char kind = any.dtype().kind();
  if (kind != 'i' && kind != 'u') throw InvalidInput("triangles: not an array of whole numbers");
  if (any.ndim() != 2 || any.shape(1) != 3) {
    const std::string hint = any.ndim() == 2 && any.shape(1) > 3 ? "; polygons must be cut into triangles first" : "";
    throw InvalidInput("triangles: an array of shape (m, 3) is needed, and this has shape " +
                       py::str(any.attr("shape")).cast<std::string>() + hint);
  }
  const auto indices = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>(any);
  std::vector<Triangle> triangles(static_cast<std::size_t>(indices.shape(0)));
  const std::int64_t* from = indices.data();
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t index = from[3 * i + k];
      if (index < 0 || static_cast<std::uint64_t>(index) >= points)
        throw InvalidInput("triangle " + std::to_string(i) + " names vertex " + std::to_string(index) +
                           ", and there are " + std::to_string(points));
      triangles[i][k] = static_cast<std::uint32_t>(index);
    }
  return triangles;
}

std::vector<double> to_numbers(const py::handle& object, const char* what) {
  const Doubles array = doubles(object, what);
  if (array.ndim() != 1) wrong_shape(what, "(n,)", array);
  return {array.data(), array.data() + array.size()};
}

std::array<std::array<double, 4>, 4> to_matrix(const py::handle& object) {
  const Doubles array = doubles(object, "matrix");
  if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4) wrong_shape("matrix", "(4, 4)", array);
  std::array<std::array<double, 4>, 4> matrix{};
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) matrix[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] = array.at(i, k);
  return matrix;
}

py::array_t<double> copy_of_points(std::span<const Vec3> points) {
  return py::array_t<double>({static_cast<py::ssize_t>(points.size()), py::ssize_t{3}},
                             reinterpret_cast<const double*>(points.data()));
}

}  // namespace tri::python
