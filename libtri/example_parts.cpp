#include "libtri/example_parts.hpp"

#include <fmt/format.h>

#include <Standard_Failure.hxx>

#include "libtri/model/shape_occt.hpp"
#include "libtri/parts/parts.hpp"
#include "meshops/error.hpp"

namespace tri {
namespace {

struct Entry {
  ExamplePart part;
  TopoDS_Shape (*build)();
};

const std::vector<Entry>& entries() {
  static const std::vector<Entry> list = {
      {{"boot-lid",
        "car boot lid, 1300 mm wide, 980 mm along its profile: 16 trimmed NURBS, number-plate recess, lock hole", 16, 1,
        2, 0},
       parts::boot_lid},
      {{"blade", "fan blade, 40 x 120 mm, 0.6 to 2 mm thick, twisted, open at the root", 5, 1, 1, 1}, parts::blade},
      {{"bracket", "bracket of 1 mm sheet metal, 77 x 40 x 30 mm: two bends, four holes", 22, 1, 0, -6},
       parts::bracket},
      {{"elbow", "pipe elbow, 50 mm wide: five faces closed on themselves, open at both ends", 5, 1, 2, 0},
       parts::elbow},
      {{"housing", "cast housing, 120 x 80 x 45 mm: cavity, fillets, five bosses", 60, 1, 0, 2}, parts::housing},
      {{"sphere-cap", "cap of a sphere of 50 mm radius: one face with a pole", 1, 1, 1, 1}, parts::sphere_cap},
      {{"fillet-block", "block of 160 x 100 mm with 100 faces, 72 of them fillets of 0.8 or 1.5 mm radius", 100, 1, 0,
        2},
       parts::fillet_block},
  };
  return list;
}

}  // namespace

std::vector<ExamplePart> example_parts() {
  std::vector<ExamplePart> parts;
  for (const Entry& entry : entries()) parts.push_back(entry.part);
  return parts;
}

Shape example_part(std::string_view name) {
  std::string known;
  for (const Entry& entry : entries()) {
    if (entry.part.name == name) {
      try {
        return make_shape(entry.build());
      } catch (const Standard_Failure& failure) {
        throw CadError(fmt::format("example part {}: {}", name, failure.GetMessageString()));
      }
    }
    known += (known.empty() ? "" : ", ") + entry.part.name;
  }
  throw InvalidInput(fmt::format("no example part is called '{}'; known: {}", name, known));
}

}  // namespace tri
