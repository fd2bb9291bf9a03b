#pragma once

// Included only by the source files that wrap OpenCASCADE.
#include <Geom2d_Curve.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <string>
#include <vector>

#include "meshops/vec.hpp"

namespace tri {

/// One use of an edge in a wire of a face taken FORWARD, in the order of the loop.
struct WireEdge {
  TopoDS_Edge edge;             ///< oriented as the wire uses it
  Handle(Geom2d_Curve) pcurve;  ///< in the edge's own direction over [first, last]
  double first = 0, last = 0;
  bool reversed = false;  ///< the loop runs against the edge
  Vec2 start() const;     ///< in the loop's direction
  Vec2 end() const;
};

/// The wires of a face taken FORWARD, each in running order; edges inside the face's material are left out.
struct WireLoops {
  std::vector<std::vector<WireEdge>> loops;
  std::string error;       ///< why the loops cannot be read; empty if they can
  int internal_edges = 0;  ///< edges that bound nothing
  double worst_gap = 0;    ///< largest jump between consecutive edges, as a share of the face's parameter box
};

WireLoops wire_loops(const TopoDS_Face& face);

/// True if the loops can be read and no jump in (u,v) is larger than 2% of the parameter box: neither a seam nor a pole
/// is missing.
bool loops_close(const TopoDS_Face& face);

}  // namespace tri
