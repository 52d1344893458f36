// SPDX-License-Identifier: MIT OR Apache-2.0
/** Frames for ParaView: a .vtp file of each rank, a .pvtp file that joins them, and a .pvd file that lists the frames.
 */
#ifndef RAYCONTACT_DEMOS_FRAMES_HPP
#define RAYCONTACT_DEMOS_FRAMES_HPP

#include <filesystem>
#include <string>

#include "../vtp_file.hpp"

namespace demo {

class RankedFrames {
 public:
  RankedFrames(std::filesystem::path folder, int rank, int size)
      : folder_(std::move(folder)), rank_(rank), size_(size) {
    std::filesystem::create_directories(folder_);
  }

  /** Each rank writes its own bodies, the first also what joins them. */
  void add(int frame, double time, const VtpSurface& surface) {
    const std::string name = "distributed_" + std::to_string(frame);
    VtpWriter::write(folder_ / piece(name, rank_), surface);
    if (rank_ != 0) return;
    std::ofstream joined = open_for_writing(folder_ / (name + ".pvtp"));
    joined
        << "<?xml version=\"1.0\"?>\n<VTKFile type=\"PPolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
           "header_type=\"UInt64\">\n<PPolyData GhostLevel=\"0\">\n<PPointData Scalars=\"body\">\n"
           "<PDataArray type=\"UInt8\" Name=\"body\"/>\n<PDataArray type=\"UInt8\" Name=\"inside\"/>\n</PPointData>\n"
           "<PPoints>\n<PDataArray type=\"Float32\" Name=\"position\" NumberOfComponents=\"3\"/>\n</PPoints>\n";
    for (int rank = 0; rank < size_; ++rank) joined << "<Piece Source=\"" << piece(name, rank) << "\"/>\n";
    joined << "</PPolyData>\n</VTKFile>\n";
    close_checked(joined, folder_ / (name + ".pvtp"));
    entries_ += "<DataSet timestep=\"" + std::to_string(time) + "\" part=\"0\" file=\"" + name + ".pvtp\"/>\n";
    std::ofstream list = open_for_writing(folder_ / "distributed.pvd");
    list << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
            "byte_order=\"LittleEndian\">\n<Collection>\n"
         << entries_ << "</Collection>\n</VTKFile>\n";
    close_checked(list, folder_ / "distributed.pvd");
  }

 private:
  static std::string piece(const std::string& name, int rank) {
    return name + "_rank_" + std::to_string(rank) + ".vtp";
  }

  std::filesystem::path folder_;
  int rank_, size_;
  std::string entries_;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_FRAMES_HPP
