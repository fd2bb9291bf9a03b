#include "io/cad/cad_transfer.hpp"

#include <fmt/format.h>

#include <IGESControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Check.hxx>
#include <Interface_CheckIterator.hxx>
#include <STEPControl_Reader.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_StepModel.hxx>
#include <StepShape_Face.hxx>
#include <StepShape_ManifoldSolidBrep.hxx>
#include <StepShape_ShellBasedSurfaceModel.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <map>
#include <set>
#include <unordered_map>

#include "io/cad/occt_session.hpp"
#include "libtri/progress_occt.hpp"
#include "meshops/error.hpp"

namespace tri {
namespace {

bool has_face(const TopoDS_Shape& shape) {
  return !shape.IsNull() && TopExp_Explorer(shape, TopAbs_FACE).More();
}

std::string text(const Handle(TCollection_HAsciiString) & s) {
  return s.IsNull() ? std::string() : s->ToCString();
}

const char* iges_type_name(int type) {
  switch (type) {
    case 108:
      return "plane";
    case 114:
      return "parametric spline surface";
    case 118:
      return "ruled surface";
    case 120:
      return "surface of revolution";
    case 122:
      return "tabulated cylinder";
    case 128:
      return "B-spline surface";
    case 140:
      return "offset surface";
    case 143:
      return "bounded surface";
    case 144:
      return "trimmed surface";
    case 186:
      return "solid";
    case 190:
      return "plane surface";
    case 192:
      return "cylindrical surface";
    case 194:
      return "conical surface";
    case 196:
      return "spherical surface";
    case 198:
      return "toroidal surface";
    case 510:
      return "face";
    case 514:
      return "shell";
    default:
      return "entity";
  }
}

/// Counts messages that differ in their numbers only, so that one cause does not fill the report.
class Warnings {
 public:
  void add(const std::string& message) {
    std::string kind;
    for (const char c : message)
      if (c < '0' || c > '9') kind += c;
    if (kind.empty()) return;
    Entry& entry = entries_[kind];
    if (++entry.count == 1) {
      entry.first = message;
      order_.push_back(kind);
    }
  }
  std::vector<std::string> lines() const {
    std::vector<std::string> result;
    for (const std::string& kind : order_) {
      const Entry& entry = entries_.at(kind);
      result.push_back(entry.count == 1 ? entry.first : fmt::format("{} ({} such)", entry.first, entry.count));
    }
    return result;
  }

 private:
  struct Entry {
    std::string first;
    int count = 0;
  };
  std::map<std::string, Entry> entries_;
  std::vector<std::string> order_;
};

/// Everything the reader had to say about one entity, fails before warnings.
std::string reason_of(const XSControl_Reader& reader, const Handle(Standard_Transient) & entity) {
  const Handle(Interface_InterfaceModel) model = reader.Model();
  std::set<std::string> reasons;
  std::string first;
  const auto collect = [&](const Handle(Interface_Check) & check) {
    if (check.IsNull()) return;
    for (int i = 1; i <= check->NbFails(); ++i) {
      const std::string line = check->CFail(i);
      if (reasons.insert(line).second) first += (first.empty() ? "" : "; ") + line;
    }
    if (first.empty() && check->NbWarnings() > 0) first = check->CWarning(1);
  };
  const int number = model->Number(entity);
  if (number > 0) collect(model->Check(number, Standard_True));
  const Interface_CheckIterator checks = reader.WS()->TransferReader()->CheckList(entity, 2);
  for (Interface_CheckIterator it = checks; it.More(); it.Next()) collect(it.Value());
  return first.empty() ? "the reader gave no face and no reason" : first;
}

void add_transfer_messages(const XSControl_Reader& reader, Warnings& warnings) {
  Interface_CheckIterator checks = reader.WS()->TransferReader()->LastCheckList();
  for (checks.Start(); checks.More(); checks.Next()) {
    const Handle(Interface_Check)& check = checks.Value();
    for (int i = 1; i <= check->NbFails(); ++i) warnings.add(check->CFail(i));
    for (int i = 1; i <= check->NbWarnings(); ++i) warnings.add(check->CWarning(i));
  }
}

/// Entities that the parser could not fill: they, and whatever refers to them, are lost.
void add_parse_failures(const Handle(Interface_InterfaceModel) & model, Warnings& warnings) {
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Interface_Check)& check = model->Check(i, Standard_True);
    for (int k = 1; k <= check->NbFails(); ++k) warnings.add(check->CFail(k));
  }
  const Handle(Interface_Check)& global = model->GlobalCheck(Standard_True);
  for (int k = 1; !global.IsNull() && k <= global->NbFails(); ++k) warnings.add(global->CFail(k));
}

