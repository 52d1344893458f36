// SPDX-License-Identifier: MIT OR Apache-2.0
/** Triangle surfaces for ParaView: one .vtp file (VTK's XML poly data) per frame and a .pvd file that lists them. */
#ifndef RAYCONTACT_DEMOS_VTP_FILE_HPP
#define RAYCONTACT_DEMOS_VTP_FILE_HPP

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace demo {

struct VtpSurface {
  std::vector<float> points;       // x, y, z packed
  std::vector<int32_t> triangles;  // three point numbers each
  std::vector<uint8_t> body;       // of each point
  std::vector<uint8_t> inside;     // of each point: 1 = inside the other body
};

inline std::ofstream open_for_writing(const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary);
  if (!file)
    throw std::runtime_error("cannot write " + path.string() + ": check that the folder exists and is writable");
  return file;
}

inline void close_checked(std::ofstream& file, const std::filesystem::path& path) {
  file.close();
  if (!file) throw std::runtime_error("writing " + path.string() + " failed: is the disk full?");
}

/** Arrays go behind the XML as they lie in memory, each after its size in bytes. */
class VtpWriter {
 public:
  static void write(const std::filesystem::path& path, const VtpSurface& surface) {
    std::vector<int32_t> offsets;
    for (std::size_t t = 3; t <= surface.triangles.size(); t += 3) offsets.push_back(static_cast<int32_t>(t));
    VtpWriter w;
    w.xml_ =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"" +
        std::to_string(surface.points.size() / 3) + "\" NumberOfPolys=\"" + std::to_string(offsets.size()) +
        "\">\n<PointData Scalars=\"body\">\n";
    w.add("UInt8", "body", 1, surface.body);
    w.add("UInt8", "inside", 1, surface.inside);
    w.xml_ += "</PointData>\n<Points>\n";
    w.add("Float32", "position", 3, surface.points);
    w.xml_ += "</Points>\n<Polys>\n";
    w.add("Int32", "connectivity", 1, surface.triangles);
    w.add("Int32", "offsets", 1, offsets);
    w.xml_ += "</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
    std::ofstream file = open_for_writing(path);
    file << w.xml_ << w.data_ << "\n</AppendedData>\n</VTKFile>\n";
    close_checked(file, path);
  }

 private:
  template <class T>
  void add(const char* type, const char* name, int components, const std::vector<T>& values) {
    xml_ += std::string("<DataArray type=\"") + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
            std::to_string(components) + "\" format=\"appended\" offset=\"" + std::to_string(data_.size()) + "\"/>\n";
    const uint64_t bytes = values.size() * sizeof(T);
    data_.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    data_.append(reinterpret_cast<const char*>(values.data()), static_cast<std::size_t>(bytes));
  }

  std::string xml_, data_;
};

/** Frames in a folder beside a .pvd file; the list is rewritten with each frame, so that a broken run can be opened. */
class PvdSeries {
 public:
  PvdSeries(std::filesystem::path folder, std::string name) : folder_(std::move(folder)), name_(std::move(name)) {
    std::error_code error;
    std::filesystem::create_directories(folder_ / name_, error);
    if (error) throw std::runtime_error("cannot create " + (folder_ / name_).string() + ": " + error.message());
  }

  void add(double time, const VtpSurface& surface) {
    std::string number = std::to_string(count_++);
    number.insert(0, number.size() < 4 ? 4 - number.size() : 0, '0');
    const std::string file_name = name_ + "/" + name_ + "_" + number + ".vtp";
    VtpWriter::write(folder_ / file_name, surface);
    entries_ += "<DataSet timestep=\"" + std::to_string(time) + "\" part=\"0\" file=\"" + file_name + "\"/>\n";
    std::ofstream list = open_for_writing(path());
    list << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
            "byte_order=\"LittleEndian\">\n<Collection>\n"
         << entries_ << "</Collection>\n</VTKFile>\n";
    close_checked(list, path());
  }

  std::filesystem::path path() const { return folder_ / (name_ + ".pvd"); }
  std::size_t count() const { return count_; }

 private:
  std::filesystem::path folder_;
  std::string name_, entries_;
  std::size_t count_ = 0;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_VTP_FILE_HPP
