#include <exception>

#include "meshops/error.hpp"
#include "python/module.hpp"

namespace tri::python {
namespace {

namespace py = pybind11;

// They live as long as the interpreter.
PyObject *error_type, *invalid_input_type, *io_error_type, *cad_error_type, *cancelled_type;

PyObject* make_type(py::module_& module, const char* name, const char* doc, const py::tuple& bases) {
  PyObject* type = PyErr_NewExceptionWithDoc((std::string("tri.") + name).c_str(), doc, bases.ptr(), nullptr);
  if (!type) throw py::error_already_set();
  module.attr(name) = py::handle(type);
  return type;
}

py::str text_of(const std::exception& error) {
  // File names may be no UTF-8.
  const std::string text = error.what();
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace"));
}

void set_io_error(const IoError& error) {
  const py::object value = py::reinterpret_borrow<py::object>(io_error_type)(text_of(error));
  const bool line = error.unit() == IoError::Unit::line, byte = error.unit() == IoError::Unit::byte;
  value.attr("file") = py::reinterpret_steal<py::object>(PyUnicode_DecodeFSDefault(error.file().c_str()));
  value.attr("line") = line ? py::object(py::int_(error.position())) : py::none();
  value.attr("byte") = byte ? py::object(py::int_(error.position())) : py::none();
  PyErr_SetObject(io_error_type, value.ptr());
}

void translate(std::exception_ptr pointer) {
  try {
    if (pointer) std::rethrow_exception(pointer);
  } catch (const IoError& error) {
    set_io_error(error);
  } catch (const InvalidInput& error) {
    PyErr_SetObject(invalid_input_type, text_of(error).ptr());
  } catch (const CadError& error) {
    PyErr_SetObject(cad_error_type, text_of(error).ptr());
  } catch (const Cancelled& error) {
    PyErr_SetObject(cancelled_type, text_of(error).ptr());
  } catch (const Error& error) {
    PyErr_SetObject(error_type, text_of(error).ptr());
  }
}

}  // namespace

void add_errors(py::module_& module) {
  error_type = make_type(module, "Error", "Base of every exception that the library raises on purpose.",
                         py::make_tuple(py::handle(PyExc_Exception)));
  const py::handle base(error_type);
  invalid_input_type =
      make_type(module, "InvalidInput",
                "A broken contract: an option out of range, an unknown name, an array of the wrong shape.",
                py::make_tuple(base, py::handle(PyExc_ValueError)));
  io_error_type =
      make_type(module, "IoError",
                "A file that cannot be read or written, or holds what no reader accepts. Attributes: file; line\n"
                "(1-based) or byte (0-based) where it is known, else None.",
                py::make_tuple(base, py::handle(PyExc_OSError)));
  cad_error_type = make_type(module, "CadError", "A CAD model that can be read but not used.", py::make_tuple(base));
  cancelled_type = make_type(module, "Cancelled", "Work that was stopped.", py::make_tuple(base));
  py::register_exception_translator(&translate);
}

}  // namespace tri::python
