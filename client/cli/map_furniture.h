#pragma once

#include "client/cli/canvas.h"
#include "client/cli/map_picture.h"
#include "client/cli/map_relief.h"

namespace cairn::cli {

inline const cv::Vec3b kPaperColour{250, 252, 253};

/// 1, 2 or 5 times a power of ten: the largest that is at most `most`.
[[nodiscard]] double nice_step(double most);

/// Faint lines at round coordinates over the map.
void draw_grid(Canvas& panel, const PictureLayout& layout);
/// What is around the map: title, coordinates, scale bar, north arrow, legend.
void draw_furniture(Canvas& page, const PictureLayout& layout, const SiteMap& map,
                    const HeightRange& range);

}  // namespace cairn::cli
