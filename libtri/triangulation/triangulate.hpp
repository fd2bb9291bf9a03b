#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libtri/model/cad_model.hpp"
#include "libtri/model/tessellation.hpp"
#include "libtri/registration.hpp"
#include "meshops/context.hpp"
#include "meshops/mesh.hpp"
#include "meshops/report.hpp"

namespace tri {

/// How the points are connected.
enum class Method {
  automatic,  ///< patches; shell too if the checks of the result find something, and the better is kept
  patches,    ///< Delaunay per face in (u,v), stitched along the model's edges [Ristic et al. 2000]
  shell,      ///< insertion into the model's own sewn triangulation
};

/// What becomes of a region of the model without points.
enum class Unmeasured {
  hole,  ///< left open and reported
  span,  ///< bridged by long triangles, so that the topology is the model's
};

/// How points become one mesh, and what becomes of regions without points.
struct TriangulateOptions {
  Method method = Method::automatic;         ///< which of the two ways
  Unmeasured unmeasured = Unmeasured::hole;  ///< what becomes of regions without points
  double hole_size = 3;  ///< local point spacings, > 0: radius of the largest disc without points that is closed
  std::optional<double> outlier_distance;  ///< mm, > 0: points farther from the model are outliers; by default from the
                                           ///< points' own spread
  bool keep_patches = false;  ///< also return the mesh before stitching; runs the steps of `patches` for it
};

/// What one face of the model received.
struct FaceCoverage {
  int face = 0;              ///< 1-based, CadFace::index
  std::string name;          ///< from the file, may be empty
  std::uint64_t points = 0;  ///< that were taken to lie on this face
  double area = 0;           ///< mm^2
  std::string method;        ///< "shell" or "patches"
};

/// A region of the model that was not measured and is open in the mesh.
struct UnmeasuredRegion {
  Vec3 center{0, 0, 0};    ///< mm, middle of the largest disc without points
  double radius = 0;       ///< mm, of that disc
  double spacing = 0;      ///< mm, local point spacing around it
  std::vector<int> faces;  ///< 1-based faces of the model that it touches
};

/// What a triangulation was checked for; all of it is computed on the result.
struct TriangulationChecks {
  SurfaceTopology model;                 ///< of the sewn model
  SurfaceTopology mesh;                  ///< of the result, holes of unmeasured regions closed
  std::uint64_t self_intersections = 0;  ///< pairs of triangles
  std::uint64_t folds = 0;               ///< edges folded by more than 150 degrees
  std::uint64_t turned = 0;              ///< triangles that face against the model
  std::uint64_t bridging = 0;            ///< triangles that stand across the model, as `Bridges` says
  double bridging_share = 0;             ///< of the mesh's area, in [0, 1]
  std::uint64_t unused_points = 0;  ///< points that are neither vertex nor reported as outlier or duplicate; 0 unless
                                    ///< broken
};

/// The mesh, and what a report says of it.
struct TriangulateResult {
  Mesh mesh;                                            ///< with the properties of `property` (meshops/mesh.hpp)
  std::optional<Mesh> patches;                          ///< before stitching, when asked for
  std::vector<std::uint32_t> outliers;                  ///< ascending 0-based point indices
  std::vector<std::uint32_t> duplicates;                ///< points equal to an earlier one, ascending
  std::vector<FaceCoverage> faces;                      ///< in the order of CadModel::faces
  std::vector<int> unmeasured_faces;                    ///< 1-based faces without any point
  std::vector<UnmeasuredRegion> holes;                  ///< regions without points, open or spanned
  TriangulationChecks checks;                           ///< of the mesh
  double sigma = 0;                                     ///< mm, robust standard deviation of the deviations
  Method method = Method::shell;                        ///< the one that was kept
  std::string method_reason;                            ///< one sentence
  std::vector<std::pair<std::string, double>> seconds;  ///< per step, in order
  std::vector<std::string> notes;  ///< sentences for a person: what is not as it should be, with numbers
  std::vector<Report> steps;       ///< reports of the operators that ran
};

/// Triangulates unordered points measured on a CAD model: registers each on the model, connects them by the model's
/// surface, and returns one mesh through the points [Ristic, Brujic & Handayani 2000, steps (b) to (g)].
///
/// Every point that is not reported as an outlier or duplicate is a vertex exactly once, at its measured position.
/// Vertices are in the order of a space-filling curve; their property `point_index` names the point. The result does
/// not depend on the number of threads.
///
/// @param points  mm, in the model's frame, any order
/// @throws InvalidInput if an option is out of range, a coordinate is not finite, fewer than three distinct points are
///         left, or the points do not lie on the model (median distance above a twentieth of its diagonal)
/// @throws CadError if the model cannot be tessellated; Cancelled within a fraction of a second after
/// `context.cancel()`
TriangulateResult triangulate(const CadModel& model, std::span<const Vec3> points, const TriangulateOptions& options,
                              Context& context);

/// The same, with a registration that was made before. @param registration  of `model`
TriangulateResult triangulate(const CadModel& model, const Registration& registration, std::span<const Vec3> points,
                              const TriangulateOptions& options, Context& context);

}  // namespace tri
