#pragma once
#include "dem/particles.hpp"
#include "dem/spacetree.hpp"
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace trigrain {

/// A frame as VTK XML PolyData (appended base64, little endian): the triangles of all bodies in the world frame,
/// spheres as icospheres; per triangle the number of its body (`body`) and the speed of the body's centre
/// (`speed_m_s`).
std::string vtp_text(const Particles& particles);

/// The cells of a grid that are not split as VTK XML UnstructuredGrid: per cell its level (`level`).
std::string vtu_text(const Spacetree& tree);
constexpr std::int64_t most_cells_written = 500'000; ///< a grid of more is left out of a frame

/// The list of frames that ParaView opens: pairs of time (s) and file name.
std::string pvd_text(const std::vector<std::pair<double, std::string>>& frames);

/// Frames of one run in a folder: frame_00000.vtp, ... and frames.pvd; of the grid, grid_00000.vtu, ... and grid.pvd.
/// Whole after every frame.
class FrameWriter {
 public:
  /// Makes the folder, but not its parents. InputError if that cannot be.
  explicit FrameWriter(std::filesystem::path folder);
  /// `tree` may be null.
  void write(const Particles& particles, const Spacetree* tree, double time);
  /// Frames whose grid had too many cells to be written.
  int grids_left_out() const { return grids_left_out_; }

 private:
  std::filesystem::path folder_;
  std::vector<std::pair<double, std::string>> frames_, grids_;
  int grids_left_out_ = 0;
};

} // namespace trigrain
