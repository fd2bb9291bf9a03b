#include "python/report_dict.hpp"

#include <nlohmann/json.hpp>

#include "python/convert.hpp"

namespace tri::python {

py::dict report_dict(const Report& report) {
  py::dict dict = to_python(tri::to_json(report));
  dict["touched_vertices"] = copy_of_rows<std::uint32_t>(report.touched_vertices, 0);
  dict["touched_faces"] = copy_of_rows<std::uint32_t>(report.touched_faces, 0);
  if (!report.maps.empty()) {
    py::dict maps;
    maps["vertices"] = copy_of_rows<std::uint32_t>(report.maps.vertices, 0);
    maps["edges"] = copy_of_rows<std::uint32_t>(report.maps.edges, 0);
    maps["faces"] = copy_of_rows<std::uint32_t>(report.maps.faces, 0);
    dict["maps"] = maps;
  }
  dict["unchanged"] = report.unchanged();
  return dict;
}

}  // namespace tri::python
