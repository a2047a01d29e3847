#pragma once

#include <cstddef>

#include "core/delta/coarseness.h"
#include "core/localization/continuous.h"
#include "core/localization/ground_tracking.h"
#include "core/localization/tracking.h"
#include "core/map/sensor_model.h"
#include "core/pose/dead_reckoning.h"
#include "core/pose/incline_trust.h"
#include "robot_agent/pipeline/news.h"

namespace cairn::agent {

struct MapperConfig {
  int cell_size_mm = 125;
  SensorModel sensor_model;
  /// How finely evidence is written down, and so told: changes below it are no news.
  Coarseness coarseness;
  /// [s] A robot that has stood for so long tells what changes around it at this interval only: at
  /// the edges of things beams hit now this cell, now that.
  double parked_telling_s = 15.0;
  NewsConfig news;
  /// [0 … 1] On ground of which so much is old the robot tells only news …
  double known_share = 0.9;
  /// [m] … as long as its place in the map is known as well as this, one sigma …
  double firm_sigma_m = 0.1;
  /// [submaps] … and, on ground that it mapped itself, after so many that it told whole: by those
  /// the server's pose graph can tell how old and new ground lie.
  int whole_submaps = 2;
  DeadReckoningConfig dead_reckoning;
  /// [m] Beams count this far: beyond it the error of the inclinometer exceeds a kerb's height.
  double mapping_range_m = 15.0;
  InclineTrustConfig incline;
  double submap_distance_m = 8.0;         ///< [m] A submap is closed after this much way
  double submap_turn_rad = 4.0 * 3.1416;  ///< [rad] or this much turning.
  /// [m] Half length and half width of the wheel base: where the wheels stand is ground.
  double wheel_x_m = 0.30;
  double wheel_y_m = 0.25;
  /// [m] At the start the ground in sight is taken as level within this radius, because no laser
  /// sees it; whoever sets the robot down vouches for it.
  double start_apron_m = 1.8;

  /// Whether the robot corrects its pose by what it sees; else it is dead reckoning's.
  bool localize = true;
  /// Whether the start pose is where the robot stands. If not it is lost until it finds itself in
  /// the map that it was given.
  bool start_known = true;
  ContinuousConfig continuous;
  /// A lost robot searches the whole map after so much way [m] and turning [rad], added up in
  /// parts.
  double search_every_m = 2.0;
  double search_every_rad = 6.0;
  GroundTrackingConfig ground_tracking;
  TrackingConfig tracking;
  /// A level laser tracks the robot while that is less tilted than this [rad] and stays this near
  /// to one height [m]: then it sees the same section of the world, be it walls or slopes.
  double section_tilt_rad = 0.03;
  double section_z_m = 0.10;
  /// [m] What the robot itself mapped counts as old, and worth being registered against, after this
  /// much more way: the newest map holds the very evidence that would be registered.
  double old_after_m = 20.0;
  /// [0 … 1] So much of what is known around the robot must be old for a registration to be tried:
  /// less is new ground.
  double old_share = 0.5;
  /// [m] One sigma of its position in the site beyond which the robot asks its own old map. That
  /// holds errors of its own, and to close loops is the pose graph's work.
  double ask_own_sigma_m = 0.25;
  /// [bytes] Of the robot's own submaps that are kept to be moved; the oldest are then fixed.
  std::size_t kept_bytes = std::size_t{256} << 20;
};

}  // namespace cairn::agent
