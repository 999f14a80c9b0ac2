// SPDX-License-Identifier: Apache-2.0
#pragma once

/// The words between a program that drives motors and its guard, and the guard's side of them.
namespace tactus::cli {

/// Each is one packet of one byte.
namespace guard_word {
constexpr char goodbye = 'q';  ///< the motors have no power any more: end
constexpr char page = 'm';     ///< with the descriptor of a `GuardPage`
constexpr char port = 'p';     ///< with the descriptor of the port of the motors
}  // namespace guard_word

/// Sends a word, with a copy of a descriptor unless that is negative. False if the other end is gone.
bool send_to_guard(int socket, char word, int descriptor = -1) noexcept;

/// What came.
struct GuardWord {
  enum class Kind { none, word, end } kind = Kind::none;
  char word = 0;
  int descriptor = -1;  ///< of the receiver, which closes it
};
/// The next word, after at most `longest_ms`. Also of a pipe, which passes no descriptors.
GuardWord receive_guard_word(int socket, int longest_ms) noexcept;

}  // namespace tactus::cli
