#pragma once

#include <expat.h>

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "meshops/error.hpp"

namespace tri::io_detail {

/// The attributes of an element, by local name.
class XmlAttributes {
 public:
  explicit XmlAttributes(const XML_Char** list) : list_(list) {}
  /// Null without. @param name of an attribute without a namespace, or with any where `any_namespace`
  const char* find(std::string_view name, bool any_namespace = false) const {
    for (const XML_Char** a = list_; *a; a += 2) {
      const std::string_view full(a[0]);
      const std::size_t bar = full.rfind('|');
      if (full == name || (any_namespace && bar != full.npos && full.substr(bar + 1) == name)) return a[1];
    }
    return nullptr;
  }

 private:
  const XML_Char** list_;
};

/// XML that is read as a stream, by expat; document types (and with them entities) are refused.
///
/// Handlers may throw: the parser stops, and the exception leaves `feed`.
class XmlStream {
 public:
  using Start = std::function<void(std::string_view name_space, std::string_view name, const XmlAttributes&)>;
  using End = std::function<void(std::string_view name)>;

  /// @param file,part for messages
  XmlStream(const std::string& file, std::string part, Start start, End end)
      : file_(file), part_(std::move(part)), start_(std::move(start)), end_(std::move(end)),
        parser_(XML_ParserCreateNS(nullptr, '|'), &XML_ParserFree) {
    if (!parser_) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), &XmlStream::started, &XmlStream::ended);
    XML_SetStartDoctypeDeclHandler(parser_.get(), &XmlStream::doctype);
  }

  /// The next piece of the text. @throws IoError with the line
  void feed(std::string_view piece, bool last) {
    if (XML_Parse(parser_.get(), piece.data(), static_cast<int>(piece.size()), last) != XML_STATUS_ERROR) return;
    if (thrown_) std::rethrow_exception(thrown_);
    fail(std::string("is not valid XML: ") + XML_ErrorString(XML_GetErrorCode(parser_.get())));
  }

  /// @throws IoError "FILE: PART, line N: MESSAGE"
  [[noreturn]] void fail(const std::string& message) const {
    throw IoError(file_, part_ + ", line " + std::to_string(XML_GetCurrentLineNumber(parser_.get())) + ": " + message);
  }

 private:
  template <class Work>
  void guarded(const Work& work) {
    if (thrown_) return;
    try {
      work();
    } catch (...) {
      thrown_ = std::current_exception();
      XML_StopParser(parser_.get(), XML_FALSE);
    }
  }
  static void started(void* self, const XML_Char* name, const XML_Char** attributes) {
    auto& stream = *static_cast<XmlStream*>(self);
    stream.guarded([&] {
      const std::string_view full(name);
      const std::size_t bar = full.rfind('|');
      stream.start_(bar == full.npos ? std::string_view() : full.substr(0, bar),
                    bar == full.npos ? full : full.substr(bar + 1), XmlAttributes(attributes));
    });
  }
  static void ended(void* self, const XML_Char* name) {
    auto& stream = *static_cast<XmlStream*>(self);
    stream.guarded([&] {
      const std::string_view full(name);
      const std::size_t bar = full.rfind('|');
      stream.end_(bar == full.npos ? full : full.substr(bar + 1));
    });
  }
  static void doctype(void* self, const XML_Char*, const XML_Char*, const XML_Char*, int) {
    auto& stream = *static_cast<XmlStream*>(self);
    stream.guarded([&] { stream.fail("a document type is not allowed here"); });
  }

  const std::string& file_;
  std::string part_;
  Start start_;
  End end_;
  std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser_;
  std::exception_ptr thrown_;
};

}  // namespace tri::io_detail
