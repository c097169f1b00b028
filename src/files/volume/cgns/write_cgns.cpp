// SPDX-License-Identifier: Apache-2.0
// Writes cells as a CGNS file, through the library of that name: one base and one zone with coordinates, elements,
// boundary conditions and fields. Without polyhedra, cells have a section for each type, and the faces of each patch
// sections for triangles and quads. With a polyhedron among them, all cells are lists of faces: faces between cells
// come first, each once, then those of the patches, and a cell names a face with a minus sign if its normal points into
// the cell. Fields of cells follow the order of the elements. The room that the file can take is reserved on the disk
// before, as the library below cannot close a file that did not fit. Whatever the library reports becomes an error with
// the file's name.
#include <cgnslib.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <numeric>

#include "products/volume/volume_faces.h"
#include "vdb_offset/run.h"
#include "volume/volume_writers.h"

// https://cgns.github.io/standard/SIDS: elements are numbered from 1, through all sections.
namespace vdb_offset::io {
namespace {

// Bytes of a name that CGNS keeps.
constexpr std::size_t kLongestName = 32;

class CgnsFile {
 public:
  explicit CgnsFile(const WrittenFile& file) : path_(file.path) {
    require(cg_open(file.temporary.c_str(), CG_MODE_WRITE, &file_));
    open_ = true;
  }
  CgnsFile(const CgnsFile&) = delete;
  CgnsFile& operator=(const CgnsFile&) = delete;
  ~CgnsFile() {
    if (open_) cg_close(file_);
  }
  operator int() const { return file_; }
  void close() {
    open_ = false;
    require(cg_close(file_));
  }
  void require(int status) const {
    if (status != CG_OK) throw WriteError(path_ + ": cannot be written: " + cg_get_error());
  }

