// SPDX-License-Identifier: Apache-2.0
// Reads the accessors of a glTF file, and makes sure that all of their elements lie within their buffers. Type, width,
// count, offsets and stride are taken from the JSON and bounded so that no sum overflows; sparse and compressed
// accessors are refused. Whole numbers that are normalized become shares from 0 or -1 to 1. require_apart() sorts the
// byte ranges of all accessors, sparse parts and images, and sweeps over them: no element that is to be rewritten may
// share a byte with anything else, but elements of one stride may lie in each other's gaps. An accessor that nothing
// rewrites and that cannot be read is passed over there. Values are not looked at: whether positions are finite is
// checked elsewhere.
#include "gltf/accessors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "vdb_offset/run.h"

namespace vdb_offset::io::gltf {
namespace {

constexpr std::uint64_t kMostCount = std::numeric_limits<std::uint32_t>::max() - 2;
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 53;  // as JSON's numbers are exact
constexpr std::uint64_t kMostStride = 1 << 20;                // far more than the 252 that the format allows

std::uint64_t bytes_of(Component component) {
  switch (component) {
    case Component::I8:
    case Component::U8:
      return 1;
    case Component::I16:
    case Component::U16:
      return 2;
    default:
      return 4;
  }
}

Component component_of(const JsonValue& accessor) {
  const JsonValue type = accessor.at("componentType");
  const std::uint64_t number = type.whole(65535);
  if (number < 5120 || number > 5126 || number == 5124) type.fail("5120 to 5123, 5125 or 5126");
  return static_cast<Component>(number);
}

struct Shape {
  const char* name;
  std::uint32_t width;
};
constexpr Shape kShapes[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                             {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};

std::uint32_t width_of(const JsonValue& accessor) {
  const JsonValue type = accessor.at("type");
  for (const Shape& shape : kShapes)
    if (type.text() == shape.name) return shape.width;
  type.fail("SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
}

std::uint64_t whole_or(const JsonValue& object, const char* key, std::uint64_t otherwise, std::uint64_t most) {
  const std::optional<JsonValue> found = object.find(key);
  return found ? found->whole(most) : otherwise;
}

}  // namespace

std::uint64_t Accessor::element_bytes() const { return bytes_of(component) * width; }

std::uint32_t Accessor::whole(std::uint64_t i, std::uint32_t k) const {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at(i) + k * bytes_of(component), bytes_of(component));
  return value;
}

double Accessor::number(std::uint64_t i, std::uint32_t k) const {
  if (component == Component::Float) return single(i, k);
  double value = whole(i, k), most = std::exp2(8.0 * static_cast<double>(bytes_of(component))) - 1;
  if (component == Component::I8 || component == Component::I16) {
    const double range = most + 1;
    if (value >= range / 2) value -= range;
    most = range / 2 - 1;
  }
  return normalized ? std::max(value / most, -1.0) : value;
}

Accessors::Accessors(const JsonValue& root, std::span<const Buffer> buffers)
    : list_(root, "accessors"), views_(root, "bufferViews"), root_(root), buffers_(buffers) {}

Accessor Accessors::read(std::size_t index) const {
  const JsonValue value = list_[index];
  if (is_sparse(index))
    value.at("sparse").fail("an accessor that is not sparse", "a sparse one, which is not supported");
  Accessor accessor;
  accessor.index = index;
  accessor.component = component_of(value);
  accessor.width = width_of(value);
  const std::optional<JsonValue> is_normalized = value.find("normalized");
  accessor.normalized = is_normalized && is_normalized->is_true();
  const JsonValue count = value.at("count");
  accessor.count = count.whole(kMostCount);
  if (accessor.count == 0) count.fail("at least 1");
  const JsonValue view = views_.at(value.at("bufferView"));
  if (const auto extensions = view.find("extensions"))
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
      if (extensions->find(name)) extensions->at(name).fail("plain data", "compressed ones, which are not supported");
  const JsonValue buffer = view.at("buffer");
  accessor.buffer = buffer.whole(buffers_.empty() ? 0 : buffers_.size() - 1);
  if (buffers_.empty()) buffer.fail("a file with \"buffers\"", "none");
  accessor.bytes = buffers_[accessor.buffer].bytes;
  const std::uint64_t offset = whole_or(view, "byteOffset", 0, kMostBytes),
                      length = view.at("byteLength").whole(kMostBytes);
  if (offset + length > accessor.bytes.size())
    view.fail(fmt::format("a view that ends at byte {} of the buffer at most", accessor.bytes.size()),
              fmt::format("one to byte {}", offset + length));
  const std::uint64_t element = accessor.element_bytes();
  accessor.stride = whole_or(view, "byteStride", element, kMostStride);
  if (accessor.stride == 0) accessor.stride = element;  // as some programs write, for none
  if (accessor.stride < element) view.at("byteStride").fail(fmt::format("at least {}, an element's bytes", element));
  const std::uint64_t first = whole_or(value, "byteOffset", 0, kMostBytes);
  // With at most 2^32 elements, 2^20 bytes apart, nothing overflows.
  if (const std::uint64_t end = first + (accessor.count - 1) * accessor.stride + element; end > length)
    count.fail(fmt::format("elements that fit into {} bytes of {}", length, view.where()),
               fmt::format("{}, which take {}", accessor.count, end));
  accessor.begin = offset + first;
  return accessor;
}

Accessor Accessors::read_floats(std::size_t index, const char* what, std::uint32_t width) const {
  const Accessor accessor = read(index);
  if (accessor.component != Component::Float || accessor.width != width)
    list_[index].fail(fmt::format("a {} of floats, VEC{}", what, width), "other numbers");
  return accessor;
}

std::optional<Accessor> Accessors::read_if_can(std::size_t index) const {
  try {
    return read(index);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

/// Elements of an accessor, or a view of something else, in a buffer.
struct Accessors::Range {
  std::size_t buffer;
  std::uint64_t begin, end;
  std::uint64_t stride, element;
  std::size_t accessor;  ///< kNone: a view.
  bool is_rewritten;

  bool is_apart(const Range& other) const {
    if (end <= other.begin || other.end <= begin) return true;
    if (stride != other.stride) return false;
    // Interleaved: the elements of one lie in the gaps of the other.
    const std::uint64_t ahead = (other.begin + stride - begin % stride) % stride;
    return ahead >= element && ahead + other.element <= stride;
  }
};

void Accessors::add_sparse_views(std::size_t index, std::vector<Range>& ranges) const {
  for (const char* part : {"indices", "values"}) {
    const std::optional<JsonValue> list = list_[index].at("sparse").find(part);
    const std::optional<JsonValue> view = list ? list->find("bufferView") : std::nullopt;
    if (!view) continue;
    const JsonValue of = views_.at(*view);
    const std::uint64_t begin = whole_or(of, "byteOffset", 0, kMostBytes), size = of.at("byteLength").whole(kMostBytes);
    ranges.push_back({of.at("buffer").whole(kMostBytes), begin, begin + size, size + 1, size, kNone, false});
  }
}

std::vector<Accessors::Range> Accessors::all_ranges(const std::vector<Accessor>& rewritten) const {
  std::vector<std::uint8_t> is_rewritten(size(), 0);
  std::vector<Range> ranges;
  const auto add = [&](const Accessor& a, bool rewrites) {
    ranges.push_back(
        {a.buffer, a.begin, a.at(a.count - 1) + a.element_bytes(), a.stride, a.element_bytes(), a.index, rewrites});
  };
  for (const Accessor& accessor : rewritten) {
    add(accessor, true);
    is_rewritten[accessor.index] = 1;
  }
  for (std::size_t i = 0; i < size(); ++i) {
    if (is_rewritten[i]) continue;
    if (is_sparse(i)) add_sparse_views(i, ranges);
    else if (const auto accessor = read_if_can(i)) add(*accessor, false);
  }
  const JsonList images(root_, "images");
  for (std::size_t i = 0; i < images.size(); ++i)
    if (const auto view = images[i].find("bufferView")) {
      const JsonValue of = views_.at(*view);
      const std::uint64_t begin = whole_or(of, "byteOffset", 0, kMostBytes),
                          bytes = of.at("byteLength").whole(kMostBytes);
      ranges.push_back({of.at("buffer").whole(kMostBytes), begin, begin + bytes, bytes + 1, bytes, kNone, false});
    }
  return ranges;
}

void Accessors::fail_together(const Range& a, const Range& b) const {
  const Range &rewritten = a.is_rewritten ? a : b, &other = a.is_rewritten ? b : a;
  list_[rewritten.accessor].fail("elements with bytes of their own, as they are to be rewritten",
                                 other.accessor == kNone
                                     ? "bytes that a sparse accessor or an image has, too"
                                     : fmt::format("bytes that accessors[{}] has, too", other.accessor));
}

void Accessors::require_apart(const std::vector<Accessor>& rewritten) const {
  std::vector<Range> ranges = all_ranges(rewritten), open, others;
  std::stable_sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) {
    return a.buffer != b.buffer ? a.buffer < b.buffer : a.begin < b.begin;
  });
  for (const Range& range : ranges) {
    const auto has_ended = [&](const Range& before) {
      return before.buffer != range.buffer || before.end <= range.begin;
    };
    const auto require_apart_from = [&](std::vector<Range>& before) {
      std::erase_if(before, has_ended);
      for (const Range& each : before)
        if (!each.is_apart(range)) fail_together(each, range);
    };
    require_apart_from(open);
    if (range.is_rewritten) require_apart_from(others);
    (range.is_rewritten ? open : others).push_back(range);
  }
}

}  // namespace vdb_offset::io::gltf