TopoDS_Shape result_of(const XSControl_Reader& reader, const Handle(Standard_Transient) & entity) {
  return TransferBRep::ShapeResult(reader.WS()->TransferReader()->TransientProcess(), entity);
}

/// Names by underlying face, so that every instance of an assembly gets them.
class FaceNames {
 public:
  void add(const TopoDS_Shape& shape, const std::string& name) {
    if (name.empty() || shape.IsNull()) return;
    int i = 0;
    for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next(), ++i)
      names_.emplace(it.Current().TShape().get(), name);
  }
  std::vector<std::string> in_order(const TopoDS_Shape& shape) const {
    if (names_.empty() || shape.IsNull()) return {};
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(shape, TopAbs_FACE, faces);
    std::vector<std::string> result(faces.Extent());
    bool any = false;
    for (int i = 1; i <= faces.Extent(); ++i)
      if (const auto it = names_.find(faces(i).TShape().get()); it != names_.end()) {
        result[i - 1] = it->second;
        any = true;
      }
    return any ? result : std::vector<std::string>{};
  }

 private:
  std::unordered_map<const void*, std::string> names_;
};

void read_file(XSControl_Reader& reader, const std::string& path, const char* format) {
  const IFSelect_ReturnStatus status = reader.ReadFile(path.c_str());
  if (status != IFSelect_RetDone)
    throw IoError(path, fmt::format("cannot be parsed as {} ({})", format,
                                    status == IFSelect_RetVoid    ? "nothing in it"
                                    : status == IFSelect_RetError ? "it cannot be opened"
                                                                  : "its content is malformed"));
  const Handle(Interface_InterfaceModel) model = reader.Model();
  if (model.IsNull() || model->NbEntities() == 0) throw IoError(path, fmt::format("holds no {} entity", format));
}

/// Turns all roots into shapes. Where OpenCASCADE gives up as a whole, the roots are tried one by one.
void transfer_roots(XSControl_Reader& reader, Context& context, std::vector<FailedEntity>& failed) {
  const Handle(OcctProgress) progress = new OcctProgress(context, "read CAD");
  const std::string failure = run_guarded([&] { reader.TransferRoots(progress->Start()); });
  context.checkpoint();
  if (failure.empty()) return;
  reader.ClearShapes();
  reader.WS()->InitTransferReader(5);  // forget what was begun
  const int count = reader.NbRootsForTransfer();
  for (int i = 1; i <= count; ++i) {
    context.checkpoint();
    const std::string reason = run_guarded([&] { reader.TransferOneRoot(i); });
    const Handle(Standard_Transient) root = reader.RootForTransfer(i);
    if (!reason.empty())
      failed.push_back(
          {fmt::format("{} {}", root->DynamicType()->Name(), text(reader.Model()->StringLabel(root))), reason});
  }
}

double iges_unit_mm(const IGESData_GlobalSection& section) {
  switch (section.UnitFlag()) {
    case 1:
      return 25.4;
    case 2:
      return 1;
    case 4:
      return 304.8;
    case 5:
      return 1609344;
    case 6:
      return 1000;
    case 7:
      return 1e6;
    case 8:
      return 0.0254;
    case 9:
      return 0.001;
    case 10:
      return 10;
    case 11:
      return 25.4e-6;
    default:
      return 0;
  }
}

double step_unit_mm(const std::string& name) {
  static const std::map<std::string, double> known{
      {"millimetre", 1},    {"metre", 1000},     {"centimetre", 10}, {"decimetre", 100}, {"kilometre", 1e6},
      {"micrometre", 1e-3}, {"nanometre", 1e-6}, {"INCH", 25.4},     {"inch", 25.4},     {"FOOT", 304.8},
      {"foot", 304.8},      {"FEET", 304.8},     {"MILE", 1609344},  {"THOU", 0.0254},   {"MIL", 0.0254}};
  const auto it = known.find(name);
  return it == known.end() ? 0 : it->second;
}

bool is_iges_surface(int type) {
  switch (type) {
    case 108:
    case 114:
    case 118:
    case 120:
    case 122:
    case 128:
    case 140:
    case 190:
    case 192:
    case 194:
    case 196:
    case 198:
      return true;
    default:
      return false;
  }
}

}  // namespace

