#pragma once
#include "dem/particles.hpp"
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace trigrain {

/// A frame as VTK XML PolyData (appended base64, little endian): the triangles of all bodies in the world frame,
/// spheres as icospheres; per triangle the number of its body (`body`) and the speed of the body's centre
/// (`speed_m_s`).
std::string vtp_text(const Particles& particles);

/// The list of frames that ParaView opens: pairs of time (s) and file name.
std::string pvd_text(const std::vector<std::pair<double, std::string>>& frames);

/// Frames of one run in a folder: frame_00000.vtp, ... and frames.pvd, whole after every frame.
class FrameWriter {
 public:
  /// Makes the folder, but not its parents. InputError if that cannot be.
  explicit FrameWriter(std::filesystem::path folder);
  void write(const Particles& particles, double time);

 private:
  std::filesystem::path folder_;
  std::vector<std::pair<double, std::string>> frames_;
};

} // namespace trigrain
