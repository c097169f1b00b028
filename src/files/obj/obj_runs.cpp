// SPDX-License-Identifier: Apache-2.0
#include "obj/obj_runs.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "bytes/line_records.h"
#include "obj/obj_corners.h"

namespace vdb_offset::io {
namespace {

class ObjRunFinder {
 public:
  explicit ObjRunFinder(const MeshFile& source) : source_(source) {
    const std::vector<std::size_t> cuts = cut_at_lines(source.text(), 0);
    found_.runs.resize(cuts.size() - 1);
    scanned_.resize(found_.runs.size());
    tbb::parallel_for(std::size_t{0}, found_.runs.size(), [&](std::size_t i) { scan(i, cuts[i], cuts[i + 1]); });
    for (std::size_t i = 0; i < scanned_.size(); ++i) {
      found_.groups_late = found_.groups_late && !scanned_[i].names_group;
      found_.objects_late = found_.objects_late && !scanned_[i].names_object;
      found_.first_face_run = i;
      if (scanned_[i].counts.faces > 0) break;
    }
    put_together();
    if (!found_.texture_at.empty()) find_texture();
  }
  ObjRuns take() { return std::move(found_); }

 private:
  /// What a run holds.
  struct Scanned {
    ObjCounts counts;
    StateLines last;                                 // of each statement
    std::array<std::size_t, kLineKinds> last_end{};  // as in ObjRuns; 0: there is no such line
    bool names_group = false, names_object = false;  // before the first face
  };

  template <class Visit>
  void for_each_line(const ObjRun& run, Visit&& visit) const {
    const std::size_t start = run.begin == 0 ? byte_order_mark(source_.text()) : run.begin;
    for_each_obj_line(source_.path, source_.text(), start, run.end, visit);
  }

  void scan(std::size_t i, std::size_t begin, std::size_t end) {
    ObjRun& run = found_.runs[i];
    Scanned& scanned = scanned_[i];
    run.begin = begin;
    run.end = end;
    for_each_line(run, [&](const ObjLine& line) {
      if (const std::size_t kind = kind_of(line); kind != kLineKinds) {
        ++scanned.counts.lines[kind];
        scanned.last_end[kind] = line.begin() + line.whole.size();
        return;
      }
      scanned.counts.faces += line.is("f");
      run.has_elements |= is_obj_element(line.keyword);
      run.has_groups |= line.is("g");
      scanned.names_group |= scanned.counts.faces == 0 && line.is("g");
      scanned.names_object |= scanned.counts.faces == 0 && line.is("o");
      if (const std::size_t state = face_state_of(line.keyword); state != kNoState) scanned.last[state] = line.whole;
    });
  }

  void put_together() {
    ObjCounts counts;
    StateLines state;
    for (std::size_t i = 0; i < scanned_.size(); ++i) {
      const Scanned& scanned = scanned_[i];
      found_.runs[i].before = counts;
      found_.runs[i].state = state;
      counts.faces += scanned.counts.faces;
      for (std::size_t kind = 0; kind < kLineKinds; ++kind) {
        counts.lines[kind] += scanned.counts.lines[kind];
        found_.last_end[kind] = std::max(found_.last_end[kind], scanned.last_end[kind]);
      }
      for (std::size_t k = 0; k < kFaceStateCount; ++k)
        if (!scanned.last[k].empty()) state[k] = scanned.last[k];
    }
    found_.state_at_end = state;
    // Statements that come later in the source are in force after a skin has been written. Runs before them need the
    // statement that ends them.
    for (ObjRun& run : found_.runs)
      for (std::size_t k = 0; k < kFaceStateCount; ++k)
        if (run.state[k].empty() && !state[k].empty()) run.state[k] = kFaceStates[k].reset;
    found_.texture_at.resize(counts.lines[kVtLines]);
  }

  void find_texture() {
    const PolygonView mesh = source_.polygons.view();
    std::vector<std::uint32_t>& of_corner = found_.corner_texture;
    of_corner.assign(mesh.corners.size(), kNone);
    // There are more lines, faces or corners only if the file has changed meanwhile, which is found out in the end.
    tbb::parallel_for(std::size_t{0}, found_.runs.size(), [&](std::size_t i) {
      ObjCounts at = found_.runs[i].before;
      for_each_line(found_.runs[i], [&](const ObjLine& line) {
        std::size_t& textures = at.lines[kVtLines];
        if (line.is("vt") && textures < found_.texture_at.size())
          found_.texture_at[textures++] = line.words().position();
        if (!line.is("f") || at.faces >= mesh.face_count()) return;
        std::uint32_t c = mesh.face_begin[at.faces];
        const std::uint32_t end = mesh.face_begin[++at.faces];
        for (Scanner words = line.words(); c < end && !words.at_line_end(); ++c) {
          const std::uint64_t number = texture_number(words.token(), textures);
          of_corner[c] = number == 0 ? kNone : static_cast<std::uint32_t>(std::min<std::uint64_t>(number, kNone) - 1);
        }
      });
    });
    const auto is_none = [](std::uint32_t t) { return t == kNone; };
    found_.names_unknown_texture = std::any_of(of_corner.begin(), of_corner.end(), [&](std::uint32_t t) {
      return !is_none(t) && t >= found_.texture_at.size();
    });
    if (std::all_of(of_corner.begin(), of_corner.end(), is_none)) of_corner = {};
  }

  const MeshFile& source_;
  ObjRuns found_;
  std::vector<Scanned> scanned_;
};

}  // namespace

std::size_t face_state_of(std::string_view keyword) {
  std::size_t i = 0;
  while (i < kFaceStateCount && kFaceStates[i].keyword != keyword) ++i;
  return i;
}

ObjRuns find_obj_runs(const MeshFile& source) { return ObjRunFinder(source).take(); }

}  // namespace vdb_offset::io
