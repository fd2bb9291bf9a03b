#include "io/mesh_formats/gltf_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "io/mesh_formats/base64.hpp"
#include "io/mesh_formats/placement.hpp"
#include "io/text_scanner.hpp"

namespace tri::io_detail {
namespace {

// A value of the parsed JSON takes some 100 bytes, "0," takes two: files that hold nothing but those are refused. A
// mesh of any size needs few values, for its numbers are in buffers.
constexpr std::size_t most_values = 2'000'000;
constexpr int deepest = 200;

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

std::size_t size_of_component(std::uint64_t type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

template <class Value>
double component_value(const char* at) {
  Value value;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

double component(const char* at, std::uint64_t type, bool normalized) {
  switch (type) {
    case 5120:
      return normalized ? std::max(component_value<std::int8_t>(at) / 127, -1.0) : component_value<std::int8_t>(at);
    case 5121:
      return component_value<std::uint8_t>(at) / (normalized ? 255 : 1);
    case 5122:
      return normalized ? std::max(component_value<std::int16_t>(at) / 32767, -1.0) : component_value<std::int16_t>(at);
    case 5123:
      return component_value<std::uint16_t>(at) / (normalized ? 65535 : 1);
    case 5125:
      return component_value<std::uint32_t>(at);
    default:
      return component_value<float>(at);
  }
}

/// "%20" becomes a blank and so on.
std::string without_escapes(const std::string& uri) {
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned value = 0;
    if (uri[i] == '%' && i + 2 < uri.size() &&
        std::from_chars(uri.data() + i + 1, uri.data() + i + 3, value, 16).ptr == uri.data() + i + 3) {
      path += static_cast<char>(value);
      i += 2;
    } else {
      path += uri[i];
    }
  }
  return path;
}

}  // namespace

GltfDocument::GltfDocument(std::string_view bytes, const std::string& file, MeshFileInfo& info)
    : file_(file), size_(bytes.size()) {
  info.encoding = bytes.starts_with("glTF") ? MeshEncoding::binary_little_endian : MeshEncoding::ascii;
  if (bytes.starts_with("glTF"))
    split_binary(bytes);
  else
    parse_json(bytes, 0);
  if (!root_.is_object() || !root_.contains("asset")) fail("the file", "is JSON, but not glTF: there is no asset");
  const std::string version = text(root_.at("asset"), "version");
  if (!version.starts_with("2.")) fail("asset.version", "is " + io_detail::quoted(version) + ": only glTF 2 is read");
  for (const Json& extension : list(root_, "extensionsRequired", "the file")) {
    const std::string name = extension.is_string() ? extension.get<std::string>() : "";
    if (name.find("compression") != name.npos)
      fail("extensionsRequired", io_detail::quoted(name) + " is not supported: the mesh is compressed");
  }
  buffers_.resize(list(root_, "buffers", "the file").size());
}

void GltfDocument::fail(const std::string& where, const std::string& message) const {
  throw IoError(file_, where + ": " + message);
}

void GltfDocument::split_binary(std::string_view bytes) {
  const auto refuse = [this](const std::string& message, std::size_t at) {
    throw IoError(file_, message, IoError::Unit::byte, at);
  };
  if (bytes.size() < 20) refuse("truncated: not as long as the header of a GLB file", bytes.size());
  if (word_at(bytes, 4) != 2)
    refuse(fmt::format("a GLB file of version {}: only version 2 is read", word_at(bytes, 4)), 4);
  if (word_at(bytes, 8) > bytes.size())
    refuse(fmt::format("truncated: the header says {} bytes", word_at(bytes, 8)), bytes.size());
  bytes = bytes.substr(0, word_at(bytes, 8));
  std::size_t at = 12;
  for (bool first = true; at + 8 <= bytes.size(); first = false) {
    const std::uint32_t length = word_at(bytes, at), type = word_at(bytes, at + 4);
    if (length > bytes.size() - at - 8) refuse(fmt::format("truncated: a chunk of {} bytes", length), at);
    const std::string_view chunk = bytes.substr(at + 8, length);
    if (first != (type == 0x4E4F534A)) refuse("the first chunk of a GLB file, and no other, is JSON", at + 4);
    if (first) {
      parse_json(chunk, at + 8);
    } else if (type == 0x004E4942 && !has_chunk_) {
      chunk_ = chunk;
      has_chunk_ = true;
    }
    at += 8 + std::size_t{length};
  }
  if (root_.is_null()) refuse("a GLB file without JSON", at);
}

void GltfDocument::parse_json(std::string_view text, std::size_t offset) {
  std::size_t values = 0;
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      for (++i; i < text.size() && text[i] != '"'; ++i) i += text[i] == '\\';
      continue;
    }
    depth += (c == '[' || c == '{') - (c == ']' || c == '}');
    values += c == ',' || c == '[' || c == '{';
    if (depth > deepest || values > most_values)
      throw IoError(file_,
                    depth > deepest ? fmt::format("JSON nested deeper than {}", deepest)
                                    : fmt::format("JSON of more than {} values", most_values),
                    IoError::Unit::byte, offset + i);
  }
  try {
    root_ = Json::parse(text);
  } catch (const Json::exception& error) {
    const auto* parse = dynamic_cast<const Json::parse_error*>(&error);
    const std::string what = error.what();
    throw IoError(file_, "is not valid JSON: " + what.substr(std::min(what.find("] ") + 2, what.size())),
                  IoError::Unit::byte, offset + (parse && parse->byte > 0 ? parse->byte - 1 : 0));
  }
}

