#pragma once
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace trigrain {

std::string base64(std::string_view bytes);

/// The arrays behind <AppendedData> of a VTK XML file; each is its length in bytes (UInt64) and its values, in base64.
struct VtkArrays {
  std::string text;

  /// Adds an array and gives the tag that refers to it.
  template <class T>
  std::string array(const char* type, const char* name, int components, const std::vector<T>& values) {
    const std::uint64_t length = values.size() * sizeof(T);
    std::string bytes(reinterpret_cast<const char*>(&length), sizeof length);
    bytes.append(reinterpret_cast<const char*>(values.data()), length);
    std::ostringstream tag;
    tag << "<DataArray type=\"" << type << "\" Name=\"" << name << "\" NumberOfComponents=\"" << components
        << "\" format=\"appended\" offset=\"" << text.size() << "\"/>\n";
    text += base64(bytes);
    return tag.str();
  }
};

} // namespace trigrain
