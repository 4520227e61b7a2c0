// SPDX-License-Identifier: MIT
#include <cstdio>
#include <cstdlib>
#include <string>

#include "offline/base/error.hpp"
#include "offline/filter/filter.hpp"
#include "tests/fuzz/targets.hpp"

namespace mdhcal::fuzz {

namespace {

// A spherical wrist whose axis 2 leans by half a degree.
const BlobContent& leaning_arm() {
  static const BlobContent blob = [] {
    BlobContent out{};
    constexpr double right = 1.57079632679489661923;
    out.geometry.joint_count = 6;
    const Link links[6] = {{0, 0, 0, 0.4, 0}, {-right, 0.1, -right, 0, 0}, {0, 0.5, 0, 0, 0}, {-right, 0.1, 0, 0.6, 0}, {right, 0, 0, 0, 0}, {-right, 0, 0, 0.1, 0}};
    for (std::size_t i = 0; i < 6; ++i) {
      out.geometry.link[i] = out.nominal[i] = links[i];
      out.geometry.joint[i].sign = 1;
    }
    out.geometry.link[1].alpha_rad += 0.009;
    out.geometry.last_T_flange.quaternion[0] = 1;
    return out;
  }();
  return blob;
}

}  // namespace

void filter_target(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  using offline::ProgramLanguage;
  for (const ProgramLanguage language : {ProgramLanguage::krl, ProgramLanguage::rapid, ProgramLanguage::fanuc_ls, ProgramLanguage::inform,
                                         ProgramLanguage::urscript, ProgramLanguage::val3, ProgramLanguage::joint_state}) {
    try {
      offline::FilterOptions options;
      options.frames = offline::read_frames(text, language, "frames");
      options.frames.pulses_per_degree.assign(8, 1000);
      options.tool = language == ProgramLanguage::rapid ? "0,0,100,1,0,0,0" : "0,0,0.1,0,0,0";
      options.frame = options.tool;
      const offline::FilterResult result = offline::filter_program(text, language, "fuzz", leaning_arm(), options);
      const bool written = !result.text.empty() || text.empty();
      if (written != result.stopped.empty() || result.filtered > result.targets) {
        std::fprintf(stderr, "broken: a program is written where nothing stops it\n");
        std::abort();
      }
    } catch (const offline::InputError&) {
      continue;
    }
  }
}

}  // namespace mdhcal::fuzz