const GltfDocument::Json& GltfDocument::element(const char* list_name, std::uint64_t index,
                                                const std::string& from) const {
  const Json& all = list(root_, list_name, "the file");
  if (index >= all.size()) fail(from, fmt::format("names {} {}, of which there are {}", list_name, index, all.size()));
  const Json& found = all[index];
  if (!found.is_object()) fail(fmt::format("{}[{}]", list_name, index), "is no object");
  return found;
}

std::uint64_t GltfDocument::integer(const Json& object, const char* name, const std::string& where,
                                    std::uint64_t otherwise) const {
  const auto found = object.find(name);
  if (found == object.end()) return otherwise;
  const double value = found->is_number() ? found->get<double>() : -1;
  if (!(value >= 0 && value <= 9007199254740992.0) || value != std::floor(value))
    fail(where + "." + name, "is " + io_detail::quoted(found->dump(-1, ' ', false, Json::error_handler_t::replace)) +
                                 ", not an integer from 0");
  return static_cast<std::uint64_t>(value);
}

std::uint64_t GltfDocument::integer(const Json& object, const char* name, const std::string& where) const {
  if (!object.contains(name)) fail(where, std::string("has no ") + name);
  return integer(object, name, where, 0);
}

std::vector<double> GltfDocument::numbers(const Json& object, const char* name, std::size_t size,
                                          const std::string& where) const {
  const Json& values = list(object, name, where);
  std::vector<double> result;
  for (const Json& value : values) {
    const double number = value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
    if (!std::isfinite(number)) fail(where + "." + name, "holds what is no finite number");
    result.push_back(number);
  }
  if (object.contains(name) && result.size() != size)
    fail(where + "." + name, fmt::format("has {} numbers, not {}", result.size(), size));
  return result;
}

const GltfDocument::Json& GltfDocument::list(const Json& object, const char* name, const std::string& where) const {
  static const Json none = Json::array();
  const auto found = object.find(name);
  if (found == object.end()) return none;
  if (!found->is_array()) fail(where + "." + name, "is no list");
  return *found;
}

std::string GltfDocument::text(const Json& object, const char* name) {
  if (!object.is_object()) return "";
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

std::string_view GltfDocument::external(const std::string& uri, const std::string& where) {
  const std::filesystem::path relative(without_escapes(uri));
  const bool within = std::find(relative.begin(), relative.end(), "..") == relative.end();
  if (relative.is_absolute() || !within || uri.find("://") != uri.npos)
    fail(where, io_detail::quoted(uri) + " is not opened: only files beside this one or in folders below are");
  const std::string path = (std::filesystem::path(file_).parent_path() / relative).string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) fail(where, "there is no file " + io_detail::quoted(path));
  files_.push_back(std::make_unique<InputFile>(path));
  return files_.back()->bytes();
}

std::string_view GltfDocument::buffer(std::uint64_t index, const std::string& from) {
  const Json& object = element("buffers", index, from);
  const std::string where = fmt::format("buffers[{}]", index);
  if (buffers_[index].data()) return buffers_[index];
  const std::uint64_t length = integer(object, "byteLength", where);
  const auto uri = object.find("uri");
  std::string_view bytes;
  if (uri == object.end()) {
    if (!has_chunk_ || index != 0) fail(where, "has no uri, and the file no binary chunk for it");
    bytes = chunk_;
  } else if (!uri->is_string()) {
    fail(where + ".uri", "is no text");
  } else if (const auto& whole = uri->get_ref<const std::string&>(); whole.starts_with("data:")) {
    const std::size_t comma = whole.find(',');
    if (comma == whole.npos || !std::string_view(whole).substr(0, comma).ends_with(";base64"))
      fail(where + ".uri", "holds data, but not in base 64");
    auto decoded = from_base64(std::string_view(whole).substr(comma + 1));
    if (!decoded) fail(where + ".uri", "is not valid base 64");
    decoded_.push_back(std::make_unique<std::string>(std::move(*decoded)));
    bytes = *decoded_.back();
  } else {
    bytes = external(whole, where + ".uri");
  }
  if (length > bytes.size() || length == 0)
    fail(where, fmt::format("has {} of the {} bytes it should have", bytes.size(), length));
  return buffers_[index] = bytes.substr(0, length);
}

