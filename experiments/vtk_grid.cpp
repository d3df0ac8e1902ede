#include "experiments/vtk.hpp"
#include "experiments/vtk_arrays.hpp"

namespace trigrain {

std::string vtu_text(const Spacetree& tree) {
  constexpr std::uint8_t voxel = 11; // VTK's number for a box whose corners count x first, then y, then z
  std::vector<double> points;
  std::vector<std::int64_t> corners, end;
  std::vector<std::int32_t> level;
  tree.for_each_leaf([&](int l, const Index3& cell) {
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d x = tree.place_of(l, cell + Index3(corner & 1, corner >> 1 & 1, corner >> 2));
      corners.push_back(static_cast<std::int64_t>(points.size() / 3));
      points.insert(points.end(), {x.x(), x.y(), x.z()});
    }
    end.push_back(static_cast<std::int64_t>(corners.size()));
    level.push_back(l);
  });
  const std::vector<std::uint8_t> types(level.size(), voxel);
  VtkArrays data;
  std::ostringstream out;
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
         "header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\""
      << points.size() / 3 << "\" NumberOfCells=\"" << level.size() << "\">\n<Points>\n"
      << data.array("Float64", "position_m", 3, points) << "</Points>\n<Cells>\n"
      << data.array("Int64", "connectivity", 1, corners) << data.array("Int64", "offsets", 1, end)
      << data.array("UInt8", "types", 1, types) << "</Cells>\n<CellData>\n"
      << data.array("Int32", "level", 1, level) << "</CellData>\n</Piece>\n</UnstructuredGrid>\n"
      << "<AppendedData encoding=\"base64\">\n_" << data.text << "\n</AppendedData>\n</VTKFile>\n";
  return std::move(out).str();
}

} // namespace trigrain
