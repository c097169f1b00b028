// SPDX-License-Identifier: Apache-2.0
#include "threemf/slicer_names.h"

#include <fmt/format.h>

#include "bytes/scanner.h"
#include "threemf/xml_elements.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

class NameReader : public XmlElements {
 public:
  using XmlElements::XmlElements;

  SlicerNames names;

 private:
  enum class Inside { Object, Part, Volume };

  /// A whole number, or -1.
  static std::int64_t whole(const char* text) {
    std::int64_t number = -1;
    return text && parse_integer(text, number) ? number : -1;
  }

  void begin(std::string_view name, const XmlAttributes& attributes) override {
    if (name == "object") {
      inside_ = Inside::Object;
      object_ = static_cast<std::uint32_t>(whole(attributes.find("id")));
    } else if (name == "part") {
      inside_ = Inside::Part;
      part_ = static_cast<std::uint32_t>(whole(attributes.find("id")));
    } else if (name == "volume") {
      inside_ = Inside::Volume;
      const std::int64_t first = whole(attributes.find("firstid")), last = whole(attributes.find("lastid"));
      if (first < 0 || last < first) fail("the first and the last triangle of a volume", "others");
      of_volume_ = object_;
      names.volumes[of_volume_].push_back(
          {static_cast<std::size_t>(first), static_cast<std::size_t>(last), {}, here()});
    } else if (name == "metadata") {
      take_name(attributes);
    }
  }

  void take_name(const XmlAttributes& attributes) {
    const char *const key = attributes.find("key"), *const value = attributes.find("value");
    if (!key || !value || std::string_view(key) != "name") return;
    if (inside_ == Inside::Object) names.of_object[object_] = value;
    else if (inside_ == Inside::Part) names.of_part[{object_, part_}] = value;
    else names.volumes[of_volume_].back().name = value;
  }

  Inside inside_ = Inside::Object;
  std::uint32_t object_ = 0, part_ = 0, of_volume_ = 0;
};

}  // namespace

SlicerNames read_slicer_names(const std::string& path, const ZipArchive& archive, std::vector<std::string>& remarks) {
  for (const char* const part : {"Metadata/Slic3r_PE_model.config", "Metadata/model_settings.config"}) {
    const ZipEntry* const entry = archive.find(part);
    if (!entry) continue;
    const std::string label = fmt::format("{}: {}", path, part);
    try {
      const std::string text = archive.read(*entry);
      NameReader reader(label, text);
      reader.run();
      reader.names.settings = entry;
      return std::move(reader.names);
    } catch (const InvalidInput& error) {
      // They are another program's, and the mesh does not need them.
      remarks.push_back(fmt::format("names of objects are not known: {}", error.what()));
    }
  }
  return {};
}

}  // namespace vdb_offset::io
