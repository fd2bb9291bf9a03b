#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/geometry.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/registry.hpp"
#include "meshops/report.hpp"

namespace tri {

/// Operators with their options, one after another, in three forms with the same names:
///
///     pipeline.add(fill_holes, {.max_edges = 50}).run(view, context);
///     fill-holes --max-edges 50 ! compact
///     {"version": 1, "steps": [{"op": "fill-holes", "max-edges": 50}, {"op": "compact"}]}
///
/// Every step is checked when it is added, so a pipeline that exists can be run. Nothing here knows files: on a command
/// line such as `tri run in.stl ! fill-holes ! out.ply` the first and last segment are the program's.
class Pipeline {
 public:
  /// One operator with its options.
  struct Step {
    const Operator* op = nullptr;         ///< of the registry; never null in a pipeline
    std::shared_ptr<const void> options;  ///< points to the operator's own options struct
    bool inserted = false;                ///< a conversion that was left out and is needed
  };

  /// @param registry must outlive the pipeline.
  explicit Pipeline(const Registry& registry = Registry::standard()) : registry_(&registry) {}

  /// Adds a registered operator by its function.
  /// @throws InvalidInput naming step, key, value and what is allowed, if an option is out of range or the function is
  /// not
  ///   registered; the pipeline is as it was.
  template <class O>
  Pipeline& add(Report (*function)(MeshView, const O&, Context&), const std::type_identity_t<O>& options = {}) {
    return add(reinterpret_cast<Operator::Key>(function), std::make_shared<const O>(options));
  }
  /// The same for an operator on soups.
  template <class O>
  Pipeline& add(Report (*function)(Soup&, const O&, Context&), const std::type_identity_t<O>& options = {}) {
    return add(reinterpret_cast<Operator::Key>(function), std::make_shared<const O>(options));
  }
  /// The same for an operator on points.
  template <class O>
  Pipeline& add(Report (*function)(PointSet&, const O&, Context&), const std::type_identity_t<O>& options = {}) {
    return add(reinterpret_cast<Operator::Key>(function), std::make_shared<const O>(options));
  }
  /// Adds an operator by name, with a JSON object of options. @throws InvalidInput as above, and for an unknown name or
  /// key.
  Pipeline& add(std::string_view name, const Json& options);
  /// Adds an operator by name with default options, conversions included ("build-mesh").
  Pipeline& add(std::string_view name);

  /// Reads "OPERATOR [--NAME VALUE | --NAME=VALUE | --FLAG | --no-FLAG]... ! OPERATOR ...", one token each, without
  /// files.
  /// @throws InvalidInput naming the step and what is wrong with it.
  static Pipeline from_tokens(std::span<const std::string> tokens, const Registry& registry = Registry::standard());
  /// Reads the JSON form. @throws InvalidInput if it is not JSON (with the byte offset), a key is unknown, missing or
  /// there twice, the version is not 1, or a step is wrong.
  static Pipeline from_json(std::string_view text, const Registry& registry = Registry::standard());

  /// What `from_tokens` reads. Options that have their default value are left out.
  std::vector<std::string> to_tokens() const;
  /// What `from_json` reads. Options that have their default value are left out.
  Json to_json() const;

  /// In the order in which they were added; conversions that will be inserted are not among them, see `plan`.
  const std::vector<Step>& steps() const { return steps_; }
  /// True if there is no step; such a pipeline runs, and does nothing.
  bool empty() const { return steps_.empty(); }

  /// The steps that run on an input of this domain, inserted conversions included.
  /// @throws InvalidInput naming the step that works on points and would get a mesh, or the other way round.
  /// @param result if not null, receives the domain of what the last step leaves
  std::vector<Step> plan(Domain input, Domain* result = nullptr) const;

  /// Runs on a mesh in place, operators on soups too (see `run_on_mesh`). Reports come in the order of the steps.
  /// @throws InvalidInput before anything runs if a step does not work on a mesh; Cancelled, and what the operators
  /// throw (an
  ///   InvalidInput is prefixed with the step). The steps before the failing one have been done; the mesh is valid.
  std::vector<Report> run(MeshView mesh, Context& context) const;

  /// Runs on points, a soup or a mesh of its own, which changes type where the plan says so. An inserted conversion has
  /// a report that notes why it is there. @throws as above; `geometry` then holds what the last step that was done
  /// left.
  std::vector<Report> run(Geometry& geometry, Context& context) const;

 private:
  Pipeline& add(Operator::Key function, std::shared_ptr<const void> options);
  Pipeline& add(const Operator& op, std::shared_ptr<const void> options);
  std::string place(std::size_t index, const Operator& op) const;

  const Registry* registry_;
  std::vector<Step> steps_;
};

}  // namespace tri
