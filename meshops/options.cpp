#include "meshops/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "meshops/error.hpp"
#include "meshops/limits.hpp"

namespace tri {
namespace {

using Type = OptionInfo::Type;

std::string_view type_name(Type type) {
  switch (type) {
    case Type::boolean:
      return "boolean";
    case Type::integer:
      return "integer";
    case Type::number:
      return "number";
    case Type::choice:
      return "choice";
    case Type::text:
      return "text";
    case Type::numbers:
      return "numbers";
  }
  return "";
}

bool kebab_case(std::string_view name) {
  const auto allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; };
  return !name.empty() && std::ranges::all_of(name, allowed) && name.front() != '-' && name.back() != '-' &&
         name.find("--") == std::string_view::npos;
}

/// Shortest text that reads back as the same number.
std::string number_text(double value) {
  return fmt::format("{}", value);
}

std::string value_text(const OptionValue& value) {
  struct {
    std::string operator()(bool v) const { return v ? "true" : "false"; }
    std::string operator()(std::int64_t v) const { return fmt::format("{}", v); }
    std::string operator()(double v) const { return number_text(v); }
    std::string operator()(const std::string& v) const { return v; }
    std::string operator()(const std::vector<double>& v) const { return fmt::format("{}", fmt::join(v, ",")); }
  } visitor;
  return std::visit(visitor, value);
}

Json number_json(double value) {
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Json value_json(const OptionValue& value) {
  if (const double* number = std::get_if<double>(&value)) return number_json(*number);
  if (const auto* list = std::get_if<std::vector<double>>(&value)) {
    Json array = Json::array();
    for (double number : *list) array.push_back(number_json(number));
    return array;
  }
  return std::visit([](const auto& v) { return Json(v); }, value);
}

std::optional<double> read_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || std::isnan(value)) return std::nullopt;
  return value;
}

std::optional<double> read_number(const Json& json) {
  if (json.is_number()) return json.get<double>();
  if (json.is_string()) {
    const std::optional<double> value = read_number(std::string_view(json.get_ref<const std::string&>()));
    if (value && std::isinf(*value)) return value;
  }
  return std::nullopt;
}

std::optional<std::int64_t> whole(double value) {
  // 2^53: every whole number up to here is a double, and nothing counts further.
  if (value != std::floor(value) || std::abs(value) > 9007199254740992.0) return std::nullopt;
  return static_cast<std::int64_t>(value);
}

/// The value of an option's type that `text` spells, or none.
std::optional<OptionValue> parse(Type type, std::string_view text) {
  switch (type) {
    case Type::boolean:
      if (text == "true") return true;
      if (text == "false") return false;
      return std::nullopt;
    case Type::integer:
      if (const auto value = read_number(text))
        if (const auto integer = whole(*value)) return *integer;
      return std::nullopt;
    case Type::number:
      if (const auto value = read_number(text)) return *value;
      return std::nullopt;
    case Type::choice:
    case Type::text:
      return std::string(text);
    case Type::numbers: {
      std::vector<double> list;
      while (!text.empty()) {
        const std::size_t comma = std::min(text.find(','), text.size());
        const auto value = read_number(text.substr(0, comma));
        if (!value || comma + 1 == text.size()) return std::nullopt;
        list.push_back(*value);
        text.remove_prefix(std::min(comma + 1, text.size()));
      }
      return list;
    }
  }
  return std::nullopt;
}

std::optional<OptionValue> parse(Type type, const Json& json) {
  switch (type) {
    case Type::boolean:
      if (json.is_boolean()) return json.get<bool>();
      return std::nullopt;
    case Type::integer:
      if (json.is_number())
        if (const auto integer = whole(json.get<double>())) return *integer;
      return std::nullopt;
    case Type::number:
      if (const auto value = read_number(json)) return *value;
      return std::nullopt;
    case Type::choice:
    case Type::text:
      if (json.is_string()) return json.get<std::string>();
      return std::nullopt;
    case Type::numbers: {
      if (!json.is_array()) return std::nullopt;
      std::vector<double> list;
      for (const Json& item : json) {
        const auto value = read_number(item);
        if (!value) return std::nullopt;
        list.push_back(*value);
      }
      return list;
    }
  }
  return std::nullopt;
}

bool in_range(const OptionInfo& info, double value) {
  if (std::isnan(value) || (std::isinf(value) && !info.infinite)) return false;
  if (info.minimum_open ? !(value > info.minimum) : !(value >= info.minimum)) return false;
  return info.maximum_open ? value < info.maximum : value <= info.maximum;
}

bool is_allowed(const OptionInfo& info, const OptionValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return in_range(info, static_cast<double>(*integer));
  if (const auto* number = std::get_if<double>(&value)) return in_range(info, *number);
  if (const auto* list = std::get_if<std::vector<double>>(&value))
    return std::ranges::all_of(*list, [&](double number) { return in_range(info, number); });
  if (info.type == Type::choice) return std::ranges::count(info.choices, std::get<std::string>(value)) == 1;
  return true;
}

[[noreturn]] void refuse(const OptionInfo& info, std::string_view value) {
  throw InvalidInput(fmt::format("option {} = {} is not allowed; allowed: {}", info.name, value, info.allowed()));
}

bool is_huge(double bound) {
  return std::abs(bound) >= 2147483647.0;
}

}  // namespace

