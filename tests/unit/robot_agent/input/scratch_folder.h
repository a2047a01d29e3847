#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace cairn::agent {

/// A folder of its own for each test, gone afterwards.
class ScratchFolder : public testing::Test {
 protected:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "cairn-input-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~ScratchFolder() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }
  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }

 private:
  std::filesystem::path folder_;
};

/// The folder of real data; empty where there is none.
inline std::string data_folder() {
  const char* set = std::getenv("CAIRN_DATA");  // NOLINT: no other thread here.
  const std::string folder = set != nullptr ? set : CAIRN_DATA_DEFAULT;
  return std::filesystem::is_directory(folder) ? folder : "";
}

}  // namespace cairn::agent
