#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/geometry.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// What an operator promises beside its header; the contract suite holds every registered operator to it.
struct Promises {
  /// A closed, well-shaped mesh that needs nothing (a regular icosahedron) is returned bit for bit with a zero report.
  bool leaves_good_mesh = true;
  /// A second run with the same options changes nothing.
  bool idempotent = true;
  /// Handles of elements that stay are the same afterwards; only `compact` renumbers.
  bool keeps_handles = true;
  /// Keeps to the selection of its view; only `compact`, which renumbers everything, refuses one.
  bool takes_selection = true;
};

/// A registered operator without the type of its options. `options` pointers point to the operator's own options
/// struct.
class Operator {
 public:
  /// Any function pointer; only ever compared.
  using Key = void (*)();

  const std::string& name() const { return name_; }        ///< kebab-case: "fill-holes"
  const std::string& summary() const { return summary_; }  ///< one line
  /// What it works on
  Domain domain() const { return domain_; }
  /// What it leaves: its own domain, but for the two conversions, "build-mesh" and "to-soup".
  Domain result() const { return result_; }
  /// Its options; lives as long as the program (or the plug-in).
  const OptionSchema& schema() const { return *schema_; }
  /// What every run keeps to.
  const Promises& promises() const { return promises_; }
  /// The function it was registered with; equal for the same function only.
  Key key() const { return key_; }

  /// Runs on a mesh in place, also an operator on soups (see `run_on_mesh`); the report has its `operation` and
  /// `seconds` filled.
  /// @throws InvalidInput if an option is out of range or this is a conversion or works on points; else what the
  /// operator's header says.
  Report run(MeshView mesh, const void* options, Context& context) const;
  /// On points in place. @throws InvalidInput if it does not work on points
  Report run(PointSet& points, const void* options, Context& context) const;
  /// On a soup in place. @throws InvalidInput if it does not work on soups
  Report run(Soup& soup, const void* options, Context& context) const;
  /// The same for any operator, conversions included, on a geometry of its domain.
  Report run(Geometry& geometry, const void* options, Context& context) const;

 private:
  friend class Registry;

  std::string name_;
  std::string summary_;
  Domain domain_ = Domain::mesh;
  Domain result_ = Domain::mesh;
  const OptionSchema* schema_ = nullptr;
  Promises promises_;
  Key key_ = nullptr;
  std::function<Report(MeshView, const void*, Context&)> run_mesh_;
  std::function<Report(Soup&, const void*, Context&)> run_soup_;
  std::function<Report(PointSet&, const void*, Context&)> run_points_;
  std::function<Report(Geometry&, Context&)> convert_;
};

/// The operators by name.
///
/// There is one way to make an operator, in meshops/operators/name.{hpp,cpp}: an options struct with defaults, its
/// `static const OptionSchema& schema()`, and the free function
///
///     Report fill_holes(MeshView mesh, const FillHolesOptions& options, Context& context);
///
/// (or `Soup&` or `PointSet&` in place of `MeshView`), whose first line is `validate(options);`. Then one line in
/// register_operators.cpp.
///
/// Copies are cheap and independent: they share the operators they have and add further ones each for itself. A program
/// with operators of its own or of plug-ins copies the standard registry, adds to the copy, and hands that to its
/// pipelines; nothing is global.
class Registry {
 public:
  /// Without any operator.
  Registry() = default;
  /// Shares the operators and keeps the plug-ins loaded; adding to one does not change the other.
  Registry(const Registry&) = default;
  /// Leaves the other one empty.
  Registry(Registry&&) noexcept = default;
  /// The operators it had are released before the plug-ins that hold their code.
  Registry& operator=(Registry other) noexcept;
  ~Registry() = default;

  /// Every operator of meshops; immutable, safe to read from any thread.
  static const Registry& standard();

  /// Registers an operator on meshes with options O. @param summary  one line without a full stop
  /// @throws InvalidInput if the name is not kebab-case or taken.
  template <class O>
  void add(std::string_view name, Report (*function)(MeshView, const O&, Context&), std::string_view summary,
           Promises promises = {}) {
    Operator& op =
        insert(name, summary, Domain::mesh, O::schema(), promises, reinterpret_cast<Operator::Key>(function));
    op.run_mesh_ = [function](MeshView mesh, const void* options, Context& context) {
      return function(mesh, *static_cast<const O*>(options), context);
    };
  }
  /// The same for an operator on soups.
  template <class O>
  void add(std::string_view name, Report (*function)(Soup&, const O&, Context&), std::string_view summary,
           Promises promises = {}) {
    Operator& op =
        insert(name, summary, Domain::soup, O::schema(), promises, reinterpret_cast<Operator::Key>(function));
    op.run_soup_ = [function](Soup& soup, const void* options, Context& context) {
      return function(soup, *static_cast<const O*>(options), context);
    };
  }
  /// The same for an operator on points.
  template <class O>
  void add(std::string_view name, Report (*function)(PointSet&, const O&, Context&), std::string_view summary,
           Promises promises = {}) {
    Operator& op =
        insert(name, summary, Domain::points, O::schema(), promises, reinterpret_cast<Operator::Key>(function));
    op.run_points_ = [function](PointSet& points, const void* options, Context& context) {
      return function(points, *static_cast<const O*>(options), context);
    };
  }

  /// One of the two conversions between soup and mesh; they have no options.
  void add_conversion(std::string_view name, Domain from, Domain to, Report (*function)(Geometry&, Context&),
                      std::string_view summary);

  /// Keeps `code`, say a plug-in whose functions are registered here, for as long as this registry or a copy lives.
  void keep(std::shared_ptr<const void> code) { code_.push_back(std::move(code)); }

  /// In order of registration.
  const std::vector<std::shared_ptr<const Operator>>& operators() const { return operators_; }
  /// Nullptr if there is none.
  const Operator* find(std::string_view name) const;
  /// By the function it was registered with; nullptr if there is none.
  const Operator* find(Operator::Key function) const;
  /// @throws InvalidInput naming all operators if there is none of this name.
  const Operator& at(std::string_view name) const;

  /// An array with one object per operator: name, domain, result, summary, options.
  Json describe() const;

 private:
  Operator& insert(std::string_view name, std::string_view summary, Domain domain, const OptionSchema& schema,
                   const Promises& promises, Operator::Key key);

  // First, so that it is released last: operators are destroyed by the code that registered them.
  std::vector<std::shared_ptr<const void>> code_;
  std::vector<std::shared_ptr<const Operator>> operators_;
};

/// The explicit list (self-registration is dropped from static libraries).
void register_operators(Registry& registry);

}  // namespace tri
