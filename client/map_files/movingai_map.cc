#include "client/map_files/movingai_map.h"

#include <algorithm>

#include "client/map_files/words.h"

namespace cairn::map_files {

namespace {

Result<std::string> word_of(Words& words) {
  auto word = words.next();
  if (!word) return word.error();
  if (!*word) return words.bad("the file ends in its head: expected type, height, width, map");
  return std::string(**word);
}

Result<std::int64_t> size_of(Words& words) {
  auto word = word_of(words);
  if (!word) return word.error();
  const auto size = whole_number_in(*word);
  if (!size) return words.bad("\"" + *word + "\" is no count of cells");
  return *size;
}

/// The four lines before the rows, in any order up to "map".
Result<RasterFrame> read_head(Words& words) {
  std::optional<std::int64_t> columns;
  std::optional<std::int64_t> rows;
  bool typed = false;
  for (;;) {
    auto key = word_of(words);
    if (!key) return key.error();
    if (*key == "map") break;
    if (*key == "type") {
      auto type = word_of(words);
      if (!type) return type.error();
      if (!type->starts_with("octile")) return words.bad("type " + *type + " is not octile");
      typed = true;
    } else if (*key == "height" || *key == "width") {
      auto size = size_of(words);
      if (!size) return size.error();
      (*key == "height" ? rows : columns) = *size;
    } else {
      return words.bad("is no Moving AI map: expected type, height, width or map");
    }
  }
  if (!typed || !columns || !rows) {
    return words.bad("type, height and width must come before map");
  }
  RasterFrame frame;
  if (auto sized = set_size(frame, *columns, *rows); !sized) {
    return Error{sized.error().code, words.bad(sized.error().message).message};
  }
  return frame;
}

Status read_row(Words& words, int row, ClassRaster& raster) {
  auto line = words.rest_of_line();
  if (!line) return line.error();
  if (line->size() != static_cast<std::size_t>(raster.frame.columns)) {
    return words.bad("has " + std::to_string(line->size()) + " cells, expected " +
                     std::to_string(raster.frame.columns));
  }
  for (int column = 0; column < raster.frame.columns; ++column) {
    const char letter = (*line)[static_cast<std::size_t>(column)];
    const bool free = letter == '.' || letter == 'G' || letter == 'S';
    const bool blocked = letter == '@' || letter == 'O' || letter == 'T' || letter == 'W';
    if (!free && !blocked) {
      return words.bad(std::string("'") + letter + "' is none of .GS@OTW");
    }
    raster.classes[raster.frame.at(column, row)] = free ? CellClass::free : CellClass::obstacle;
  }
  return {};
}

}  // namespace

Result<ClassRaster> read_movingai_map(const std::string& path) {
  auto words = Words::open(path);
  if (!words) return words.error();
  auto frame = read_head(*words);
  if (!frame) return frame.error();
  if (auto end_of_head = words->rest_of_line(); !end_of_head) return end_of_head.error();
  ClassRaster raster{*frame, std::vector<CellClass>(frame->cells(), CellClass::unknown)};
  for (int row = frame->rows - 1; row >= 0; --row) {
    if (auto read = read_row(*words, row, raster); !read) return read.error();
  }
  auto more = words->next();
  if (!more) return more.error();
  if (*more) return words->bad("more rows than the height of " + std::to_string(frame->rows));
  return raster;
}

Status write_movingai_map(const std::string& path, const ClassRaster& raster) {
  auto file = create_file(path);
  if (!file) return file.error();
  const RasterFrame& frame = raster.frame;
  *file << "type octile\nheight " << frame.rows << "\nwidth " << frame.columns << "\nmap\n";
  std::string line(static_cast<std::size_t>(frame.columns) + 1, '\n');
  for (int row = frame.rows - 1; row >= 0; --row) {
    for (int column = 0; column < frame.columns; ++column) {
      const bool free = raster.classes[frame.at(column, row)] == CellClass::free;
      line[static_cast<std::size_t>(column)] = free ? '.' : '@';
    }
    *file << line;
  }
  return finish_file(*file, path);
}

}  // namespace cairn::map_files
