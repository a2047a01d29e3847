#include <cstdio>
#include <cstdlib>
#include <cmath>
#include "core/common/angle.h"
#include "core/localization/site_search.h"
#include "tests/bench/kidnapped.h"
#include "tests/bench/cpu_time.h"
#include "tests/bench/lap.h"
#include <ctime>
#include <cstring>
#include <fstream>
using namespace cairn;
using namespace cairn::bench;
int main(int argc, char** argv) {
  const char* name = argc > 1 ? argv[1] : "block";
  const int seed = argc > 2 ? atoi(argv[2]) : 1;
  const int trials = argc > 3 ? atoi(argv[3]) : 20;
  const char* other = argc > 4 ? argv[4] : nullptr;
  const int other_seed = argc > 5 ? atoi(argv[5]) : 0;
  auto world = agent::make_world(name, static_cast<std::uint64_t>(seed));
  Walkable walkable(*world);
  std::clock_t t = std::clock();
  auto lap = [&] { double s = double(std::clock() - t) / CLOCKS_PER_SEC; t = std::clock(); return s; };
  HeightMap map = surveyed(*world, walkable, [](double, double) { return true; }, 5);
  printf("survey %.1f s, known %zu\n", lap(), map.known_count());
  SiteSearch search(map);
  printf("prepare %.2f s\n", lap());
  auto w2 = other ? agent::make_world(other, static_cast<std::uint64_t>(other_seed)) : agent::make_world(name, static_cast<std::uint64_t>(seed));
  Walkable walk2(*w2);
  int good = 0, bad = 0;
  for (int i = argc > 6 ? atoi(argv[6]) : 0; i < trials; ++i) {
    auto s = put_down(*w2, walk2, [](double, double) { return true; }, static_cast<std::uint64_t>(1000 * seed + i));
    if (!s) { printf("no place\n"); return 1; }
    lap();
    SiteMatch m = search.find(s->short_term, s->T_submap_robot);
    double dt = lap();
    PoseError e = error_of(m.T_site_robot, s->T_site_robot);
    bool right = !other && e.position_m < 0.5 && e.yaw_rad < radians(5.0);
    if (m.accepted) (right ? good : bad)++;
    printf("%2d %s at %6.1f %6.1f known %5zu: %s%s %.2f s bounds %7zu exact %4.1f/%5.1f places %zu score %5.1f second %5.1f unk %.2f err %6.2f %5.1f° ov %.2f in %.2f res %.0f  tilt %.1f %.1f %s\n", i,
           s->turned ? "turn " : "drive", s->T_site_robot.x_m, s->T_site_robot.y_m, s->short_term.known_count(),
           m.accepted ? "ACC" : "ref", right ? " right" : " WRONG", dt, m.bounds, m.score_mm, m.second_best_mm, m.places, m.bound_mm, m.second_bound_mm, m.unknown, e.position_m,
           e.yaw_rad * 57.3, m.registration.overlap, m.registration.inliers, m.registration.residual_mm, 57.3*(s->T_submap_robot.roll_rad-s->T_site_robot.roll_rad), 57.3*(s->T_submap_robot.pitch_rad-s->T_site_robot.pitch_rad), m.why.c_str());
  }
  printf("good %d false %d of %d\n", good, bad, trials);
}
