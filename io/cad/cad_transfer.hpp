#pragma once

// Included only by the source files that wrap OpenCASCADE's readers and writers.
#include <TopoDS_Shape.hxx>

#include "io/cad/cad_file.hpp"

namespace tri {

/// What a reader fills before the shape is wrapped: everything of CadFile but `shape` and the counts.
struct CadTransfer {
  TopoDS_Shape shape;
  std::vector<std::string> face_names;  ///< as Shape::Impl::face_names
  CadFile file;
};

/// Read a file whose format is known. OpenCASCADE's exceptions pass through.
/// @throws IoError if the file is not parsed. A shape without faces is left to the caller.
CadTransfer transfer_iges(const std::string& path, Context& context);
CadTransfer transfer_step(const std::string& path, Context& context);

}  // namespace tri
