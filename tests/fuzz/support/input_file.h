// The input as a file, for readers that take a path. In memory where the system has such a folder.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace limber::fuzz {

/// One file in a folder of its own, which goes away with the object.
class InputFile {
 public:
  explicit InputFile(const std::string& name) {
    const std::filesystem::path memory = "/dev/shm";
    const auto base =
        std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
    std::string pattern = base / "limber-fuzz-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
    path_ = folder_ / name;
  }
  ~InputFile() { std::filesystem::remove_all(folder_); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  void write(std::string_view text) const { std::ofstream(path_, std::ios::binary) << text; }
  std::string path() const { return path_; }
  std::string folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  std::filesystem::path path_;
};

}  // namespace limber::fuzz
