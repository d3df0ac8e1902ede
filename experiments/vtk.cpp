#include "experiments/vtk.hpp"
#include "experiments/atomic_file.hpp"
#include "experiments/vtk_arrays.hpp"
#include "kernels/name_table.hpp"
#include <bit>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

namespace trigrain {

std::string base64(std::string_view bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0; // three bytes, zeros where there are none
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

namespace {

static_assert(std::endian::native == std::endian::little, "the files say LittleEndian");

/// All triangles of all bodies.
struct Surfaces {
  std::vector<double> points;             // m, 3 per point
  std::vector<std::int64_t> corners, end; // point numbers of each triangle, and where each triangle ends in `corners`
  std::vector<std::int32_t> body;
  std::vector<double> speed;

  void add(const Particles& p, int i, const Mesh& mesh, double scale) {
    const auto first = static_cast<std::int64_t>(points.size() / 3);
    for (const Eigen::Vector3d& vertex : mesh.vertices) {
      const Eigen::Vector3d x = p.position[i] + p.orientation[i] * (scale * vertex);
      points.insert(points.end(), {x.x(), x.y(), x.z()});
    }
    for (const auto& face : mesh.faces) {
      for (const int corner : face) corners.push_back(first + corner);
      end.push_back(static_cast<std::int64_t>(corners.size()));
      body.push_back(i);
      speed.push_back(p.velocity[i].norm());
    }
  }
};

} // namespace

std::string vtp_text(const Particles& p) {
  Surfaces surfaces;
  const Mesh ball = icosphere(1, 2);
  for (int i = 0; i < p.size(); ++i)
    if (p.is_sphere(i))
      surfaces.add(p, i, ball, p.radius[i]);
    else
      surfaces.add(p, i, *p.mesh[i], 1);
  VtkArrays data;
  std::ostringstream out;
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
         "header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\""
      << surfaces.points.size() / 3 << "\" NumberOfPolys=\"" << surfaces.end.size() << "\">\n<Points>\n"
      << data.array("Float64", "position_m", 3, surfaces.points) << "</Points>\n<Polys>\n"
      << data.array("Int64", "connectivity", 1, surfaces.corners) << data.array("Int64", "offsets", 1, surfaces.end)
      << "</Polys>\n<CellData>\n"
      << data.array("Int32", "body", 1, surfaces.body) << data.array("Float64", "speed_m_s", 1, surfaces.speed)
      << "</CellData>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"base64\">\n_" << data.text
      << "\n</AppendedData>\n</VTKFile>\n";
  return std::move(out).str();
}

std::string pvd_text(const std::vector<std::pair<double, std::string>>& frames) {
  std::ostringstream out;
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
         "byte_order=\"LittleEndian\">\n<Collection>\n";
  for (const auto& [time, file] : frames)
    out << "<DataSet timestep=\"" << nlohmann::json(time).dump() << "\" file=\"" << file << "\"/>\n";
  out << "</Collection>\n</VTKFile>\n";
  return std::move(out).str();
}

FrameWriter::FrameWriter(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  std::filesystem::create_directory(folder_, error);
  if (error || !std::filesystem::is_directory(folder_))
    throw InputError("cannot make the folder '" + folder_.string() + "' (" +
                     (error ? error.message() : "a file of that name is there") +
                     "). Name a folder inside one that exists.");
}

void FrameWriter::write(const Particles& particles, const Spacetree* tree, double time) {
  char name[32];
  std::snprintf(name, sizeof name, "frame_%05zu.vtp", frames_.size());
  write_atomically(folder_ / name, vtp_text(particles));
  frames_.emplace_back(time, name);
  write_atomically(folder_ / "frames.pvd", pvd_text(frames_));
  if (!tree) return;
  if (tree->cells() > most_cells_written) {
    ++grids_left_out_;
    return;
  }
  std::snprintf(name, sizeof name, "grid_%05zu.vtu", grids_.size());
  write_atomically(folder_ / name, vtu_text(*tree));
  grids_.emplace_back(time, name);
  write_atomically(folder_ / "grid.pvd", pvd_text(grids_));
}

} // namespace trigrain
