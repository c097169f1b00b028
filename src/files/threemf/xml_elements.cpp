// SPDX-License-Identifier: Apache-2.0
#include "threemf/xml_elements.h"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "bytes/scanner.h"

namespace vdb_offset::io {
namespace {

// What expat puts between the namespace of an element and its name.
constexpr char kUriEnd = '|';
// Elements inside each other; those of 3MF are far fewer. Each takes memory of expat's.
constexpr std::size_t kMostDepth = 64;

}  // namespace

XmlElements::XmlElements(const std::string& label, std::string_view text)
    : label_(label), text_(text), parser_(XML_ParserCreateNS(nullptr, kUriEnd), &XML_ParserFree) {
  if (!parser_) throw std::bad_alloc();
  XML_SetUserData(parser_.get(), this);
  XML_SetElementHandler(
      parser_.get(),
      [](void* self, const char* name, const char** attributes) {
        static_cast<XmlElements*>(self)->guarded([&](XmlElements& elements) { elements.open(name, attributes); });
      },
      [](void* self, const char*) {
        static_cast<XmlElements*>(self)->guarded([](XmlElements& elements) {
          --elements.depth_;
          elements.end();
        });
      });
  XML_SetStartDoctypeDeclHandler(parser_.get(), [](void* self, const char* name, const char*, const char*, int) {
    static_cast<XmlElements*>(self)->guarded([&](XmlElements& elements) {
      elements.fail("XML without a document type", fmt::format("'{}'", in_short(name)));
    });
  });
}

/// Calls act() and keeps what it throws: no exception may pass through expat, which is C.
template <class Do>
void XmlElements::guarded(Do&& act) {
  if (thrown_ || stopped_) return;
  try {
    act(*this);
  } catch (...) {
    thrown_ = std::current_exception();
    XML_StopParser(parser_.get(), XML_FALSE);
  }
}

void XmlElements::open(const char* name, const char** attributes) {
  if (++depth_ > kMostDepth) fail(fmt::format("elements at most {} deep", kMostDepth), "deeper ones");
  begin(name, XmlAttributes(attributes));
}

void XmlElements::run() {
  for (const char* const mark : {"\xff\xfe", "\xfe\xff"})
    if (text_.starts_with(mark)) fail_at(0, "XML in UTF-8", "UTF-16");
  constexpr std::size_t kAtOnce = 1 << 26;  // bytes that expat gets at a time: it counts them in an int
  for (std::size_t at = 0; at < text_.size() || at == 0; at += kAtOnce) {
    const std::string_view chunk = text_.substr(at, kAtOnce);
    const bool is_last = at + kAtOnce >= text_.size();
    if (XML_Parse(parser_.get(), chunk.data(), static_cast<int>(chunk.size()), is_last) == XML_STATUS_OK) continue;
    if (thrown_) std::rethrow_exception(thrown_);
    if (stopped_) return;
    fail("XML", fmt::format("'{}'", XML_ErrorString(XML_GetErrorCode(parser_.get()))));
  }
}

std::size_t XmlElements::here() const { return static_cast<std::size_t>(XML_GetCurrentByteIndex(parser_.get())); }

void XmlElements::stop() {
  stopped_ = true;
  XML_StopParser(parser_.get(), XML_FALSE);
}

void XmlElements::fail_at(std::size_t at, const std::string& expected, const std::string& found) const {
  Scanner(label_, text_).fail_with(expected, found, std::min(at, text_.size()));
}

const char* XmlElements::required(const XmlAttributes& attributes, std::string_view name) const {
  const char* const value = attributes.find(name);
  if (!value) fail(fmt::format("an attribute '{}'", name), "none");
  return value;
}

}  // namespace vdb_offset::io
