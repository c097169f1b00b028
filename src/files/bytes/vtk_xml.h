// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bytes/chunked_output.h"

namespace vdb_offset::io {

/// An array of numbers that is made item by item, each of which takes as many bytes.
struct VtkArray {
  std::string name;
  const char* type;  ///< As in "Float64".
  int components;
  std::size_t item_bytes;
  Section section;
};

/// Numbers that are there already, as an array. They outlive it.
VtkArray array_of(std::string name, int components, std::span<const float> numbers);
VtkArray array_of(std::string name, int components, std::span<const double> numbers);
VtkArray array_of(std::string name, int components, std::span<const std::uint8_t> numbers);
VtkArray array_of(std::string name, int components, std::span<const std::uint32_t> numbers);

/// A file of VTK's XML (VTK File Formats, "XML File Formats"): a text, and behind it the arrays, appended raw. This is
/// simple enough that it needs no VTK.
class VtkXml {
 public:
  /// \param dataset as "PolyData"; \param attributes of its element, with a blank before each
  explicit VtkXml(std::string dataset, const std::string& attributes = "");

  void add_text(const std::string& text) { text_ += text; }
  void add(VtkArray array);
  /// Words as VTK has them, in the text: the codes of their bytes, with a 0 behind each.
  void add_words(const std::string& name, std::span<const std::string> words);

  /// The file, with its arrays as they are.
  Pieces raw() &&;
  /// Writes the file with its arrays compressed by zlib, block by block, several at a time. `path` is for messages.
  /// \throw WriteError
  void write_packed(const std::string& temporary, const std::string& path) &&;

 private:
  std::string dataset_, text_;
  std::vector<std::size_t> offset_at_;  // where in the text each array's offset belongs
  std::vector<VtkArray> arrays_;
};

}  // namespace vdb_offset::io
