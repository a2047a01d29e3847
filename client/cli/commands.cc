#include "client/cli/commands.h"

#include <chrono>
#include <string>
#include <utility>

#include "client/cli/connection.h"
#include "client/cli/follow.h"
#include "client/cli/format.h"
#include "client/cli/map_picture.h"
#include "client/cli/offline_commands.h"
#include "proto/json/envelope.h"

namespace cairn::cli {

namespace {

constexpr int kWatchPeriodMs = 1000;

/// Runs each command on an open connection. A command returns its exit code, or the error that
/// ended it.
class Runner {
 public:
  Runner(Connection& server, const Invocation& invocation, const Terminal& terminal)
      : server_(server), json_(invocation.json), terminal_(terminal) {}

  Result<int> operator()(const StatusCommand& /*command*/) {
    return answer(server_.call<api::StatusReply>("status", api::Empty{}), status_text);
  }

  Result<int> operator()(const LinkCommand& /*command*/) {
    if (const auto watching = watch(); !watching) return watching.error();
    auto before = server_.next_status();
    if (!before) return before.error();
    auto after = server_.next_status();
    if (!after) return after.error();
    if (!*before || !*after) return kExitOk;
    return answer(Result<api::StatusReply>(**after),
                  [&](const api::StatusReply& status) { return link_text(**before, status); });
  }

  Result<int> operator()(const WatchCommand& /*command*/) {
    server_.catch_interrupt();
    if (const auto watching = watch(); !watching) return watching.error();
    while (true) {
      auto status = server_.next_status();
      if (!status) return status.error();
      if (!*status) return kExitOk;
      if (json_) {
        terminal_.out << api::to_text(**status) << std::endl;
        continue;
      }
      for (const auto& robot : (*status)->robots) terminal_.out << robot_line(robot) << '\n';
      if ((*status)->robots.empty()) terminal_.out << "no robots yet\n";
      terminal_.out << std::flush;
    }
  }

  Result<int> operator()(const FoundCommand& command) {
    return answer(server_.call<api::SiteJson>("found", command.request), [](const auto& site) {
      return "founded " + site.name + " with cells of " + std::to_string(site.cell_size_mm) +
             " mm\n";
    });
  }

  Result<int> operator()(const GotoCommand& command) {
    const auto& request = command.request;
    const bool one_leg = request.then.empty() && !request.queue;
    if (command.follow && one_leg) return go_and_follow(request);
    return task("goto", command, "goal");
  }

  Result<int> operator()(const ExploreCommand& command) {
    return task("explore", command, "task to explore");
  }

  Result<int> operator()(const ReturnCommand& command) { return task("return", command, "return"); }

  Result<int> operator()(const StopCommand& command) {
    return answer(server_.call<api::CommandReply>("stop", command.request),
                  [](const auto& reply) { return command_text(reply, "stop"); });
  }

  Result<int> operator()(const MapCommand& command) {
    auto map = server_.map(command.site);
    if (!map) return map.error();
    return draw(*map, {.scale = command.scale, .path = {}, .goal = {}}, command.png, true);
  }

  Result<int> operator()(const PlanCommand& command) {
    auto plan = server_.call<api::PlanReply>("plan", command.request);
    const auto code = answer(plan, plan_text);
    if (!code) return code.error();
    if (!command.png.empty()) {
      auto map = server_.map(command.request.site);
      if (!map) return map.error();
      const PictureOptions options{.scale = 0, .path = plan->path, .goal = command.request.to};
      if (const auto drawn = draw(*map, options, command.png, false); !drawn) return drawn.error();
    }
    return plan->status == "none" ? kExitFailed : kExitOk;
  }

 private:
  /// Writes an answer as JSON or as text for people.
  template <class T, class ToText>
  Result<int> answer(const Result<T>& reply, ToText to_text) {
    if (!reply) return reply.error();
    if (json_) {
      terminal_.out << api::to_text(*reply) << '\n';
    } else {
      terminal_.out << to_text(*reply);
    }
    return kExitOk;
  }

