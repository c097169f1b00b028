// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <exception>
#include <memory>
#include <string>
#include <string_view>

struct XML_ParserStruct;

namespace vdb_offset::io {

/// An attribute's value by its name; names of another namespace than the element's are `URI|name`.
class XmlAttributes {
 public:
  explicit XmlAttributes(const char** pairs) : pairs_(pairs) {}
  /// Null if there is none of that name.
  const char* find(std::string_view name) const {
    for (const char** pair = pairs_; *pair; pair += 2)
      if (name == *pair) return pair[1];
    return nullptr;
  }
  const char** pairs() const { return pairs_; }

 private:
  const char** pairs_;
};

/// Reads a part of a package by expat, element by element. Neither a document type nor anything that it could declare
/// is accepted: 3MF forbids it (core specification, 2.3.3).
class XmlElements {
 public:
  /// `label` begins messages. Keeps references to both.
  XmlElements(const std::string& label, std::string_view text);
  XmlElements(const XmlElements&) = delete;
  XmlElements& operator=(const XmlElements&) = delete;

  /// \throw InvalidInput for what is not XML in UTF-8, and what begin() and end() throw
  void run();

 protected:
  virtual ~XmlElements() = default;
  /// An element's name is `URI|name`, or its name alone if it has no namespace.
  virtual void begin(std::string_view name, const XmlAttributes& attributes) = 0;
  virtual void end() {}

  /// First byte of the tag that is read.
  std::size_t here() const;
  /// No more is to be read.
  void stop();
  [[noreturn]] void fail_at(std::size_t at, const std::string& expected, const std::string& found) const;
  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    fail_at(here(), expected, found);
  }
  /// The value of an attribute that must be there.
  const char* required(const XmlAttributes& attributes, std::string_view name) const;
  const std::string& label() const { return label_; }

 private:
  template <class Do>
  void guarded(Do&& act);
  void open(const char* name, const char** attributes);

  const std::string& label_;
  std::string_view text_;
  std::unique_ptr<XML_ParserStruct, void (*)(XML_ParserStruct*)> parser_;
  std::exception_ptr thrown_;
  std::size_t depth_ = 0;
  bool stopped_ = false;
};

}  // namespace vdb_offset::io
