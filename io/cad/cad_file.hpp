#pragma once

#include <string>
#include <vector>

#include "libtri/model/shape.hpp"
#include "meshops/context.hpp"

namespace tri {

/// Something of a CAD file that did not become part of the shape.
struct FailedEntity {
  std::string entity;  ///< "144 trimmed surface D45" (IGES directory entry) or "ADVANCED_FACE #120" (STEP)
  std::string reason;  ///< what the reader said
};

/// A CAD file as read: its shape, and what it says about itself.
struct CadFile {
  Shape shape;                        ///< lengths converted to millimetres; faces carry the file's names
  std::string format;                 ///< "IGES", "STEP" or "BREP", told from the content
  std::string unit;                   ///< length unit the file declares ("millimetre", "INCH", "M"); empty for BREP
  double unit_mm = 1;                 ///< millimetres per declared unit; 0 if the name is unknown
  int faces = 0;                      ///< distinct faces of `shape`: the range of face numbers is 1..faces
  int shells = 0;                     ///< in `shape`, those of solids included
  int solids = 0;                     ///< in `shape`
  std::vector<std::string> products;  ///< names of the products of a STEP file, in file order
  std::vector<FailedEntity> failed;   ///< roots and faces of the file that are not in `shape`
  std::vector<std::string> warnings;  ///< one line each, like ones counted
};

/// Reads an IGES, STEP or BREP file (text or binary) through OpenCASCADE.
///
/// The format is told from the content; the extension only words the error. A STEP file without product structure is
/// read solid by solid, shell by shell, then face by face. While it runs, OpenCASCADE's messages are silenced and its
/// crashes (signals) become errors, both process-wide: do not read two CAD files at the same time. A reader that never
/// returns is not stopped.
/// @throws IoError if `path` is missing, a folder, empty, truncated, of no known format, or not parsed.
/// @throws CadError if the file was parsed but yields no face; the message says why.
/// @throws Cancelled between entities.
CadFile read_cad(const std::string& path, Context& context);

/// Writes IGES (.igs, .iges), STEP (.stp, .step) or BREP (.brep) as the extension of `path` says, in millimetres.
///
/// IGES holds loose trimmed surfaces (entities 144 on 128, trimmed by 142/126): every surface is converted to NURBS.
/// The file appears whole under its name or not at all.
/// @throws InvalidInput if `shape` is empty or the extension is another.
/// @throws IoError if the file cannot be written.
/// @throws CadError if OpenCASCADE cannot express the shape in that format.
void write_cad(const std::string& path, const Shape& shape);

}  // namespace tri
