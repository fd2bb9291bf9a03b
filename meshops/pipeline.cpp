#include "meshops/pipeline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "meshops/error.hpp"

namespace tri {
namespace {

constexpr std::string_view build_name = "build-mesh";
constexpr std::string_view unbuild_name = "to-soup";

bool is_mesh(Domain domain) {
  return domain == Domain::mesh;
}

/// One operator and its options, as on the command line.
struct Segment {
  std::string_view op;
  std::span<const std::string> options;
};

std::vector<Segment> split_segments(std::span<const std::string> tokens) {
  std::vector<Segment> segments;
  while (!tokens.empty()) {
    const auto end = static_cast<std::size_t>(std::ranges::find(tokens, "!") - tokens.begin());
    if (end == 0 || end + 1 == tokens.size())
      throw InvalidInput(
          fmt::format("step {}: no operator {} !", segments.size() + 1 + (end != 0), end ? "after" : "before"));
    segments.push_back({tokens[0], tokens.subspan(1, end - 1)});
    tokens = tokens.subspan(std::min(end + 1, tokens.size()));
  }
  return segments;
}

void read_options(const OptionSchema& schema, std::span<const std::string> tokens, void* options) {
  std::set<std::string, std::less<>> given;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    std::string_view token = tokens[i];
    if (!token.starts_with("--") || token.size() == 2)
      throw InvalidInput(fmt::format("unexpected '{}'; options begin with --, steps are separated by !", token));
    token.remove_prefix(2);
    const std::size_t equals = token.find('=');
    std::string_view name = token.substr(0, equals), value;
    const OptionSchema::Entry* entry = schema.find(name);
    if (equals != std::string_view::npos) {
      value = token.substr(equals + 1);
    } else if (entry && entry->info.type == OptionInfo::Type::boolean) {
      value = "true";
    } else if (const OptionSchema::Entry* positive = name.starts_with("no-") ? schema.find(name.substr(3)) : nullptr;
               positive && positive->info.type == OptionInfo::Type::boolean) {
      name.remove_prefix(3);
      value = "false";
    } else if (entry) {
      if (++i == tokens.size())
        throw InvalidInput(fmt::format("option {} has no value; allowed: {}", name, entry->info.allowed()));
      value = tokens[i];
    }
    schema.set_text(options, name, value);  // also refuses an unknown name
    if (!given.emplace(name).second) throw InvalidInput(fmt::format("option {} is given twice", name));
  }
}

/// Parses JSON and refuses objects that have a key twice, which the library would resolve in silence.
Json parse_json(std::string_view text) {
  std::vector<std::set<std::string>> keys;
  std::string twice;
  const auto watch = [&](int, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second && twice.empty())
      twice = value.get<std::string>();
    return true;
  };
  Json json;
  try {
    json = Json::parse(text.begin(), text.end(), watch);
  } catch (const Json::parse_error& error) {
    throw InvalidInput(fmt::format("not JSON at byte {}: {}", error.byte, error.what()));
  }
  if (!twice.empty()) throw InvalidInput(fmt::format("key {} is there twice", twice));
  return json;
}

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string Pipeline::place(std::size_t index, const Operator& op) const {
  return fmt::format("step {} ({}): ", index + 1, op.name());
}

Pipeline& Pipeline::add(const Operator& op, std::shared_ptr<const void> options) {
  try {
    op.schema().validate(options.get());
  } catch (const InvalidInput& error) {
    throw InvalidInput(place(steps_.size(), op) + error.what());
  }
  steps_.push_back({&op, std::move(options)});
  return *this;
}

Pipeline& Pipeline::add(Operator::Key function, std::shared_ptr<const void> options) {
  const Operator* op = registry_->find(function);
  if (!op) throw InvalidInput(fmt::format("step {}: this function is not a registered operator", steps_.size() + 1));
  return add(*op, std::move(options));
}

Pipeline& Pipeline::add(std::string_view name) {
  return add(name, Json::object());
}

Pipeline& Pipeline::add(std::string_view name, const Json& json) {
  const Operator* op = nullptr;
  try {
    op = &registry_->at(name);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("step {}: {}", steps_.size() + 1, error.what()));
  }
  std::shared_ptr<void> options = op->schema().make();
  try {
    if (!json.is_object()) throw InvalidInput(fmt::format("options = {} is not an object", dump(json)));
    for (const auto& [key, value] : json.items()) op->schema().set_json(options.get(), key, value);
  } catch (const InvalidInput& error) {
    throw InvalidInput(place(steps_.size(), *op) + error.what());
  }
  return add(*op, std::move(options));
}

