#include "python/change.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <iterator>
#include <string>

#include "python/convert.hpp"
#include "python/module.hpp"
#include "python/report_dict.hpp"

namespace tri::python {
namespace {

using Indices = std::vector<std::uint32_t>;  // ascending

Indices united(const Indices& a, const Indices& b) {
  Indices all;
  std::ranges::set_union(a, b, std::back_inserter(all));
  return all;
}

Indices without(const Indices& a, const Indices& b) {
  Indices rest;
  std::ranges::set_difference(a, b, std::back_inserter(rest));
  return rest;
}

/// Of elements that were there before and still are.
Indices staying(const Indices& first, const Indices& second, const ElementNotes& both) {
  return without(without(united(first, second), both.added), both.removed);
}

ElementNotes joined(const ElementNotes& first, const ElementNotes& second) {
  ElementNotes both;
  both.added = without(united(first.added, second.added), second.removed);
  both.removed = united(first.removed, without(second.removed, first.added));
  // What was added and removed again is in none of the lists.
  ElementNotes known = both;
  known.removed = united(first.removed, second.removed);
  both.relinked = staying(first.relinked, second.relinked, known);
  both.revalued = staying(first.revalued, second.revalued, known);
  return both;
}

using Names = std::vector<std::string>;

void append(Names& names, const Names& more) {
  for (const std::string& name : more)
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
}

void erase(Names& names, const Names& gone) {
  std::erase_if(names, [&](const std::string& name) { return std::ranges::find(gone, name) != gone.end(); });
}

ChangeNotes joined(const ChangeNotes& first, const ChangeNotes& second) {
  ChangeNotes both;
  if ((both.renumbered = first.renumbered || second.renumbered)) return both;
  both.vertices = joined(first.vertices, second.vertices);
  both.edges = joined(first.edges, second.edges);
  both.faces = joined(first.faces, second.faces);
  ElementNotes known = both.vertices;
  known.removed = united(first.vertices.removed, second.vertices.removed);
  both.vertices_moved = staying(first.vertices_moved, second.vertices_moved, known);
  Names added_and_removed = first.properties_added;
  std::erase_if(added_and_removed, [&](const std::string& name) {
    return std::ranges::find(second.properties_removed, name) == second.properties_removed.end();
  });
  both.properties_added = first.properties_added;
  append(both.properties_added, second.properties_added);
  both.properties_removed = first.properties_removed;
  append(both.properties_removed, second.properties_removed);
  both.properties_rewritten = first.properties_rewritten;
  append(both.properties_rewritten, second.properties_rewritten);
  for (Names* names : {&both.properties_added, &both.properties_removed, &both.properties_rewritten})
    erase(*names, added_and_removed);
  return both;
}

py::array_t<std::uint32_t> array_of(const Indices& indices) {
  return copy_of_rows<std::uint32_t>(indices, 0);
}

void add_notes(py::module_& module) {
  py::class_<ElementNotes> element(module, "ElementNotes",
                                   "What became of the elements of one kind: arrays of indices, ascending.");
  const auto list = [&](const char* name, Indices ElementNotes::*member, const char* doc) {
    element.def_property_readonly(
        name, [member](const ElementNotes& n) { return array_of(n.*member); }, doc);
  };
  list("added", &ElementNotes::added, "There now and not before.");
  list("removed", &ElementNotes::removed, "Marked as deleted now and not before.");
  list("relinked", &ElementNotes::relinked, "Of those that stayed: edges with other ends, faces with other corners.");
  list("revalued", &ElementNotes::revalued, "Of those that stayed: with properties or status written to.");

  py::class_<ChangeNotes> notes(module, "ChangeNotes", "What changed, so that only that need be looked at again.");
  notes.def_readonly("vertices", &ChangeNotes::vertices, "ElementNotes of the vertices.");
  notes.def_readonly("edges", &ChangeNotes::edges, "ElementNotes of the edges.");
  notes.def_readonly("faces", &ChangeNotes::faces, "ElementNotes of the faces.");
  notes.def_property_readonly(
      "vertices_moved", [](const ChangeNotes& n) { return array_of(n.vertices_moved); },
      "Indices of vertices that stayed and were moved.");
  notes.def_readonly(
      "renumbered", &ChangeNotes::renumbered,
      "True if elements have other indices (compact): everything may have changed, and the lists are empty.");
  notes.def_readonly("properties_added", &ChangeNotes::properties_added,
                     "Names of properties that are there now and not before.");
  notes.def_readonly("properties_removed", &ChangeNotes::properties_removed,
                     "Names of properties that were there before.");
  notes.def_readonly("properties_rewritten", &ChangeNotes::properties_rewritten,
                     "Names of properties rewritten as a whole.");
  notes.def_property_readonly("empty", &ChangeNotes::empty, "True if nothing changed.");
  notes.def("inverse", &ChangeNotes::inverse,
            "What an undo changes: what was added is removed and the other way round.");
}

}  // namespace

void Change::undo() {
  if (undone_) throw InvalidInput("cannot undo: the change is already undone");
  const HeldMesh::Changing mesh(*mesh_);
  auto part = done_.rbegin();
  try {
    for (; part != done_.rend(); ++part) part->undo(*mesh);
  } catch (...) {
    while (part != done_.rbegin()) (--part)->redo(*mesh);
    throw;
  }
  undone_ = true;
}

void Change::redo() {
  if (!undone_) throw InvalidInput("cannot redo: the change is not undone");
  const HeldMesh::Changing mesh(*mesh_);
  auto part = done_.begin();
  try {
    for (; part != done_.end(); ++part) part->redo(*mesh);
  } catch (...) {
    while (part != done_.begin()) (--part)->undo(*mesh);
    throw;
  }
  undone_ = false;
}

bool Change::empty() const {
  return std::ranges::all_of(done_, [](const ChangeSet& part) { return part.empty(); });
}

ChangeNotes Change::notes() const {
  ChangeNotes all;
  for (const ChangeSet& part : done_) all = joined(all, part.notes());
  return all;
}

void add_recording(py::class_<HeldMesh, std::shared_ptr<HeldMesh>>& type) {
  type.def(
      "record", [](const std::shared_ptr<HeldMesh>& mesh) { return std::make_shared<Change>(mesh); },
      "with mesh.record() as change: what operators do to the mesh in the block can be undone. An exception in the block\n"
      "takes it all back. Values written into arrays are not recorded.");
}

void add_changes(py::module_& module) {
  add_notes(module);
  py::class_<Change, std::shared_ptr<Change>>(
      module, "Change",
      "What operators did to a mesh while it was recorded. An undo restores links, positions, status and properties exactly, and a\n"
      "redo what the operators made; both cost what changed. Several changes are undone last first.")
      .def("__enter__",
           [](const std::shared_ptr<Change>& change) {
             if (change->mesh().recording.lock()) throw InvalidInput("this mesh is being recorded already");
             if (!change->parts().empty())
               throw InvalidInput("this change is recorded already; mesh.record() begins another");
             change->mesh().recording = change;
             return change;
           })
      .def(
          "__exit__",
          [](Change& change, const py::object& type, const py::object&, const py::object&) {
            change.mesh().recording.reset();
            if (!type.is_none() && !change.undone()) change.undo();
            return false;
          },
          py::arg("type"), py::arg("value"), py::arg("traceback"))
      .def("undo", &Change::undo,
           "Takes the change back. InvalidInput, and nothing done, if it is undone or the mesh was changed since.")
      .def("redo", &Change::redo,
           "Does it again. InvalidInput, and nothing done, if it is not undone or the mesh was changed since.")
      .def_property_readonly("undone", &Change::undone, "True after an undo, False after a redo.")
      .def_property_readonly("empty", &Change::empty, "True if the operators wrote nothing at all.")
      .def_property_readonly("notes", &Change::notes, "ChangeNotes: what was added, removed and moved.")
      .def_property_readonly(
          "reports",
          [](const Change& change) {
            py::list reports;
            for (const ChangeSet& part : change.parts())
              for (const Report& report : part.reports()) reports.append(report_dict(report));
            return reports;
          },
          "The report of each operator, in their order.");
}

}  // namespace tri::python
