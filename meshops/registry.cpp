#include "meshops/registry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "meshops/error.hpp"
#include "meshops/soup_on_mesh.hpp"

namespace tri {
namespace {

/// The one place where `operation` and `seconds` of a report are filled.
template <class Run>
Report timed(const std::string& name, const Run& run) {
  const auto start = std::chrono::steady_clock::now();
  Report report = run();
  report.operation = name;
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

}  // namespace

std::string_view to_string(Domain domain) {
  switch (domain) {
    case Domain::points:
      return "points";
    case Domain::soup:
      return "soup";
    case Domain::mesh:
      return "mesh";
  }
  return "";
}

Domain domain_of(const Geometry& geometry) {
  if (std::holds_alternative<PointSet>(geometry)) return Domain::points;
  return std::holds_alternative<Mesh>(geometry) ? Domain::mesh : Domain::soup;
}

Report Operator::run(MeshView mesh, const void* options, Context& context) const {
  if (run_soup_) {
    const auto op = [&](Soup& soup) { return run_soup_(soup, options, context); };
    return timed(name_, [&] { return run_on_mesh(op, mesh, context); });
  }
  if (!run_mesh_) throw InvalidInput(fmt::format("{} works on {}, not on a mesh", name_, to_string(domain_)));
  return timed(name_, [&] { return run_mesh_(mesh, options, context); });
}

Report Operator::run(Geometry& geometry, const void* options, Context& context) const {
  const Domain domain = domain_of(geometry);
  if (convert_ && domain == domain_) return timed(name_, [&] { return convert_(geometry, context); });
  if (domain == Domain::mesh) return run(view_of(std::get<Mesh>(geometry)), options, context);
  if (domain == Domain::points) return run(std::get<PointSet>(geometry), options, context);
  return run(std::get<Soup>(geometry), options, context);
}

Report Operator::run(Soup& soup, const void* options, Context& context) const {
  if (!run_soup_) throw InvalidInput(fmt::format("{} works on {}, not on a soup", name_, to_string(domain_)));
  return timed(name_, [&] { return run_soup_(soup, options, context); });
}

Report Operator::run(PointSet& points, const void* options, Context& context) const {
  if (!run_points_) throw InvalidInput(fmt::format("{} works on a {}, not on points", name_, to_string(domain_)));
  return timed(name_, [&] { return run_points_(points, options, context); });
}

const Registry& Registry::standard() {
  static const Registry registry = [] {
    Registry r;
    register_operators(r);
    return r;
  }();
  return registry;
}

Registry& Registry::operator=(Registry other) noexcept {
  code_.swap(other.code_);
  operators_.swap(other.operators_);
  return *this;
}

Operator& Registry::insert(std::string_view name, std::string_view summary, Domain domain, const OptionSchema& schema,
                           const Promises& promises, Operator::Key key) {
  const auto allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; };
  if (name.empty() || !std::ranges::all_of(name, allowed) || name.front() == '-' || name.back() == '-')
    throw InvalidInput(fmt::format("operator name '{}' is not kebab-case", name));
  if (find(name)) throw InvalidInput(fmt::format("operator {} is there already", name));
  auto op = std::make_shared<Operator>();
  op->name_ = name;
  op->summary_ = summary;
  op->domain_ = domain;
  op->result_ = domain;
  op->schema_ = &schema;
  op->promises_ = promises;
  op->key_ = key;
  Operator& inserted = *op;
  operators_.push_back(std::move(op));
  return inserted;
}

void Registry::add_conversion(std::string_view name, Domain from, Domain to, Report (*function)(Geometry&, Context&),
                              std::string_view summary) {
  struct None {};
  static const OptionSchema no_options = Schema<None>();
  Operator& op = insert(name, summary, from, no_options, {}, reinterpret_cast<Operator::Key>(function));
  op.result_ = to;
  op.convert_ = function;
}

const Operator* Registry::find(std::string_view name) const {
  for (const auto& op : operators_)
    if (op->name() == name) return op.get();
  return nullptr;
}

const Operator* Registry::find(Operator::Key function) const {
  for (const auto& op : operators_)
    if (op->key() == function) return op.get();
  return nullptr;
}

const Operator& Registry::at(std::string_view name) const {
  if (const Operator* op = find(name)) return *op;
  std::vector<std::string_view> names;
  for (const auto& op : operators_) names.push_back(op->name());
  std::ranges::sort(names);
  throw InvalidInput(fmt::format("unknown operator {}; allowed: {}", name, fmt::join(names, ", ")));
}

Json Registry::describe() const {
  Json array = Json::array();
  for (const auto& op : operators_)
    array.push_back({{"name", op->name()},
                     {"domain", to_string(op->domain())},
                     {"result", to_string(op->result())},
                     {"summary", op->summary()},
                     {"options", op->schema().describe()}});
  return array;
}

}  // namespace tri
