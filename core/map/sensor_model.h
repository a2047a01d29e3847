#pragma once

#include <cstdint>
#include <string>

namespace cairn {

/// The sensor model as data (T4.3, T5.3): how much a reading is believed.
/// Probabilities are in 1/255, as in cells.
struct SensorModel {
  /// [1/255] P(surface at the height | a hit there). [Limit: 128 … 254]
  std::uint8_t hit_probability = 166;
  /// [1/255] P(surface at the stored height | a beam passed below it). [Limit: 1 … 127]
  std::uint8_t miss_probability = 102;
  /// [1/255] P(surface at the stored height | a beam passed there, not above it but within the
  /// tolerance, and went on). Weak: a beam that grazes the edge of a thing does the same.
  /// [Limit: miss_probability … 127]
  std::uint8_t graze_probability = 112;
  /// [m] A beam that ends nearer behind a cell than this grazed what it met. [Limit: 0 … 10]
  double graze_beyond_m = 0.5;
  /// [1/255] Below this a cell is unknown again. [Limit: 1 … 127]
  std::uint8_t min_probability = 25;
  /// [1/255] Confidence never exceeds this, so that a changed world is learned in bounded time.
  /// [Limit: hit_probability … 254]
  std::uint8_t max_probability = 250;
  /// [mm] Hits this near the stored height are readings of the same surface.
  /// [Limit: 1 … 10000]
  std::int32_t tolerance_mm = 50;
  /// [-] Hits the running mean of a surface's height remembers. [Limit: 1 … 255]
  int mean_memory_hits = 12;

  friend bool operator==(const SensorModel&, const SensorModel&) = default;
};

/// Every fault of the model in one sentence each, joined by "; ". Empty when it is sound.
[[nodiscard]] std::string faults(const SensorModel& model);

/// Recursive Bayes (T Eq. 1) of two independent opinions on the same proposition, all in 1/255:
/// a·b / (a·b + (1-a)·(1-b)), rounded to nearest, in integers so that it is the same everywhere.
/// Requires: not one of them 0 and the other 255.
[[nodiscard]] std::uint8_t combine(std::uint8_t a, std::uint8_t b);

/// How many hits a surface of this probability stands for: ln(p/(1-p)) / ln(h/(1-h)), h being the
/// hit probability, rounded, in [1, mean_memory_hits]. At max_probability further hits leave no
/// trace, so it stands for as many as are remembered. The same on every machine: no case lies so
/// near a rounding limit that the last digits of a logarithm could decide it.
/// Requires: a sound model.
[[nodiscard]] int hits_behind(std::uint8_t probability, const SensorModel& model);

}  // namespace cairn