GltfDocument::View GltfDocument::view(std::uint64_t index, const std::string& from) {
  const Json& object = element("bufferViews", index, from);
  const std::string where = fmt::format("bufferViews[{}]", index);
  const std::string_view bytes = buffer(integer(object, "buffer", where), where);
  const std::uint64_t offset = integer(object, "byteOffset", where, 0), length = integer(object, "byteLength", where);
  if (offset > bytes.size() || length > bytes.size() - offset)
    fail(where, fmt::format("bytes {} to {} of a buffer of {}", offset, offset + length, bytes.size()));
  return {bytes.substr(offset, length), integer(object, "byteStride", where, 0)};
}

void GltfDocument::decode(const View& view, std::uint64_t offset, std::uint64_t count, std::uint64_t type,
                          std::size_t components, bool normalized, std::vector<double>& out,
                          const std::string& where) const {
  const std::size_t size = size_of_component(type), element_size = size * components;
  const std::uint64_t stride = view.stride ? view.stride : element_size;
  if (stride < element_size) fail(where, fmt::format("elements of {} bytes every {} bytes", element_size, stride));
  const std::uint64_t room = offset > view.bytes.size() ? 0 : view.bytes.size() - offset;
  if (count > 0 && (room < element_size || count - 1 > (room - element_size) / stride))
    fail(where, fmt::format("{} elements do not fit the {} bytes of their view", count, room));
  out.reserve(out.size() + count * components);
  for (std::uint64_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < components; ++k)
      out.push_back(component(view.bytes.data() + offset + i * stride + k * size, type, normalized));
}

GltfValues GltfDocument::accessor(std::uint64_t index, std::size_t least, std::size_t most, const std::string& from) {
  const Json& object = element("accessors", index, from);
  const std::string where = fmt::format("accessors[{}]", index);
  static constexpr const char* types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  const std::string shape = text(object, "type");
  GltfValues result;
  result.components =
      static_cast<std::size_t>(std::find(std::begin(types), std::end(types), shape) - std::begin(types)) + 1;
  if (result.components < least || result.components > most)
    fail(where + ".type", io_detail::quoted(shape) + " does not fit " + from);
  const std::uint64_t type = integer(object, "componentType", where), count = integer(object, "count", where);
  if (size_of_component(type) == 0) fail(where + ".componentType", fmt::format("{} is unknown", type));
  const auto flag = object.find("normalized");
  const bool normalized = flag != object.end() && flag->is_boolean() && flag->get<bool>();
  result.count = count;
  if (object.contains("bufferView")) {
    const View source = view(integer(object, "bufferView", where), where);
    decode(source, integer(object, "byteOffset", where, 0), count, type, result.components, normalized, result.values,
           where);
  } else {
    if (count > instance_budget(size_))
      fail(where + ".count", fmt::format("{} zeros are absurd for a file of {} bytes", count, size_));
    result.values.resize(count * result.components, 0);
  }
  if (!object.contains("sparse")) return result;
  const std::string inner = where + ".sparse";
  const Json& sparse = object.at("sparse");
  if (!sparse.is_object() || !sparse.contains("indices") || !sparse.contains("values") ||
      !sparse.at("indices").is_object() || !sparse.at("values").is_object())
    fail(inner, "needs indices and values");
  const Json &places = sparse.at("indices"), &news = sparse.at("values");
  const std::uint64_t changed = integer(sparse, "count", inner),
                      place_type = integer(places, "componentType", inner + ".indices");
  if (place_type != 5121 && place_type != 5123 && place_type != 5125)
    fail(inner + ".indices.componentType", fmt::format("{} is no type of indices", place_type));
  std::vector<double> place, value;
  decode(view(integer(places, "bufferView", inner + ".indices"), inner), integer(places, "byteOffset", inner, 0),
         changed, place_type, 1, false, place, inner + ".indices");
  decode(view(integer(news, "bufferView", inner + ".values"), inner), integer(news, "byteOffset", inner, 0), changed,
         type, result.components, normalized, value, inner + ".values");
  for (std::size_t i = 0; i < changed; ++i) {
    if (!(place[i] < static_cast<double>(count))) fail(inner, fmt::format("index {} of {} elements", place[i], count));
    std::copy_n(
        value.begin() + static_cast<std::ptrdiff_t>(i * result.components), result.components,
        result.values.begin() + static_cast<std::ptrdiff_t>(place[i]) * static_cast<std::ptrdiff_t>(result.components));
  }
  return result;
}

}  // namespace tri::io_detail
