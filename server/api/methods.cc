#include "server/api/methods.h"

#include <utility>

namespace cairn::server {

namespace {

using JsonReply = std::function<void(Result<nlohmann::json>)>;

/// Turns the service's answer into JSON for `reply`.
template <class T>
Service::Reply<T> as_json(JsonReply reply) {
  return [reply = std::move(reply)](Result<T> answer) {
    if (!answer) return reply(answer.error());
    reply(nlohmann::json(*answer));
  };
}

/// Reads the parameters and calls `ask` with them, or replies what is wrong with them.
template <class Params, class Answer, class Ask>
void with(const nlohmann::json& json, JsonReply reply, Ask ask) {
  auto params = api::from_json<Params>(json);
  if (!params) return reply(params.error());
  ask(*params, as_json<Answer>(std::move(reply)));
}

}  // namespace

bool call_method(Service& service, const std::string& method, const nlohmann::json& params,
                 JsonReply reply) {
  if (method == "status") {
    with<api::Empty, api::StatusReply>(params, std::move(reply), [&](const auto&, auto answer) {
      service.status(std::move(answer));
    });
  } else if (method == "found") {
    with<api::FoundRequest, api::SiteJson>(
        params, std::move(reply),
        [&](const auto& p, auto answer) { service.found(p, std::move(answer)); });
  } else if (method == "goto") {
    with<api::GotoRequest, api::CommandReply>(
        params, std::move(reply),
        [&](const auto& p, auto answer) { service.go_to(p, std::move(answer)); });
  } else if (method == "explore") {
    with<api::ExploreRequest, api::CommandReply>(
        params, std::move(reply),
        [&](const auto& p, auto answer) { service.explore(p, std::move(answer)); });
  } else if (method == "return") {
    with<api::ReturnRequest, api::CommandReply>(
        params, std::move(reply),
        [&](const auto& p, auto answer) { service.go_home(p, std::move(answer)); });
  } else if (method == "stop") {
    with<api::StopRequest, api::CommandReply>(
        params, std::move(reply),
        [&](const auto& p, auto answer) { service.stop(p, std::move(answer)); });
  } else if (method == "plan") {
    with<api::PlanRequestJson, api::PlanReply>(
        params, std::move(reply),
        [&](const auto& p, auto answer) { service.plan(p, std::move(answer)); });
  } else {
    return false;
  }
  return true;
}

}  // namespace cairn::server