double to_radians(double degrees) {
  return degrees * (std::numbers::pi / 180);
}

double to_degrees(double radians) {
  const double degrees = radians * (180 / std::numbers::pi);
  if (!std::isfinite(degrees)) return degrees;
  for (int digits = 1; digits <= 17; ++digits) {
    const double candidate = *read_number(std::string_view(fmt::format("{:.{}g}", degrees, digits)));
    if (to_radians(candidate) == radians) return candidate;
  }
  return degrees;
}

std::string OptionInfo::allowed() const {
  std::string text;
  switch (type) {
    case Type::boolean:
      return "true or false";
    case Type::text:
      return "any text";
    case Type::choice:
      return fmt::format("{}", fmt::join(choices, ", "));
    case Type::integer:
      text = "a whole number";
      break;
    case Type::number:
      text = "a number";
      break;
    case Type::numbers:
      text = "numbers, each";
      break;
  }
  const bool below = type == Type::integer ? !is_huge(minimum) : minimum > -infinity;
  const bool above = type == Type::integer ? !is_huge(maximum) : maximum < infinity;
  if (below) text += fmt::format("{} {}", minimum_open ? " above" : " from", minimum);
  if (above) text += fmt::format("{} {}", maximum_open ? " below" : below ? " to" : " up to", maximum);
  if (infinite) text += " or inf";
  if (!unit.empty()) text += fmt::format(" ({})", unit);
  return text;
}

void OptionSchema::add(Entry entry) {
  const OptionInfo& info = entry.info;
  if (!kebab_case(info.name) || info.name.starts_with("no-"))
    throw InvalidInput(fmt::format("option name '{}' is not kebab-case, or begins with no-", info.name));
  if (find(info.name)) throw InvalidInput(fmt::format("option {} is there already", info.name));
  const std::shared_ptr<void> defaults = make();
  const OptionValue value = entry.get(defaults.get());
  if (!is_allowed(info, value)) refuse(info, value_text(value));
  entries_.push_back(std::move(entry));
}

const OptionSchema::Entry* OptionSchema::find(std::string_view name) const {
  for (const Entry& entry : entries_)
    if (entry.info.name == name) return &entry;
  return nullptr;
}

const OptionSchema::Entry& OptionSchema::at(std::string_view name) const {
  if (const Entry* entry = find(name)) return *entry;
  std::vector<std::string_view> names;
  for (const Entry& entry : entries_) names.push_back(entry.info.name);
  throw InvalidInput(
      fmt::format("unknown option {}; allowed: {}", name,
                  names.empty() ? "none, there are no options" : fmt::format("{}", fmt::join(names, ", "))));
}

void OptionSchema::store(void* options, const Entry& entry, const OptionValue& value) const {
  if (!is_allowed(entry.info, value)) refuse(entry.info, value_text(value));
  entry.set(options, value);
}

void OptionSchema::validate(const void* options) const {
  for (const Entry& entry : entries_) {
    const OptionValue value = entry.get(options);
    if (!is_allowed(entry.info, value)) refuse(entry.info, value_text(value));
  }
}

void OptionSchema::set_json(void* options, std::string_view name, const Json& json) const {
  const Entry& entry = at(name);
  const std::optional<OptionValue> value = parse(entry.info.type, json);
  if (!value) refuse(entry.info, json.dump(-1, ' ', false, Json::error_handler_t::replace));
  store(options, entry, *value);
}

void OptionSchema::set_text(void* options, std::string_view name, std::string_view text) const {
  const Entry& entry = at(name);
  const std::optional<OptionValue> value = parse(entry.info.type, text);
  if (!value) refuse(entry.info, text.empty() ? "\"\"" : text);
  store(options, entry, *value);
}

Json OptionSchema::to_json(const void* options, bool all) const {
  Json object = Json::object();
  const std::shared_ptr<void> defaults = make();
  for (const Entry& entry : entries_) {
    const OptionValue value = entry.get(options);
    if (all || value != entry.get(defaults.get())) object[entry.info.name] = value_json(value);
  }
  return object;
}

std::vector<std::pair<std::string, std::string>> OptionSchema::to_text(const void* options) const {
  std::vector<std::pair<std::string, std::string>> pairs;
  const std::shared_ptr<void> defaults = make();
  for (const Entry& entry : entries_) {
    const OptionValue value = entry.get(options);
    if (value != entry.get(defaults.get())) pairs.emplace_back(entry.info.name, value_text(value));
  }
  return pairs;
}

Json OptionSchema::describe() const {
  Json array = Json::array();
  const std::shared_ptr<void> defaults = make();
  for (const Entry& entry : entries_) {
    const OptionInfo& info = entry.info;
    Json object = {
        {"name", info.name}, {"type", type_name(info.type)}, {"default", value_json(entry.get(defaults.get()))}};
    if (!info.unit.empty()) object["unit"] = info.unit;
    if (info.minimum > -infinity) object[info.minimum_open ? "above" : "minimum"] = info.minimum;
    if (info.maximum < infinity) object[info.maximum_open ? "below" : "maximum"] = info.maximum;
    if (info.infinite) object["infinite"] = true;
    if (!info.choices.empty()) object["choices"] = info.choices;
    object["help"] = info.help;
    array.push_back(std::move(object));
  }
  return array;
}

}  // namespace tri
