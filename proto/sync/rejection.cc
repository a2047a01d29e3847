#include "proto/sync/rejection.h"

namespace cairn::proto {

Error explain(const Reject& reject, const std::string& robot, const std::string& site,
              int cell_size_mm) {
  const std::string said = reject.text.empty() ? "" : " (server says: " + reject.text + ")";
  switch (reject.reason) {
    case RejectReason::robot_id_in_use:
      return {ErrorCode::conflict, "another agent is robot '" + robot +
                                       "' at this server; stop it or choose another id" + said};
    case RejectReason::unknown_site:
      return {ErrorCode::not_found, "the server has no site '" + site +
                                        "'; correct the agent's site or found it first" + said};
    case RejectReason::cell_size_differs:
      return {ErrorCode::invalid_argument, "cells of " + std::to_string(cell_size_mm) +
                                               " mm are not the site's; set the site's size" +
                                               said};
    case RejectReason::server_full:
      return {ErrorCode::exhausted,
              "the server takes no more robots; end another session or raise its bound" + said};
    case RejectReason::bad_name:
      return {ErrorCode::invalid_argument, "the server does not take the names '" + robot + "', '" +
                                               site + "'; change them" + said};
  }
  return {ErrorCode::unavailable, "the server refused this robot" + said};
}

}  // namespace cairn::proto
