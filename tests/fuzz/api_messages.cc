// What a client says over HTTP and WebSocket, and what a server answers.

#include <string_view>

#include "proto/json/envelope.h"
#include "proto/json/messages.h"
#include "tests/fuzz/input.h"

using namespace cairn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const auto bytes = input.rest();
  std::string text(bytes.size(), '\0');
  std::copy(bytes.begin(), bytes.end(), text.begin());
  (void)api::parse_answer(text);
  api::Request request;
  if (api::parse_request(text, request)) return 0;
  (void)api::from_json<api::FoundRequest>(request.params);
  (void)api::from_json<api::GotoRequest>(request.params);
  (void)api::from_json<api::ExploreRequest>(request.params);
  (void)api::from_json<api::ReturnRequest>(request.params);
  (void)api::from_json<api::StopRequest>(request.params);
  (void)api::from_json<api::PlanRequestJson>(request.params);
  (void)api::from_json<api::MapRequest>(request.params);
  (void)api::from_json<api::WatchRequest>(request.params);
  return 0;
}