CadTransfer transfer_iges(const std::string& path, Context& context) {
  CadTransfer result;
  IGESControl_Reader reader;
  read_file(reader, path, "IGES");
  context.checkpoint();
  const Handle(IGESData_IGESModel) model = reader.IGESModel();
  const IGESData_GlobalSection& section = model->GlobalSection();
  result.file.unit = text(section.UnitName());
  result.file.unit_mm = iges_unit_mm(section);
  if (result.file.unit.empty()) result.file.unit = fmt::format("unit flag {}", section.UnitFlag());

  const int root_count = reader.NbRootsForTransfer();
  std::set<int> roots;
  for (int i = 1; i <= root_count; ++i) roots.insert(model->Number(reader.RootForTransfer(i)));
  transfer_roots(reader, context, result.file.failed);
  result.shape = reader.OneShape();

  Warnings warnings;
  add_parse_failures(model, warnings);
  add_transfer_messages(reader, warnings);
  FaceNames names;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(IGESData_IGESEntity) entity = model->Entity(i);
    if (entity.IsNull()) continue;
    const int type = entity->TypeNumber();
    const bool is_face = type == 143 || type == 144 || type == 510 || (roots.count(i) != 0 && is_iges_surface(type));
    if (!is_face) continue;
    const TopoDS_Shape shape = result_of(reader, entity);
    if (has_face(shape)) {
      if (entity->HasName()) names.add(shape, text(entity->NameValue()));
      continue;
    }
    result.file.failed.push_back(
        {fmt::format("{} {} D{}", type, iges_type_name(type), 2 * i - 1), reason_of(reader, entity)});
  }
  result.file.warnings = warnings.lines();
  result.face_names = names.in_order(result.shape);
  return result;
}

CadTransfer transfer_step(const std::string& path, Context& context) {
  CadTransfer result;
  STEPControl_Reader reader;
  read_file(reader, path, "STEP");
  context.checkpoint();
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.FileUnits(lengths, angles, solid_angles);
  for (int i = 1; i <= lengths.Length(); ++i) {
    const std::string name = lengths(i).ToCString();
    if (result.file.unit.empty())
      result.file.unit = name;
    else if (name != result.file.unit)
      result.file.warnings.push_back("a further length unit is declared: " + name);
  }
  result.file.unit_mm = step_unit_mm(result.file.unit);

  const int root_count = reader.NbRootsForTransfer();
  transfer_roots(reader, context, result.file.failed);
  const Handle(Interface_InterfaceModel) model = reader.Model();

  // Without product structure (or with one that leads nowhere) nothing was transferred: take the parts themselves.
  Warnings warnings;
  const auto take_each = [&](const Handle(Standard_Type) & type, const char* what) {
    int count = 0;
    for (int i = 1; i <= model->NbEntities(); ++i) {
      if (!model->Value(i)->IsKind(type)) continue;
      context.checkpoint();
      bool done = false;
      const std::string reason = run_guarded([&] { done = reader.TransferEntity(model->Value(i)); });
      if (done) ++count;
      if (!reason.empty()) warnings.add(fmt::format("{}: {}", text(model->StringLabel(model->Value(i))), reason));
    }
    if (count > 0) warnings.add(fmt::format("no usable product structure: {} {} taken one by one", count, what));
  };
  const bool structured = has_face(reader.OneShape());
  if (!structured) take_each(STANDARD_TYPE(StepShape_ManifoldSolidBrep), "solids");
  if (!has_face(reader.OneShape())) take_each(STANDARD_TYPE(StepShape_ShellBasedSurfaceModel), "shell models");
  if (!has_face(reader.OneShape())) take_each(STANDARD_TYPE(StepShape_Face), "faces");
  result.shape = reader.OneShape();

  add_parse_failures(model, warnings);
  add_transfer_messages(reader, warnings);
  for (int i = 1; structured && i <= root_count; ++i) {
    const Handle(Standard_Transient) root = reader.RootForTransfer(i);
    if (!root.IsNull() && result_of(reader, root).IsNull())
      result.file.failed.push_back(
          {fmt::format("{} {}", root->DynamicType()->Name(), text(model->StringLabel(root))), reason_of(reader, root)});
  }
  FaceNames names;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient) entity = model->Value(i);
    if (const auto product = Handle(StepBasic_Product)::DownCast(entity); !product.IsNull()) {
      std::string name = text(product->Name());
      if (name.empty()) name = text(product->Id());
      if (!name.empty()) result.file.products.push_back(name);
    }
    const auto face = Handle(StepShape_Face)::DownCast(entity);
    if (face.IsNull()) continue;
    const TopoDS_Shape shape = result_of(reader, face);
    if (has_face(shape)) {
      const std::string name = text(face->Name());
      if (name != "NONE") names.add(shape, name);
    } else {
      result.file.failed.push_back({"face " + text(model->StringLabel(entity)), reason_of(reader, face)});
    }
  }
  const std::vector<std::string> lines = warnings.lines();
  result.file.warnings.insert(result.file.warnings.end(), lines.begin(), lines.end());
  result.face_names = names.in_order(result.shape);
  return result;
}

}  // namespace tri