  Result<int> go_and_follow(const api::GotoRequest& request) {
    auto before = server_.call<api::StatusReply>("status", api::Empty{});
    if (!before) return before.error();
    auto sent = server_.call<api::CommandReply>("goto", request);
    if (!sent) return sent.error();
    if (!json_) terminal_.out << command_text(*sent, "goal") << std::flush;
    return follow(Follow(*before, sent->robot, sent->command));
  }

  template <class TaskCommand>
  Result<int> task(const char* method, const TaskCommand& command, const char* what) {
    auto sent = server_.call<api::CommandReply>(method, command.request);
    if (!sent || !command.follow) {
      return answer(sent, [&](const auto& reply) { return command_text(reply, what); });
    }
    if (!json_) terminal_.out << command_text(*sent, what) << std::flush;
    return follow(FollowTask(sent->robot, sent->task));
  }

  Status watch() {
    const auto watching =
        server_.call<api::WatchRequest>("watch", api::WatchRequest{.period_ms = kWatchPeriodMs});
    if (!watching) return watching.error();
    return {};
  }

  template <class Following>
  Result<int> follow(Following following) {
    server_.catch_interrupt();
    if (const auto watching = watch(); !watching) return watching.error();
    while (true) {
      auto status = server_.next_status();
      if (!status) return end_line(), status.error();
      if (!*status) {
        end_line();
        return Error{ErrorCode::unavailable,
                     "no longer followed; the robot goes on: `cairn stop` halts it"};
      }
      const auto step = following.step(**status);
      if (json_) {
        terminal_.out << api::to_text(**status) << std::endl;
      } else if (!step.exit || *step.exit == kExitOk) {
        show(step.line);
      }
      if (!step.exit) continue;
      end_line();
      if (*step.exit != kExitOk) return Error{ErrorCode::unavailable, step.line};
      return kExitOk;
    }
  }

  void show(const std::string& line) {
    if (terminal_.rewrites_lines) {
      terminal_.out << "\r\x1b[K" << line << std::flush;
      on_a_line_ = true;
    } else {
      terminal_.out << line << std::endl;
    }
  }
  void end_line() {
    if (std::exchange(on_a_line_, false)) terminal_.out << std::endl;
  }

  Result<int> draw(const SiteMap& map, const PictureOptions& options, const std::string& file,
                   bool tell) {
    const auto picture = draw_map(map, options);
    if (!picture) return picture.error();
    if (const auto written = write_png(*picture, file); !written) return written.error();
    if (tell && json_) {
      terminal_.out << api::to_text({{"png", file},
                                     {"width", picture->cols},
                                     {"height", picture->rows},
                                     {"site", map.head.site},
                                     {"map_version", map.head.map_version},
                                     {"tiles", map.tiles.size()}})
                    << '\n';
    } else if (!json_) {
      terminal_.out << "drew " << file << ": " << picture->cols << " x " << picture->rows
                    << " pixels, map version " << map.head.map_version << '\n';
    }
    return kExitOk;
  }

  Connection& server_;
  bool json_;
  const Terminal& terminal_;
  bool on_a_line_ = false;
};

template <class OnlineCommand>
Result<int> on_server(const OnlineCommand& command, const Invocation& invocation,
                      const Terminal& terminal) {
  const auto timeout = std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::duration<double>(invocation.timeout_s));
  auto server = Connection::open(invocation.server, timeout);
  if (!server) return server.error();
  return Runner(**server, invocation, terminal)(command);
}

}  // namespace

int run(const Invocation& invocation, const Terminal& terminal) {
  const Result<int> code = std::visit(
      [&](const auto& command) -> Result<int> {
        if constexpr (requires { run(command, invocation.json, terminal); }) {
          return run(command, invocation.json, terminal);
        } else {
          return on_server(command, invocation, terminal);
        }
      },
      invocation.command);
  if (code) return *code;
  terminal.err << "cairn: " << code.error().message << '\n';
  return kExitFailed;
}

}  // namespace cairn::cli
