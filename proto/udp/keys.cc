#include "proto/udp/keys.h"

#include <sys/stat.h>

#include <array>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>

#include "proto/codec/text.h"

namespace cairn::proto {
namespace {

constexpr int kBase64 = sodium_base64_VARIANT_ORIGINAL;
constexpr std::uintmax_t kMaxFileBytes = kMaxKeys * 128;

Error bad(const std::string& why) { return {ErrorCode::invalid_argument, why}; }

Error bad_line(std::size_t line, const std::string& why) {
  return bad("keys, line " + std::to_string(line) + ": " + why +
             "; a line is ROBOT KEY, as `cairn-server --new-key ROBOT` prints it");
}

std::optional<Secret> decode_key(const std::string& text) {
  Secret key;
  std::size_t size = 0;
  const int bad = sodium_base642bin(key.data(), Secret::kBytes, text.data(), text.size(), nullptr,
                                    &size, nullptr, kBase64);
  if (bad != 0 || size != Secret::kBytes) return std::nullopt;
  return key;
}

Status take_line(const std::string& text, std::size_t line, RobotKeys& keys) {
  std::istringstream words(text);
  std::string robot;
  std::string key_text;
  std::string more;
  if (!(words >> robot) || robot.starts_with('#')) return {};
  if (!valid_name(robot)) return bad_line(line, "the robot's id is 1 to 32 of a-z, 0-9, '-', '_'");
  if (!(words >> key_text) || (words >> more)) return bad_line(line, "expected two words");
  const auto key = decode_key(key_text);
  if (!key) return bad_line(line, "the key is not 32 bytes in base64");
  if (keys.size() >= kMaxKeys) return bad_line(line, "more keys than a file may hold");
  if (!keys.emplace(robot, *key).second)
    return bad_line(line, "robot '" + robot + "' stands twice");
  return {};
}

/// A key that others can read is none.
Status check_private(const std::filesystem::path& file) {
  struct stat about {};
  if (stat(file.c_str(), &about) != 0) {
    return Error{ErrorCode::not_found,
                 "no key file " + file.string() +
                     ": make a key with `cairn-server --new-key ROBOT` and keep its line there"};
  }
  if ((about.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    return Error{ErrorCode::invalid_argument, "others may read or change the key file " +
                                                  file.string() + ": run `chmod 600 " +
                                                  file.string() + "`"};
  }
  return {};
}

}  // namespace

Result<RobotKeys> parse_keys(std::string_view text) {
  RobotKeys keys;
  std::istringstream lines{std::string(text)};
  std::string line;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    if (Status taken = take_line(line, number, keys); !taken) return taken.error();
  }
  return keys;
}

Result<RobotKeys> read_keys(const std::filesystem::path& file) {
  if (Status private_file = check_private(file); !private_file) return private_file.error();
  std::error_code error;
  if (std::filesystem::file_size(file, error) > kMaxFileBytes || error) {
    return bad(file.string() + " is no key file");
  }
  std::ifstream in(file, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (!in) return Error{ErrorCode::io, "cannot read the key file " + file.string()};
  auto keys = parse_keys(text);
  sodium_memzero(text.data(), text.size());
  return keys;
}

Result<Secret> read_key(const std::filesystem::path& file, const std::string& robot) {
  const auto keys = read_keys(file);
  if (!keys) return keys.error();
  const auto found = keys->find(robot);
  if (found != keys->end()) return found->second;
  return Error{ErrorCode::not_found,
               "the key file " + file.string() + " holds no key of robot '" + robot + "'"};
}

Result<std::string> new_key_line(const std::string& robot) {
  if (!valid_name(robot)) return bad("robot id must be 1 to 32 of a-z, 0-9, _ and -, e.g. rover-1");
  if (sodium_init() < 0) return Error{ErrorCode::io, "the system gives no random numbers"};
  const Secret key = Secret::random();
  std::array<char, sodium_base64_ENCODED_LEN(Secret::kBytes, kBase64)> text{};
  sodium_bin2base64(text.data(), text.size(), key.data(), Secret::kBytes, kBase64);
  return robot + " " + text.data();
}

KeyId key_id(const Secret& key) {
  constexpr std::string_view kMeaning = "cairn udp key id";
  std::array<std::uint8_t, crypto_auth_hmacsha256_BYTES> whole{};
  crypto_auth_hmacsha256(whole.data(), reinterpret_cast<const std::uint8_t*>(kMeaning.data()),
                         kMeaning.size(), key.data());
  KeyId id{};
  std::copy_n(whole.begin(), id.size(), id.begin());
  return id;
}

}  // namespace cairn::proto
