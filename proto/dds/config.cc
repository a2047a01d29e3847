#include "proto/dds/config.h"

#include "proto/dds/endpoint.h"

namespace cairn::proto {
namespace {

std::string element(const std::string& name, const std::string& content) {
  return "<" + name + ">" + content + "</" + name + ">";
}

std::string interfaces(const DdsConfig& config) {
  if (!config.interface_address.empty()) {
    return "<NetworkInterface address=\"" + config.interface_address + "\"/>";
  }
  // Cyclone's own choice leaves out loopback; a robot simulated on the server's machine needs it.
  return "<NetworkInterface autodetermine=\"true\"/><NetworkInterface address=\"127.0.0.1\"/>";
}

std::string general(const DdsConfig& config) {
  return element("General",
                 element("Interfaces", interfaces(config)) + element("AllowMulticast", "false") +
                     element("MaxMessageSize", "1400B") + element("MaxRexmitMessageSize", "1400B") +
                     element("FragmentSize", "1300B"));
}

// The server is met at a known port; robots take any, so that many run on one machine.
std::string addressing(const DdsConfig& config) {
  if (config.role == DdsRole::server) {
    return element("ParticipantIndex", "0") + element("MaxAutoParticipantIndex", "0");
  }
  const std::string peer =
      config.server_address + ":" + std::to_string(dds_server_port(config.domain));
  return element("ParticipantIndex", "none") + element("Peers", "<Peer address=\"" + peer + "\"/>");
}

// The robot's announcements are what finds a restarted server; the server's own only keep the
// lease alive.
std::string discovery(const DdsConfig& config) {
  const bool robot = config.role == DdsRole::robot;
  const std::string interval = config.loopback ? "1 s" : (robot ? "4 s" : "15 s");
  const std::string lease = config.loopback ? "10 s" : "60 s";
  return element("Discovery", addressing(config) + element("LeaseDuration", lease) +
                                  element("SPDPInterval", interval));
}

// Fixed timers of discovery's reliable part, about twice the round trip of a slow radio.
std::string radio_timers() {
  return element(
      "Internal",
      "<HeartbeatInterval min=\"3 s\" minsched=\"3 s\" max=\"30 s\">3 s"
      "</HeartbeatInterval>" +
          element("NackDelay", "2.5 s") + element("AckDelay", "2.5 s") +
          element("AutoReschedNackDelay", "30 s") + element("PreEmptiveAckDelay", "2.5 s") +
          element("RetransmitMerging", "always") + element("RetransmitMergingPeriod", "1 s"));
}

}  // namespace

std::string dds_config_xml(const DdsConfig& config) {
  const std::string timers = config.loopback ? std::string() : radio_timers();
  return "<CycloneDDS><Domain Id=\"any\">" + general(config) + discovery(config) + timers +
         "</Domain></CycloneDDS>";
}

}  // namespace cairn::proto
