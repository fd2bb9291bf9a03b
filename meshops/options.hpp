#pragma once

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace tri {

/// JSON with its keys in the order in which they were written.
using Json = nlohmann::ordered_json;

/// The value of one option, in the unit that its schema states (so an angle is in degrees here, radians in the struct).
using OptionValue = std::variant<bool, std::int64_t, double, std::string, std::vector<double>>;

/// One option as the command line, JSON, `tri ops` and an editor's sliders see it.
struct OptionInfo {
  /// What values it takes: `choice` one of `choices`, `text` any, `numbers` a list of numbers.
  enum class Type { boolean, integer, number, choice, text, numbers };

  std::string name;           ///< kebab-case: "max-edges" is `--max-edges` and "max-edges"
  Type type = Type::boolean;  ///< what values it takes
  std::string unit;           ///< "mm", "deg", "edges"; empty for a bare number
  std::string help;           ///< one line without a full stop
  /// Least value of an integer, a number or each entry of a list, in `unit`; belongs to the range unless
  /// `minimum_open`.
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();  ///< greatest value, likewise
  bool minimum_open = false;                                 ///< values must be above `minimum`
  bool maximum_open = false;                                 ///< values must be below `maximum`
  bool infinite = false;                                     ///< "inf" is allowed and means no limit
  std::vector<std::string> choices;                          ///< of a choice

  /// What is allowed, for messages: "a whole number from 3 to 100 (edges)".
  std::string allowed() const;
};

/// What an option needs besides its name and its field; the members are those of `OptionInfo`.
struct OptionSpec {
  std::string_view unit = "";                             ///< as `OptionInfo::unit`
  double min = -std::numeric_limits<double>::infinity();  ///< `OptionInfo::minimum`
  double max = std::numeric_limits<double>::infinity();   ///< `OptionInfo::maximum`
  bool min_open = false;                                  ///< `OptionInfo::minimum_open`
  bool max_open = false;                                  ///< `OptionInfo::maximum_open`
  bool infinite = false;                                  ///< `OptionInfo::infinite`
  std::string_view help = "";                             ///< one line without a full stop
};

/// The options of one struct, without its type. Made by `Schema`.
///
/// `options` pointers below point to an object of that struct. A member of the struct that is in no schema (a pointer
/// to a reference surface, say) can be set from C++ only.
class OptionSchema {
 public:
  /// An option and how it is read from and written to an object of the options struct.
  struct Entry {
    OptionInfo info;                                                   ///< name, type, unit and range
    std::function<OptionValue(const void* options)> get;               ///< the value in the unit of `info`
    std::function<void(void* options, const OptionValue& value)> set;  ///< the value was checked
  };

  /// In the order in which the schema names them.
  const std::vector<Entry>& entries() const { return entries_; }
  /// Nullptr if there is no such option.
  const Entry* find(std::string_view name) const;

  /// A default-constructed struct.
  std::shared_ptr<void> make() const { return make_(); }

  /// @throws InvalidInput naming key, value and what is allowed, if an option is out of its range.
  void validate(const void* options) const;

  /// Sets one option from a JSON value ("inf" stands for infinity).
  /// @throws InvalidInput if the key is unknown or the value is not allowed; then `options` is untouched.
  void set_json(void* options, std::string_view name, const Json& value) const;
  /// The same from text as on the command line: "true", "12.5", "inf", "1,2,3".
  void set_text(void* options, std::string_view name, std::string_view text) const;

  /// An object with the options that differ from their defaults (or all of them). Reading it back gives the same
  /// options.
  Json to_json(const void* options, bool all = false) const;
  /// (name, text) of the options that differ from their defaults, in schema order.
  std::vector<std::pair<std::string, std::string>> to_text(const void* options) const;

  /// An array with one object per option: name, type, unit, help, minimum, maximum, choices, default.
  Json describe() const;

 protected:
  /// Appends an option. @throws InvalidInput if its name is not kebab-case or taken, or the default is out of range
  void add(Entry entry);

  std::vector<Entry> entries_;                   ///< in the order of the schema
  std::function<std::shared_ptr<void>()> make_;  ///< makes a struct with default values

 private:
  const Entry& at(std::string_view name) const;
  void store(void* options, const Entry& entry, const OptionValue& value) const;
};

/// Degrees of an angle in radians: the shortest decimal that `to_radians` takes back to the same angle.
double to_degrees(double radians);
/// The angle in radians of one in degrees.
double to_radians(double degrees);

/// Writes the schema of an options struct, in the struct's own files:
///
///     struct FillHolesOptions {
///       int max_edges = 100;  ///< loops with more edges stay open
///       static const OptionSchema& schema();
///     };
///
///     const OptionSchema& FillHolesOptions::schema() {
///       using O = FillHolesOptions;
///       static const OptionSchema schema = Schema<O>().integer(
///           "max-edges", &O::max_edges, {.unit = "edges", .min = 3, .help = "loops with more edges stay open"});
///       return schema;
///     }
///
/// Each member throws InvalidInput if the name is not kebab-case or taken, or the default is out of range.
template <class O>
class Schema : public OptionSchema {
 public:
  /// An empty schema; the options are appended by the members below.
  Schema() {
    make_ = [] { return std::static_pointer_cast<void>(std::make_shared<O>()); };
  }

  /// `--name` sets true, `--no-name` false.
  Schema& boolean(std::string_view name, bool O::*field, const OptionSpec& spec) {
    return with<bool>(name, OptionInfo::Type::boolean, field, spec);
  }

  /// A whole number; the range is that of T unless `spec` narrows it.
  template <std::integral T>
  Schema& integer(std::string_view name, T O::*field, OptionSpec spec) {
    spec.min = std::max(spec.min, static_cast<double>(std::numeric_limits<T>::min()));
    spec.max = std::min(spec.max, static_cast<double>(std::numeric_limits<T>::max()));
    return with<std::int64_t>(name, OptionInfo::Type::integer, field, spec);
  }

  /// A number that is not NaN; infinite only if `spec.infinite`.
  Schema& number(std::string_view name, double O::*field, const OptionSpec& spec) {
    return with<double>(name, OptionInfo::Type::number, field, spec);
  }

  /// Radians in the struct, degrees everywhere else; the bounds are in degrees.
  Schema& angle(std::string_view name, double O::*field, OptionSpec spec) {
    spec.unit = "deg";
    return entry(
        name, OptionInfo::Type::number, spec, {},
        [field](const void* o) -> OptionValue { return to_degrees(static_cast<const O*>(o)->*field); },
        [field](void* o, const OptionValue& v) { static_cast<O*>(o)->*field = to_radians(std::get<double>(v)); });
  }

  /// One of several texts, each of which stands for a value of E. @param choices  (text, value), in the order of the
  /// help
  template <class E>
  Schema& choice(std::string_view name, E O::*field, std::initializer_list<std::pair<const char*, E>> choices,
                 const OptionSpec& spec) {
    std::vector<std::string> names;
    std::vector<E> values;
    for (const auto& [text, value] : choices) {
      names.emplace_back(text);
      values.push_back(value);
    }
    return entry(
        name, OptionInfo::Type::choice, spec, names,
        [field, names, values](const void* o) -> OptionValue {
          for (std::size_t i = 0; i < values.size(); ++i)
            if (values[i] == static_cast<const O*>(o)->*field) return names[i];
          return std::string();
        },
        [field, names, values](void* o, const OptionValue& v) {
          for (std::size_t i = 0; i < names.size(); ++i)
            if (names[i] == std::get<std::string>(v)) static_cast<O*>(o)->*field = values[i];
        });
  }

  /// Any text, say the name of a property.
  Schema& text(std::string_view name, std::string O::*field, const OptionSpec& spec) {
    return with<std::string>(name, OptionInfo::Type::text, field, spec);
  }

  /// Comma-separated on the command line, an array in JSON.
  Schema& numbers(std::string_view name, std::vector<double> O::*field, const OptionSpec& spec) {
    return with<std::vector<double>>(name, OptionInfo::Type::numbers, field, spec);
  }

 private:
  template <class V, class T>
  Schema& with(std::string_view name, OptionInfo::Type type, T O::*field, const OptionSpec& spec) {
    return entry(
        name, type, spec, {}, [field](const void* o) -> OptionValue { return V(static_cast<const O*>(o)->*field); },
        [field](void* o, const OptionValue& v) { static_cast<O*>(o)->*field = static_cast<T>(std::get<V>(v)); });
  }

  Schema& entry(std::string_view name, OptionInfo::Type type, const OptionSpec& spec, std::vector<std::string> choices,
                std::function<OptionValue(const void*)> get, std::function<void(void*, const OptionValue&)> set) {
    add({{std::string(name), type, std::string(spec.unit), std::string(spec.help), spec.min, spec.max, spec.min_open,
          spec.max_open, spec.infinite, std::move(choices)},
         std::move(get),
         std::move(set)});
    return *this;
  }
};

/// The first line of every operator.
/// @throws InvalidInput if an option is out of its range.
template <class O>
void validate(const O& options) {
  O::schema().validate(&options);
}

}  // namespace tri
