#pragma once

#include <cstdint>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/crossings/arrangement/crossing_complex.hpp"
#include "meshops/crossings/arrangement/grid_frame.hpp"
#include "meshops/crossings/arrangement/part_sheets.hpp"
#include "meshops/crossings/arrangement/solid_boundary.hpp"
#include "meshops/crossings/solid_check.hpp"
#include "meshops/joining/close_surface.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// The steps of `make_solid` on one soup.
class SolidFromSoup {
 public:
  /// @param max_deviation share of the diagonal
  /// @param finest        as of `GridFrame`
  /// @param apart         no two vertices of the result may lie in one place, wherever that can be
  /// @param again         the soup is what this made before: plates and gaps are not to be taken for things that touch
  /// @param fillings      triangles of the soup, increasing, that close holes: they need not stay; afterwards those of
  /// the result. It and the soup must outlive this object.
  SolidFromSoup(Soup& soup, double max_deviation, bool keep_walls, int finest, bool apart, bool again,
                std::vector<std::uint32_t>& fillings);

  /// Changes the soup at the end.
  /// @return what still meets: nothing, but for rounding
  SurfaceContacts run(Report& report, bool tell_progress, Context& context);

 private:
  void take_triangles(Report& report, const Context& context);
  CrossingReport cut_along_crossings(Report& report, Context& context);
  std::vector<char> walls_to_keep(const CellLabels& labels, Context& context) const;
  PlacedBoundary boundary_without_contacts(const CellLabels& labels, Report& report, Context& context);
  std::size_t drop_where_near(const std::vector<std::uint32_t>& walls, const SolidBoundary& boundary,
                              std::vector<char>& keep_walls, std::vector<char>& must_stay,
                              const Context& context) const;
  void write(const PlacedBoundary& boundary, const std::vector<Vec3>& places, Report& report, const Context& context);
  std::vector<Vec3> places_of(const PlacedBoundary& boundary, const CellLabels& labels, SurfaceContacts& contacts,
                              Context& context) const;

  Soup& soup_;
  double max_deviation_;
  bool keep_walls_, apart_, again_;
  std::vector<std::uint32_t>& fillings_;
  GridFrame frame_;
  CrossingComplex complex_;
  std::vector<std::uint32_t> vertex_of_point_;    ///< of the complex's points: the soup's
  std::vector<std::uint32_t> triangle_of_given_;  ///< of the triangles handed to `close_surface`: the soup's
  ClosedSurface closed_;
};

}  // namespace tri
