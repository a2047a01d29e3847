#include "proto/codec/bit_mixer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "proto/codec/patch_priors.h"
#include "proto/codec/range_coder.h"

namespace cairn::proto {
namespace {

MixerState blank(std::size_t contexts, std::size_t sets) {
  return {std::vector<BitStatistics>(contexts),
          std::vector<std::int32_t>(sets * BitMixer::kMaxInputs, 20'000)};
}

/// Bytes for 20,000 bits that one of two contexts tells.
std::size_t bytes_for_told_bits(bool use_the_teller) {
  std::mt19937_64 random(3);
  MixerState state = blank(4, 1);
  BitMixer mixer(state, {});
  std::vector<std::uint8_t> out;
  RangeEncoder encoder(out);
  for (int i = 0; i < 20'000; ++i) {
    const bool teller = random() % 2 == 0;
    const bool bit = random() % 20 == 0 ? !teller : teller;
    mixer.begin();
    mixer.add(random() % 2);
    if (use_the_teller) mixer.add(2 + (teller ? 1 : 0));
    mixer.code(encoder, bit, 0, 0);
  }
  encoder.finish();
  return out.size();
}

TEST(BitMixer, LearnsWhichContextToTrust) {
  EXPECT_GT(bytes_for_told_bits(false), 2480U);
  EXPECT_LT(bytes_for_told_bits(true), 780U);  // 0.286 bits each are 716.
}

TEST(BitMixer, TheReaderLearnsTheSame) {
  std::mt19937_64 random(4);
  std::vector<std::uint8_t> out;
  MixerState there = blank(64, 4);
  MixerState here = there;
  std::vector<bool> bits;
  for (int i = 0; i < 3000; ++i) bits.push_back(random() % 3 == 0);
  const auto run = [&](auto& coder, MixerState& state) {
    BitMixer mixer(state, {});
    std::vector<bool> coded;
    for (std::size_t i = 0; i < bits.size(); ++i) {
      mixer.begin();
      mixer.add(i % 7);
      mixer.add(7 + i % 50);
      coded.push_back(mixer.code(coder, bits[i], i % 2, 2 + i % 2));
    }
    return coded;
  };
  RangeEncoder encoder(out);
  run(encoder, there);
  encoder.finish();
  RangeDecoder decoder(out);
  EXPECT_EQ(run(decoder, here), bits);
  EXPECT_EQ(here.weights, there.weights);
}

TEST(Logistic, SquashAndStretchAreTheLogisticFunctionAndItsInverse) {
  for (int logit = -kLogitLimit; logit <= kLogitLimit; ++logit) {
    EXPECT_NEAR(squash(logit), 65536.0 / (1.0 + std::exp(-logit / 256.0)), 0.51) << logit;
    EXPECT_EQ(squash(logit) + squash(-logit), 65536) << logit;
  }
  for (int p = 2000; p < 63'536; p += 16) EXPECT_NEAR(squash(stretch(p)), p, 75.0) << p;
  EXPECT_EQ(squash(100'000), squash(kLogitLimit));
}

TEST(Priors, TextKeepsThemAsCoarselyAsItSays) {
  MixerState state = patch::blank_priors();
  state.statistics[5] = {60'000, 20};
  state.weights[7] = -65'536;
  const auto back = patch::priors_from_text(patch::priors_to_text(state));
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->statistics[5].one, 60'000, 400);
  EXPECT_EQ(back->statistics[5].seen, 16);
  EXPECT_EQ(back->weights[7], -65'536);
  EXPECT_EQ(patch::priors_to_text(*back),
            patch::priors_to_text(*patch::priors_from_text(patch::priors_to_text(*back))));
  EXPECT_FALSE(patch::priors_from_text("0000"));
}

}  // namespace
}  // namespace cairn::proto