Pipeline Pipeline::from_tokens(std::span<const std::string> tokens, const Registry& registry) {
  Pipeline pipeline(registry);
  for (const Segment& segment : split_segments(tokens)) {
    pipeline.add(segment.op);
    Step& step = pipeline.steps_.back();
    std::shared_ptr<void> options = step.op->schema().make();
    try {
      read_options(step.op->schema(), segment.options, options.get());
    } catch (const InvalidInput& error) {
      throw InvalidInput(pipeline.place(pipeline.steps_.size() - 1, *step.op) + error.what());
    }
    step.options = std::move(options);
  }
  return pipeline;
}

Pipeline Pipeline::from_json(std::string_view text, const Registry& registry) {
  const Json json = parse_json(text);
  if (!json.is_object()) throw InvalidInput("a recipe is an object with version and steps");
  for (const auto& [key, value] : json.items())
    if (key != "version" && key != "steps")
      throw InvalidInput(fmt::format("unknown key {}; allowed: version, steps", key));
  if (!json.contains("version") || json["version"] != 1)
    throw InvalidInput(fmt::format("version = {} is not allowed; allowed: 1",
                                   json.contains("version") ? dump(json["version"]) : "nothing"));
  if (!json.contains("steps") || !json["steps"].is_array()) throw InvalidInput("steps is missing, or is not an array");
  Pipeline pipeline(registry);
  for (const Json& step : json["steps"]) {
    if (!step.is_object() || !step.contains("op") || !step["op"].is_string())
      throw InvalidInput(fmt::format("step {}: {} is not an object with op", pipeline.steps_.size() + 1, dump(step)));
    Json options = step;
    options.erase("op");
    pipeline.add(step["op"].get<std::string>(), options);
  }
  return pipeline;
}

std::vector<std::string> Pipeline::to_tokens() const {
  std::vector<std::string> tokens;
  for (const Step& step : steps_) {
    if (!tokens.empty()) tokens.emplace_back("!");
    tokens.push_back(step.op->name());
    for (const auto& [name, text] : step.op->schema().to_text(step.options.get())) {
      if (step.op->schema().find(name)->info.type == OptionInfo::Type::boolean) {
        tokens.push_back((text == "true" ? "--" : "--no-") + name);
      } else if (text == "!" || text.empty()) {
        tokens.push_back("--" + name + "=" + text);  // a lone ! would end the step
      } else {
        tokens.push_back("--" + name);
        tokens.push_back(text);
      }
    }
  }
  return tokens;
}

Json Pipeline::to_json() const {
  Json steps = Json::array();
  for (const Step& step : steps_) {
    Json object = {{"op", step.op->name()}};
    object.update(step.op->schema().to_json(step.options.get()));
    steps.push_back(std::move(object));
  }
  return {{"version", 1}, {"steps", std::move(steps)}};
}

std::vector<Pipeline::Step> Pipeline::plan(Domain input, Domain* result) const {
  std::vector<Step> planned;
  Domain domain = input;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Step& step = steps_[i];
    if ((step.op->domain() == Domain::points) != (domain == Domain::points))
      throw InvalidInput(place(i, *step.op) +
                         (domain == Domain::points
                              ? fmt::format("works on a {}, and these are points: connecting them needs a model "
                                            "(tri triangulate --cad)",
                                            to_string(step.op->domain()))
                              : fmt::format("works on points, and this is a {}", to_string(domain))));
    if (is_mesh(step.op->domain()) != is_mesh(domain)) {
      const Operator& conversion = registry_->at(is_mesh(domain) ? unbuild_name : build_name);
      planned.push_back({&conversion, conversion.schema().make(), true});
    }
    planned.push_back(step);
    domain = step.op->result();
  }
  if (result) *result = domain;
  return planned;
}

std::vector<Report> Pipeline::run(MeshView mesh, Context& context) const {
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Operator& op = *steps_[i].op;
    if (op.domain() == Domain::points || op.result() != op.domain())
      throw InvalidInput(place(i, op) + "does not work on a mesh in place");
  }
  std::vector<Report> reports;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    try {
      reports.push_back(steps_[i].op->run(mesh, steps_[i].options.get(), context));
    } catch (const InvalidInput& error) {
      throw InvalidInput(place(i, *steps_[i].op) + error.what());
    }
  }
  return reports;
}

std::vector<Report> Pipeline::run(Geometry& geometry, Context& context) const {
  const std::vector<Step> planned = plan(domain_of(geometry));
  std::vector<Report> reports;
  std::size_t given = 0;
  for (std::size_t i = 0; i < planned.size(); ++i) {
    const Step& step = planned[i];
    try {
      Report report = step.op->run(geometry, step.options.get(), context);
      if (step.inserted)
        report.notes.insert(report.notes.begin(),
                            fmt::format("inserted before {}, which works on a {}", planned[i + 1].op->name(),
                                        to_string(planned[i + 1].op->domain())));
      reports.push_back(std::move(report));
    } catch (const InvalidInput& error) {
      throw InvalidInput(place(given, *step.op) + error.what());
    }
    if (!step.inserted) ++given;
  }
  return reports;
}

}  // namespace tri
