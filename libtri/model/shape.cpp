#include "libtri/model/shape.hpp"

#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>

#include "libtri/model/shape_occt.hpp"
#include "libtri/model/shape_preparation_occt.hpp"
#include "meshops/error.hpp"

namespace tri {

Shape sewn(const Shape& shape, double tolerance) {
  if (shape.empty()) throw InvalidInput("sewn: the shape is empty");
  if (!needs_sewing(occt(shape))) return shape;
  PreparedShape prepared = track_faces(occt(shape));
  Context context;
  sew(prepared, tolerance, context);
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(prepared.shape, TopAbs_FACE, map);
  const std::vector<std::string>& old_names = shape.impl().face_names;
  std::vector<std::string> names(old_names.empty() ? 0 : static_cast<std::size_t>(map.Extent()));
  for (std::size_t i = 0; i < old_names.size(); ++i)
    if (const int k = prepared.faces[i].IsNull() ? 0 : map.FindIndex(prepared.faces[i]); k > 0)
      names[static_cast<std::size_t>(k) - 1] = old_names[i];
  return make_shape(prepared.shape, std::move(names));
}

}  // namespace tri
