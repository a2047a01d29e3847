// Map files of other programs, each kind by its reader.

#include <sys/mman.h>
#include <unistd.h>

#include <string>

#include "client/map_files/esri_ascii.h"
#include "client/map_files/grey_picture.h"
#include "client/map_files/height_tiff.h"
#include "client/map_files/map_file.h"
#include "client/map_files/movingai_map.h"
#include "client/map_files/ros_map.h"
#include "tests/fuzz/input.h"

using namespace cairn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const int kind = input.byte() % 6;
  const auto content = input.rest();
  const int file = memfd_create("map", 0);
  fuzz::require(file >= 0);
  const auto written = write(file, content.data(), content.size());
  fuzz::require(written == static_cast<ssize_t>(content.size()));
  const std::string path = "/proc/self/fd/" + std::to_string(file);
  switch (kind) {
    case 0:
      (void)map_files::read_movingai_map(path);
      break;
    case 1:
      (void)map_files::read_esri_ascii(path);
      break;
    case 2:
      (void)map_files::read_csv_heights(path);
      break;
    case 3:
      (void)map_files::read_grey_picture(path);
      break;
    case 4:
      (void)map_files::read_ros_map(path);
      break;
    default:
      (void)map_files::read_height_tiff(path);
  }
  close(file);
  return 0;
}