 private:
  const std::string& path_;
  int file_ = 0;
  bool open_ = false;
};

/// An upper bound of the bytes that the file will take.
std::size_t most_bytes(const VolumeMesh& mesh) {
  std::size_t corners = mesh.corners.size(), values = 0;
  for (const BoundaryPatch& patch : mesh.patches) corners += patch.corners.size();
  for (const auto* fields : {&mesh.point_fields, &mesh.cell_fields})
    for (const VolumeField& field : *fields) values += field.values.size();
  // If there are polyhedra, all cells are lists of faces, and these are lists of points: the faces of a prism have
  // three times as many corners as the prism, and there are the numbers of the faces.
  const std::size_t per_corner = sizeof(cgsize_t) * (has_polyhedra(mesh) ? 4 : 1);
  constexpr std::size_t kNodes = 1 << 20;  // bytes, ample for the few dozen nodes of the tree
  return kNodes + mesh.points.size() * sizeof(Vec3d) + corners * per_corner + values * sizeof(float);
}

/// Checks that the disk has room. HDF5 cannot close a file that did not fit, and would crash when the program ends.
void require_room(const WrittenFile& written, std::size_t bytes) {
  const int file = ::open(written.temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  const int error = file < 0 ? errno : ::posix_fallocate(file, 0, static_cast<off_t>(bytes));
  if (file >= 0) ::close(file);
  if (error != 0) throw WriteError(written.path + ": cannot be written: " + std::strerror(error));
}

constexpr CGNS_ENUMT(ElementType_t) kCgnsTypes[] = {CGNS_ENUMV(TETRA_4), CGNS_ENUMV(PYRA_5), CGNS_ENUMV(PENTA_6),
                                                    CGNS_ENUMV(HEXA_8)};

/// The one zone of a file, written piece by piece.
class CgnsZone {
 public:
  CgnsZone(const CgnsFile& file, const VolumeMesh& mesh) : file_(file), mesh_(mesh) {
    const cgsize_t sizes[3] = {size_of(mesh.points.size()), size_of(mesh.cell_count()), 0};
    require(cg_base_write(file_, "Base", 3, 3, &base_));
    require(cg_zone_write(file_, base_, "layers", sizes, CGNS_ENUMV(Unstructured), &zone_));
    write_points();
  }

  /// Writes the cells, in a section for each type, then the faces of each patch in sections of their own.
  void write_by_types() {
    std::vector<std::uint32_t> order;
    for (std::size_t type = 0; type < std::size(kCgnsTypes); ++type) {
      const std::size_t before = order.size();
      for (std::uint32_t c = 0; c < mesh_.cell_count(); ++c)
        if (mesh_.cell_types[c] == static_cast<CellType>(type)) order.push_back(c);
      write_section(name(static_cast<CellType>(type)), kCgnsTypes[type], std::span(order).subspan(before),
                    [this](std::uint32_t c) { return mesh_.cell(c); });
    }
    const auto words = patch_words(mesh_, kLongestName - std::string_view("_triangles").size());
    for (std::size_t i = 0; i < words.size(); ++i) {
      const BoundaryPatch& patch = mesh_.patches[i];
      const cgsize_t first = next_;
      for (const std::size_t corners : {3, 4}) {
        std::vector<std::uint32_t> faces;
        for (std::uint32_t f = 0; f < patch.face_count(); ++f)
          if (patch.face(f).size() == corners) faces.push_back(f);
        write_section(words[i] + (corners == 3 ? "_triangles" : "_quads"),
                      corners == 3 ? CGNS_ENUMV(TRI_3) : CGNS_ENUMV(QUAD_4), faces,
                      [&](std::uint32_t f) { return patch.face(f); });
      }
      write_condition(words[i], patch.kind, first);
    }
    write_fields(order);
  }

  /// Writes polyhedra: first the faces between cells, then those of each patch, then the cells as lists of faces.
  void write_polyhedra() {
    const VolumeFaces faces(mesh_);
    std::vector<cgsize_t> face_of_side(faces.side_count());
    write_inner_faces(faces, face_of_side);
    const auto words = patch_words(mesh_, kLongestName);
    for (std::size_t i = 0; i < words.size(); ++i) {
      const cgsize_t first = next_;
      write_patch_faces(words[i], mesh_.patches[i], faces, face_of_side);
      write_condition(words[i], mesh_.patches[i].kind, first);
    }
    PolySection cells;
    for (std::uint32_t c = 0; c < mesh_.cell_count(); ++c) {
      const auto first = face_of_side.begin() + static_cast<std::ptrdiff_t>(faces.first_side(c));
      cells.numbers.insert(cells.numbers.end(), first, first + static_cast<std::ptrdiff_t>(faces.behind(c).size()));
      cells.close();
    }
    write_poly_section("cells", CGNS_ENUMV(NFACE_n), cells);
    std::vector<std::uint32_t> order(mesh_.cell_count());
    std::iota(order.begin(), order.end(), 0);
    write_fields(order);
  }

 private:
  /// A section of elements with different numbers of corners or faces.
  struct PolySection {
    std::vector<cgsize_t> numbers, begin{0};
    void close() { begin.push_back(static_cast<cgsize_t>(numbers.size())); }
    template <class Face>
    void add(const Face& face, std::size_t size) {
      for (std::size_t k = 0; k < size; ++k) numbers.push_back(static_cast<cgsize_t>(face[k]) + 1);
      close();
    }
  };

  void require(int status) const { file_.require(status); }
  /// A count as an integer of the library. \throw InvalidInput if that is too short
  static cgsize_t size_of(std::size_t count) {
    if (count > static_cast<std::size_t>(std::numeric_limits<cgsize_t>::max()))
      throw InvalidInput(
          fmt::format("volume mesh: expected at most {} points, elements and corners of one type for .cgns, "
                      "got {}",
                      std::numeric_limits<cgsize_t>::max(), count));
    return static_cast<cgsize_t>(count);
  }

  void write_points() {
    std::vector<double> numbers(mesh_.points.size());
    constexpr const char* kNames[] = {"CoordinateX", "CoordinateY", "CoordinateZ"};
    for (int k = 0; k < 3; ++k) {
      for (std::size_t p = 0; p < numbers.size(); ++p) numbers[p] = mesh_.points[p][k];
      int coordinate = 0;
      require(cg_coord_write(file_, base_, zone_, CGNS_ENUMV(RealDouble), kNames[k], numbers.data(), &coordinate));
    }
  }

  template <class CornersOf>
  void write_section(const std::string& name, CGNS_ENUMT(ElementType_t) type, std::span<const std::uint32_t> members,
                     const CornersOf& corners_of) {
    if (members.empty()) return;
    std::vector<cgsize_t> numbers;
    numbers.reserve(static_cast<std::size_t>(size_of(members.size() * corners_of(members[0]).size())));
    for (const std::uint32_t member : members)
      for (const std::uint32_t v : corners_of(member)) numbers.push_back(static_cast<cgsize_t>(v) + 1);
    const cgsize_t last = last_of(members.size());
    int section = 0;
    require(cg_section_write(file_, base_, zone_, name.c_str(), type, next_, last, 0, numbers.data(), &section));
    next_ = last + 1;
  }

  void write_poly_section(const std::string& name, CGNS_ENUMT(ElementType_t) type, const PolySection& elements) {
    if (elements.numbers.empty()) return;
    size_of(elements.numbers.size());
    const cgsize_t last = last_of(elements.begin.size() - 1);
    int section = 0;
    require(cg_poly_section_write(file_, base_, zone_, name.c_str(), type, next_, last, 0, elements.numbers.data(),
                                  elements.begin.data(), &section));
    next_ = last + 1;
  }

  cgsize_t last_of(std::size_t count) const { return size_of(static_cast<std::size_t>(next_) + count - 1); }

  /// Writes the faces between cells, and notes their numbers; negative for the cell into which a face's normal points.
  void write_inner_faces(const VolumeFaces& faces, std::vector<cgsize_t>& face_of_side) {
    PolySection section;
    std::vector<VolumeFaces::Side> upper;
    std::vector<std::uint32_t> corners;
    cgsize_t number = next_;
    for (std::uint32_t c = 0; c < mesh_.cell_count(); ++c) {
      faces.upper_faces(c, upper);
      for (const VolumeFaces::Side& side : upper) {
        const CellFace known = face(mesh_, c, side.local);
        section.add(known, known.size);
        sort_corners(known, known.size, corners);
        face_of_side[faces.first_side(c) + side.local] = number;
        face_of_side[faces.first_side(side.cell) + faces.local_of(mesh_, side.cell, c, corners)] = -number;
        ++number;
      }
    }
    write_poly_section("faces", CGNS_ENUMV(NGON_n), section);
  }

  void write_patch_faces(const std::string& name, const BoundaryPatch& patch, const VolumeFaces& faces,
                         std::vector<cgsize_t>& face_of_side) {
    PolySection section;
    std::vector<std::uint32_t> corners;
    for (std::uint32_t f = 0; f < patch.face_count(); ++f) {
      const std::uint32_t c = patch.cell[f];
      section.add(patch.face(f), patch.face(f).size());
      sort_corners(patch.face(f), patch.face(f).size(), corners);
      face_of_side[faces.first_side(c) + faces.local_of(mesh_, c, VolumeFaces::kNone, corners)] =
          next_ + static_cast<cgsize_t>(f);
    }
    write_poly_section(name, CGNS_ENUMV(NGON_n), section);
  }

  /// Writes a boundary condition for the elements from `first` to the last one written.
  void write_condition(const std::string& name, BoundaryPatch::Kind kind, cgsize_t first) {
    if (first == next_) return;
    const cgsize_t range[2] = {first, next_ - 1};
    const bool is_mirror = kind == BoundaryPatch::Kind::Symmetry || kind == BoundaryPatch::Kind::Empty;
    const auto type = kind == BoundaryPatch::Kind::Wall     ? CGNS_ENUMV(BCWall)
                      : is_mirror                           ? CGNS_ENUMV(BCSymmetryPlane)
                      : kind == BoundaryPatch::Kind::Inlet  ? CGNS_ENUMV(BCInflow)
                      : kind == BoundaryPatch::Kind::Outlet ? CGNS_ENUMV(BCOutflow)
                                                            : CGNS_ENUMV(BCGeneral);
    int condition = 0;
    require(cg_boco_write(file_, base_, zone_, name.c_str(), type, CGNS_ENUMV(PointRange), 2, range, &condition));
    require(cg_boco_gridlocation_write(file_, base_, zone_, condition, CGNS_ENUMV(FaceCenter)));
  }

  void write_fields(std::span<const std::uint32_t> cells) {
    write_fields("PointFields", CGNS_ENUMV(Vertex), mesh_.point_fields, {});
    write_fields("CellFields", CGNS_ENUMV(CellCenter), mesh_.cell_fields, cells);
  }

  /// Writes fields: their values in this order, or all values as they are if `order` is empty.
  void write_fields(const char* name, CGNS_ENUMT(GridLocation_t) location, const std::vector<VolumeField>& fields,
                    std::span<const std::uint32_t> order) {
    int solution = 0;
    for (const VolumeField& field : fields) {
      if (field.values.empty()) continue;
      if (solution == 0) require(cg_sol_write(file_, base_, zone_, name, location, &solution));
      std::vector<float> ordered;
      for (const std::uint32_t i : order) ordered.push_back(field.values[i]);
      int written = 0;
      require(cg_field_write(file_, base_, zone_, solution, CGNS_ENUMV(RealSingle),
                             field.name.substr(0, kLongestName).c_str(),
                             order.empty() ? field.values.data() : ordered.data(), &written));
    }
  }

  const CgnsFile& file_;
  const VolumeMesh& mesh_;
  int base_ = 0, zone_ = 0;
  cgsize_t next_ = 1;  ///< Number of the next element.
};

}  // namespace

void write_cgns(const WrittenFile& file, const VolumeMesh& mesh) {
  require_room(file, most_bytes(mesh));
  CgnsFile opened(file);
  CgnsZone zone(opened, mesh);
  if (has_polyhedra(mesh)) zone.write_polyhedra();
  else zone.write_by_types();
  opened.close();
}

}  // namespace vdb_offset::io
