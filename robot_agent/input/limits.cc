#include "robot_agent/input/limits.h"

#include <sstream>

namespace cairn::agent {

void Faults::check(const std::string& name, double value, double low, double high) {
  if (value >= low && value <= high) {
    return;
  }
  std::ostringstream sentence;
  sentence << name << " is " << value << " and must be from " << low << " to " << high;
  add(sentence.str());
}

void Faults::add(const std::string& sentences) {
  if (!sentences.empty()) {
    text_ += (text_.empty() ? "" : "; ") + sentences;
  }
}

}  // namespace cairn::agent
